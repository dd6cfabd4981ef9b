"""Whether what was measured is what a condition asks for, and the words for it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final, NamedTuple, Protocol

if TYPE_CHECKING:
    from rl_tui.lab.lessons.judging.measures import Value
    from rl_tui.lab.lessons.schema import Condition
    from rl_tui.lab.run.recipe import Recipe

TOLERANCE: Final = 1e-9
"""Numbers no further apart are equal."""

_DIGITS: Final = 4
_MOST_DIGITS: Final = 12


class ConditionVerdict(NamedTuple):
    """Whether a condition holds, None while that is not known, and the measure in words."""

    holds: bool | None
    found: str = ""


class Panels(Protocol):
    """What works out conditions that many seeds decide."""

    def of(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> Sequence[ConditionVerdict]:
        """Return the verdict on each of ``conditions`` for runs of ``recipe``, whatever seed that has."""

    @property
    def waits(self) -> str:
        """What is being worked out, in words; empty where nothing is."""


def is_met(condition: Condition, value: Value) -> bool:
    """Return whether ``value`` is what ``condition`` asks for."""
    if condition.equals is not None and not _equal(value, condition.equals):
        return False
    if condition.one_of and not any(_equal(value, each) for each in condition.one_of):
        return False
    bounds = (condition.at_least, condition.at_most, condition.above, condition.below)
    if all(bound is None for bound in bounds):
        return True
    if isinstance(value, str | bool):
        return False
    at_least, at_most, above, below = bounds
    return (
        (at_least is None or value >= at_least - TOLERANCE)
        and (at_most is None or value <= at_most + TOLERANCE)
        and (above is None or value > above + TOLERANCE)
        and (below is None or value < below - TOLERANCE)
    )


def in_words(value: Value, digits: int = _DIGITS) -> str:
    """Return a value as people read it: a number that is not whole with so many significant ``digits``."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, str):
        return value
    is_whole = abs(value) < 1e15 and value == int(value)
    has_no_fraction = is_whole or 10**digits <= abs(value) < 1e15
    return (f"{value:,.0f}" if has_no_fraction else f"{value:.{digits}g}").replace("-", "−")


def found_in_words(condition: Condition, value: Value) -> str:
    """Return ``value`` in words: exact enough that whoever reads it comes to the same verdict."""
    if isinstance(value, str | bool):
        return in_words(value)
    same = (
        digits
        for digits in range(_DIGITS, _MOST_DIGITS)
        if is_met(condition, float(f"{value:.{digits}g}")) == is_met(condition, value)
    )
    return in_words(value, next(same, _MOST_DIGITS))


def _equal(value: Value, wanted: Value) -> bool:
    if isinstance(value, str | bool) or isinstance(wanted, str | bool):
        return value == wanted and isinstance(value, bool) == isinstance(wanted, bool)
    return abs(value - wanted) <= TOLERANCE
