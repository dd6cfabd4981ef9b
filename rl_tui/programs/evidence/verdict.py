"""The verdict on a program: its update rule and its findings."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Literal

AlphaSchedule = Literal["constant", "1/N", "by-episode"]


class Rule(StrEnum):
    """The target of an update."""

    Q_LEARNING = "q-learning"
    SARSA = "sarsa"
    EXPECTED_SARSA = "expected-sarsa"
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
    FIRST_OF_TIES = "first-of-ties"
    NEVER_EXPLORES = "never-explores"


RISKS = frozenset({CodeFault.FIRST_OF_TIES, CodeFault.NEVER_EXPLORES})


class UpdateTarget(StrEnum):
    """The source of the next state's value, right or wrong."""

    BEST = "max Q(s′)"
    NEXT_ACTION = "Q(s′, a′)"
    EXPECTED = "Σ π Q(s′)"
    ALLOWED = "max Q(s′) of the allowed actions"
    DRAWN = "Q(s′, b)"
    COLUMN = "max Q(·, a)"
    SAME_ACTION = "Q(s′, a)"
    OWN_STATE = "max Q(s)"
    INDEX = "argmax Q(s′)"
    NOTHING = "nothing"


def step_number(step: int) -> int:
    """Return the number of `step` for people, who count from 1. Messages and recordings count from 0."""
    return int(step) + 1


class MovedCell(StrEnum):
    """The cell that moves with a step."""

    TAKEN = "(s, a)"
    MOVED = "(s′, a)"
    ONE_LATE = "the pair of the step before"


@dataclass(frozen=True, slots=True)
class UpdateFound:
    """The update that fits the changes of a table. An unknown rule may have `alpha` and `gamma` that fit,
    if no step distinguishes Q-learning from SARSA. `reason` says so then.

    Attributes:
        rule: The rule that it is meant to be.
        alpha: Step size, None if undetermined or not constant.
        alpha_schedule: Kind of step size.
        gamma: Discount, None if undetermined.
        epsilon: That of Expected SARSA's mean, None if not constant.
        reward: The environment's reward or the program's own.
        fits: Share of explained steps, 0 to 1, None for an unknown rule.
        informative: Number of steps on which the next value matters.
        departs_at: First unexplained step, from 0.
        target: Source of the next value, right or wrong.
        place: The moving cell, right or wrong.
        uses_reward_before: True if it uses the reward of the previous step.
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
    reason: str = ""
    """Reason why the rule is unknown, as a sentence."""


@dataclass(frozen=True, slots=True)
class CodeFinding:
    """A fault or a risk. A "declared" one relies on a number in the code.

    Attributes:
        fault: Kind of finding.
        certainty: How certain it is.
        step: First step that shows it, from 0.
        steps_for: Distinguishing steps that support it.
        steps_against: Distinguishing steps against it, 0 for a fault.
        text: What was observed.
        correction: What to do, in the terms of the book.
        file: File of the line, or "".
        line: Line in the code, or None.
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
        """The kind: "fault" if it is wrong, "risk" if it may fail by bad luck."""
        return "risk" if self.fault in RISKS else "fault"

    @property
    def noun(self) -> Literal["bug", "risk"]:
        """The kind as reports and the screen name it."""
        return "bug" if self.kind == "fault" else "risk"

    @property
    def account(self) -> str:
        """The text with the number of steps that prove it, and the correction."""
        proof = "" if self.kind == "risk" else f" Steps that show it: {self.steps_for:,}."
        return f"{self.text}{proof} Fix: {self.correction.rstrip('.')}."


@dataclass(frozen=True, slots=True)
class ExplorationFound:
    """The ε that explains the latest choices, if they are ε-greedy. It is an estimate, not a proof.

    Attributes:
        epsilon: The estimate.
        low: Lower end of its 95 % interval.
        high: Upper end.
        choices: Number of choices in states with one best action.
        name: Name of ε in the code, or "".
        written: Its value there, or None.
    """

    epsilon: float
    low: float
    high: float
    choices: int
    name: str = ""
    written: float | None = None

    @property
    def departs(self) -> bool:
        """True if ε in the code is outside the interval. It may fall, or belong to another policy."""
        return self.written is not None and not self.low <= self.written <= self.high


@dataclass(frozen=True, slots=True)
class SuspectedRisk:
    """A risk that one run does not prove: with the probability `luck`, random choices among equal values see
    no reward either.
    """

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
