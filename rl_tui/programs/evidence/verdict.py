"""What is said of a program: the update that it makes, and what is wrong with it."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Literal

AlphaSchedule = Literal["constant", "1/N", "by-episode"]


class Rule(StrEnum):
    """What an update of one cell aims at."""

    Q_LEARNING = "q-learning"
    SARSA = "sarsa"
    EXPECTED_SARSA = "expected-sarsa"
    MONTE_CARLO = "monte-carlo"
    UNKNOWN = "unknown"


class CodeFault(StrEnum):
    """What may be wrong with a program; the last two are risks."""

    BOOTSTRAPS_AFTER_END = "bootstraps-after-end"
    NO_BOOTSTRAP_AFTER_TRUNCATION = "no-bootstrap-after-truncation"
    WRONG_AXIS = "wrong-axis"
    UPDATES_AFTER_MOVING = "updates-after-moving"
    SHIFTED_REWARD = "shifted-reward"
    ROUNDING_TABLE = "rounding-table"
    SHARED_TABLE = "shared-table"
    GAMMA_TWICE = "gamma-twice"
    STEP_SIZE_OUT_OF_RANGE = "step-size-out-of-range"
    WRONG_CELL = "wrong-cell"
    LOSES_UPDATE = "loses-update"
    FIRST_OF_TIES = "first-of-ties"
    NEVER_EXPLORES = "never-explores"


RISKS = frozenset({CodeFault.FIRST_OF_TIES, CodeFault.NEVER_EXPLORES})


class UpdateTarget(StrEnum):
    """Where the value of the next state is read from, right or wrong."""

    BEST = "max Q(s′)"
    NEXT_ACTION = "Q(s′, a′)"
    EXPECTED = "Σ π Q(s′)"
    COLUMN = "max Q(·, a)"
    SAME_ACTION = "Q(s′, a)"
    OWN_STATE = "max Q(s)"
    INDEX = "argmax Q(s′)"
    NOTHING = "nothing"


def step_number(step: int) -> int:
    """Return the number by which people know ``step``: they count from 1, the pipe and a recording from 0."""
    return int(step) + 1


class MovedCell(StrEnum):
    """Which cell moves with a step."""

    TAKEN = "(s, a)"
    MOVED = "(s′, a)"
    ONE_LATE = "that of the step before"


@dataclass(frozen=True, slots=True)
class UpdateFound:
    """The update that fits the changes of a table.

    ``alpha`` is None where it is not constant or nothing tells it, ``gamma`` where no step tells it.
    ``epsilon`` is that of Expected SARSA's mean where it is constant, else None. ``reward`` is the
    environment's or the program's own. ``fits`` is the share of the steps considered that it explains, from 0
    to 1, None for an unknown rule; ``informative`` counts the steps on which the value of the next state
    matters. ``departs_at`` is the first step that it does not explain, counted from 0. ``target``, ``place``
    and ``uses_reward_before`` (before that of the step whose cell moves) say how it does so, also where that
    is a fault; ``rule`` is the one that it is meant to be. An unknown rule may come with ``alpha`` and
    ``gamma``: those fit, but no step tells Q-learning from SARSA, as ``reason`` says then.
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
    """Why nothing can be said, as a sentence, for an unknown rule."""


@dataclass(frozen=True, slots=True)
class CodeFinding:
    """A fault or a risk.

    ``certainty`` "declared" rests on a number read from the code. ``step`` is the first step that shows it,
    counted from 0; ``steps_for`` of the steps on which the two hypotheses differ speak for it,
    ``steps_against`` against it: 0 for a fault. ``text`` says what was seen, ``correction`` what to do in the
    terms of the book.
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
        """Whether it is wrong, or may go wrong by bad luck."""
        return "risk" if self.fault in RISKS else "fault"


@dataclass(frozen=True, slots=True)
class ProgramVerdict:
    """All that is said of a program so far."""

    update: UpdateFound = field(default_factory=UpdateFound)
    findings: tuple[CodeFinding, ...] = ()
    notes: tuple[str, ...] = ()
    """What cannot be told, and why; how the program departs from the book without a fault."""
