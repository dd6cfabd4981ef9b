"""Conditions that many seeds decide: what is asked of them, and what of that is known already."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeVar

if TYPE_CHECKING:
    from rl_tui.lab.lessons.judging.verdicts import ConditionVerdict
    from rl_tui.lab.lessons.schema import Condition
    from rl_tui.lab.run.recipe import Recipe

KEPT: Final = 64
"""Settings of which the verdicts are remembered."""
SeedValues = list[float | str | bool | None]
"""What each of the conditions that share a run measures of one seed; None where that has no value."""
_Panel = tuple["Recipe", tuple["Condition", ...]]
_Of = TypeVar("_Of")


@dataclass(frozen=True, slots=True)
class PanelRequest:
    """What is to be worked out: ``conditions`` for runs of ``recipe`` under the seeds from 0.

    ``known`` is what came of the first seeds.
    """

    recipe: Recipe
    conditions: tuple[Condition, ...]
    known: tuple[SeedValues, ...] = ()


@dataclass(frozen=True, slots=True)
class PanelProgress:
    """What is known by now: what came of the ``seeds`` that are done, at the end the ``verdicts``."""

    seeds: tuple[SeedValues, ...]
    wanted: int = 0
    """How many seeds there are to be; 0 before the first that was not known."""
    verdicts: tuple[ConditionVerdict, ...] | None = None


class KnownPanels:
    """The verdicts of the last settings that were asked for, and the seeds that are done where they lack."""

    def __init__(self) -> None:
        self._verdicts: list[tuple[_Panel, tuple[ConditionVerdict, ...]]] = []
        self._seeds: list[tuple[_Panel, tuple[SeedValues, ...]]] = []

    def of(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> tuple[ConditionVerdict, ...] | None:
        """Return what is known of ``conditions`` for runs of ``recipe``, None where that is nothing."""
        return _of(self._verdicts, (recipe, conditions))

    def keep(
        self, recipe: Recipe, conditions: tuple[Condition, ...], verdicts: tuple[ConditionVerdict, ...]
    ) -> None:
        """Remember ``verdicts``; of very many, the oldest are forgotten."""
        self._verdicts = [*self._verdicts, ((recipe, conditions), verdicts)][-KEPT:]

    def seeds_of(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> tuple[SeedValues, ...]:
        """Return what came of the seeds that were done when the work on them ended."""
        return _of(self._seeds, (recipe, conditions)) or ()

    def keep_seeds(
        self, recipe: Recipe, conditions: tuple[Condition, ...], seeds: tuple[SeedValues, ...]
    ) -> None:
        """Remember what came of the first seeds."""
        others = [each for each in self._seeds if not same_panel(*each[0], recipe, conditions)]
        self._seeds = [*others, ((recipe, conditions), seeds)][-KEPT:]


def _of(kept: Sequence[tuple[_Panel, _Of]], panel: _Panel) -> _Of | None:
    return next((known for other, known in kept if same_panel(*other, *panel)), None)


def same_panel(one: Recipe, its: tuple[Condition, ...], other: Recipe, others: tuple[Condition, ...]) -> bool:
    """Return whether both ask for the same runs and the same conditions, whatever seed the recipes have."""
    return (
        one.algorithm == other.algorithm
        and one.hyperparameters == other.hyperparameters
        and (one.scenario is other.scenario or one.scenario.section == other.scenario.section)
        and (its is others or its == others)
    )
