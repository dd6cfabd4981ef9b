"""The verdicts on conditions, and metrics in words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple, Protocol, TypeVar

if TYPE_CHECKING:
    from rl_tui.lessons.file.schema import Condition
    from rl_tui.lessons.judging.measures import Value
    from rl_tui.runs.recipe import Recipe


# What is asked of many seeds, and what is known of them


KEPT: Final = 64
"""Number of settings with cached verdicts."""
SeedValues = list[float | str | bool | None]
"""The metric of each condition that shares a run, None without a value."""
_Panel = tuple["Recipe", tuple["Condition", ...]]
_Of = TypeVar("_Of")


@dataclass(frozen=True, slots=True)
class PanelRequest:
    """A request for `conditions` on runs of `recipe`. `known` has the first seeds."""

    recipe: Recipe
    conditions: tuple[Condition, ...]
    known: tuple[SeedValues, ...] = ()


@dataclass(frozen=True, slots=True)
class PanelProgress:
    """Finished seeds, and finally the `verdicts`."""

    seeds: tuple[SeedValues, ...]
    wanted: int = 0
    """Number of seeds in all, 0 before the first new one."""
    verdicts: tuple[ConditionVerdict, ...] | None = None


class KnownPanels:
    """A cache of verdicts, and of seeds without a verdict."""

    def __init__(self) -> None:
        self._verdicts: list[tuple[_Panel, tuple[ConditionVerdict, ...]]] = []
        self._seeds: list[tuple[_Panel, tuple[SeedValues, ...]]] = []

    def of(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> tuple[ConditionVerdict, ...] | None:
        """Return the verdicts, if known."""
        return _of(self._verdicts, (recipe, conditions))

    def keep(
        self, recipe: Recipe, conditions: tuple[Condition, ...], verdicts: tuple[ConditionVerdict, ...]
    ) -> None:
        """Store `verdicts`, dropping the oldest of too many."""
        self._verdicts = [*self._verdicts, ((recipe, conditions), verdicts)][-KEPT:]

    def seeds_of(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> tuple[SeedValues, ...]:
        """Return the results of seeds without a verdict."""
        return _of(self._seeds, (recipe, conditions)) or ()

    def keep_seeds(
        self, recipe: Recipe, conditions: tuple[Condition, ...], seeds: tuple[SeedValues, ...]
    ) -> None:
        """Store the results of the first seeds."""
        others = [each for each in self._seeds if not same_panel(*each[0], recipe, conditions)]
        self._seeds = [*others, ((recipe, conditions), seeds)][-KEPT:]


def _of(kept: Sequence[tuple[_Panel, _Of]], panel: _Panel) -> _Of | None:
    return next((known for other, known in kept if same_panel(*other, *panel)), None)


def same_panel(one: Recipe, its: tuple[Condition, ...], other: Recipe, others: tuple[Condition, ...]) -> bool:
    """Return True for the same runs and conditions, whatever the seed."""
    return (
        one.algorithm == other.algorithm
        and one.hyperparameters == other.hyperparameters
        and (one.scenario is other.scenario or one.scenario.section == other.scenario.section)
        and (its is others or its == others)
    )


# A verdict and its words


TOLERANCE: Final = 1e-9
"""Numbers this close are equal."""

_DIGITS: Final = 4
_MOST_DIGITS: Final = 12


class ConditionVerdict(NamedTuple):
    """True if a condition is met, None while unknown, and the metric in words."""

    holds: bool | None
    found: str = ""


class Panels(Protocol):
    """Decides conditions over many seeds."""

    def of(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> Sequence[ConditionVerdict]:
        """Return verdicts, whatever the seed of `recipe`."""
        ...

    @property
    def waits(self) -> str:
        """Pending work in words, or ""."""
        ...


def is_met(condition: Condition, value: Value) -> bool:
    """Return True if `value` meets `condition`."""
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
    """Format a value, if not whole with `digits` significant digits."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, str):
        return value
    is_whole = abs(value) < 1e15 and value == int(value)
    has_no_fraction = is_whole or 10**digits <= abs(value) < 1e15
    return (f"{value:,.0f}" if has_no_fraction else f"{value:.{digits}g}").replace("-", "−")


def found_in_words(condition: Condition, value: Value) -> str:
    """Format `value` with enough digits for the same verdict."""
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
