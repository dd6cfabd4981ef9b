"""The verdict on a program: its update rule and its findings."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Literal

AlphaSchedule = Literal["constant", "1/N", "by-episode"]
CountedVisits = Literal["first", "every", "last"]
"""Visits of a pair in an episode whose returns Monte Carlo counts."""


class Rule(StrEnum):
    """The target of an update."""

    Q_LEARNING = "q-learning"
    SARSA = "sarsa"
    EXPECTED_SARSA = "expected-sarsa"
    DOUBLE_Q = "double-q-learning"
    MONTE_CARLO = "monte-carlo"
    UNKNOWN = "unknown"


class CodeFault(StrEnum):
    """Kinds of findings. The last two are risks."""

    BOOTSTRAPS_AFTER_END = "bootstraps-after-end"
    NO_BOOTSTRAP_AFTER_TRUNCATION = "no-bootstrap-after-truncation"
    WRONG_AXIS = "wrong-axis"
    UPDATES_AFTER_MOVING = "updates-after-moving"
    SHIFTED_REWARD = "shifted-reward"
    ROUNDING_TABLE = "rounding-table"
    SHARED_TABLE = "shared-table"
    GAMMA_TWICE = "gamma-twice"
    WRONG_FORMULA = "wrong-formula"
    STEP_SIZE_OUT_OF_RANGE = "step-size-out-of-range"
    WRONG_CELL = "wrong-cell"
    LOSES_UPDATE = "loses-update"
    STEPS_AFTER_END = "steps-after-end"
    WRONG_TABLE = "wrong-table"
    FIRST_OF_TIES = "first-of-ties"
    NEVER_EXPLORES = "never-explores"


RISKS = frozenset({CodeFault.FIRST_OF_TIES, CodeFault.NEVER_EXPLORES})


class UpdateTarget(StrEnum):
    """The source of the next value, right or wrong. With two tables, the update changes Q₁."""

    BEST = "max Q(s′)"
    NEXT_ACTION = "Q(s′, a′)"
    EXPECTED = "Σ π Q(s′)"
    ALLOWED = "max Q(s′) of the allowed actions"
    DRAWN = "Q(s′, b)"
    COLUMN = "max Q(·, a)"
    SAME_ACTION = "Q(s′, a)"
    OWN_STATE = "max Q(s)"
    INDEX = "argmax Q(s′)"
    BEST_BY_OTHER = "Q₂(s′, argmax Q₁(s′))"
    OTHER_BEST = "max Q₂(s′)"
    OTHERS_CHOICE = "Q₁(s′, argmax Q₂(s′))"
    NOTHING = "nothing"


UNUSUAL_TARGETS = (
    UpdateTarget.SAME_ACTION,
    UpdateTarget.OWN_STATE,
    UpdateTarget.INDEX,
    UpdateTarget.OTHERS_CHOICE,
    UpdateTarget.NOTHING,
)
"""Targets of no rule, which a note names."""


def step_number(step: int) -> int:
    """Return `step` as people count, from 1."""
    return int(step) + 1


class MovedCell(StrEnum):
    """The cell that moves with a step."""

    TAKEN = "(s, a)"
    MOVED = "(s′, a)"
    ONE_LATE = "the pair of the step before"


@dataclass(frozen=True, slots=True)
class UpdateFound:
    """The update that fits the changes of a table.

    An unknown rule may have `alpha` and `gamma` that fit, if no step tells Q-learning from SARSA. `reason`
    says so then.

    Attributes:
        rule: The rule that it is meant to be.
        alpha: Step size, None if undetermined or not constant.
        gamma: Discount, None if undetermined.
        epsilon: That of Expected SARSA, None if not constant.
        fits: Share of explained steps, None for an unknown rule.
        informative: Steps on which the next value matters.
        departs_at: First unexplained step, from 0.
        uses_reward_before: True if it uses the previous step's reward.
        visits: Visits that Monte Carlo counts, None if unknown.
    """

    rule: Rule = Rule.UNKNOWN
    alpha: float | None = None
    alpha_schedule: AlphaSchedule | None = None
    gamma: float | None = None
    epsilon: float | None = None
    reward: Literal["environment", "own"] = "environment"
    fits: float | None = None
    informative: int = 0
    departs_at: int | None = None
    target: UpdateTarget = UpdateTarget.NOTHING
    place: MovedCell = MovedCell.TAKEN
    uses_reward_before: bool = False
    visits: CountedVisits | None = None
    reason: str = ""
    """Reason why the rule is unknown, as a sentence."""


@dataclass(frozen=True, slots=True)
class CodeFinding:
    """A fault or a risk. A "declared" one relies on a number in the code.

    Attributes:
        step: First step that shows it, from 0.
        steps_for: Distinguishing steps that support it.
        steps_against: Distinguishing steps against it, 0 for a fault.
        text: What was observed.
        correction: What to do, in the terms of the book.
    """

    fault: CodeFault
    certainty: Literal["proven", "declared"]
    step: int
    steps_for: int
    steps_against: int
    text: str
    correction: str
    file: str = ""
    line: int | None = None

    @property
    def kind(self) -> Literal["fault", "risk"]:
        """The kind: "fault", or "risk" if only bad luck makes it fail."""
        return "risk" if self.fault in RISKS else "fault"

    @property
    def noun(self) -> Literal["bug", "risk"]:
        """The kind as people read it."""
        return "bug" if self.kind == "fault" else "risk"

    @property
    def account(self) -> str:
        """Text, number of proving steps, and correction."""
        proof = "" if self.kind == "risk" else f" Steps that show it: {self.steps_for:,}."
        return f"{self.text}{proof} Fix: {self.correction.rstrip('.')}."


@dataclass(frozen=True, slots=True)
class ExplorationFound:
    """An estimate of ε with its 95 % interval, from the latest `choices` in states with one best action.
    `name` and `written` are those in the code, "" and None if unknown.
    """

    epsilon: float
    low: float
    high: float
    choices: int
    name: str = ""
    written: float | None = None

    @property
    def departs(self) -> bool:
        """True if ε in the code is outside the interval. It may belong to another policy."""
        return self.written is not None and not self.low <= self.written <= self.high


@dataclass(frozen=True, slots=True)
class SuspectedRisk:
    """A risk that one run does not prove: `luck` is the probability that random choices see no reward."""

    finding: CodeFinding
    luck: float


@dataclass(frozen=True, slots=True)
class ProgramVerdict:
    """The verdict on a program so far."""

    update: UpdateFound = field(default_factory=UpdateFound)
    findings: tuple[CodeFinding, ...] = ()
    notes: tuple[str, ...] = ()
    """Unknown facts with reasons, and harmless departures from the book."""
    suspected: SuspectedRisk | None = None
    exploration: ExplorationFound | None = None
