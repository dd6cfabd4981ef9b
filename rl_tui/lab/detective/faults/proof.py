"""A fault as steps prove it, before it is known where in the code it stands."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto
from typing import Final, Literal

import numpy as np

from rl_tui.lab.detective.verdict import RISKS, CodeFault, step_number
from rl_tui.worlds.mdp.space import IntArray

FEWEST_STEPS: Final = 3
"""So many steps must speak for a fault, and none against it."""
MOST_STEPS: Final = 50_000
"""Steps that one question looks at: half of them the first, half the latest."""
_SHARE_OF_OTHERS: Final = 0.05


class CodePlace(Enum):
    """Which line of the code a fault belongs to."""

    UPDATE = auto()
    """The line that changes the table."""
    TABLE = auto()
    """Where the table is made."""
    CHOICE = auto()
    """Where the action is chosen."""
    CALL = auto()
    """The call of ``env.step``."""


@dataclass(frozen=True, slots=True, eq=False)
class Proof:
    """``steps`` are the numbers of the steps that speak for ``fault``, oldest first.

    ``against`` counts those that speak against it, 0 for a fault, and ``neither`` those on which
    something else happened.
    """

    fault: CodeFault
    steps: IntArray
    against: int
    text: str
    correction: str
    place: CodePlace = CodePlace.UPDATE
    certainty: Literal["proven", "declared"] = "proven"
    neither: int = 0

    @property
    def is_enough(self) -> bool:
        """Whether it may be told."""
        few = self.neither <= len(self.steps) * _SHARE_OF_OTHERS
        is_clear = self.against == 0 or self.fault in RISKS
        return len(self.steps) >= FEWEST_STEPS and is_clear and few


def some_of(places: IntArray, most: int = MOST_STEPS) -> IntArray:
    """Return ``places``, or of very many the first and the last ones."""
    if len(places) <= most:
        return places
    return np.concatenate((places[: most // 2], places[-(most - most // 2) :]))


def step_text(step: int) -> str:
    """Return ``step`` for a sentence, as people count."""
    return f"step {step_number(step):,}"


def written(number: float) -> str:
    """Return ``number`` for a sentence, with four digits that count."""
    return f"{number:.4g}".replace("-", "−")
