"""Conditions that many seeds decide: what is asked of them, and what of that is known already."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from rl_tui.lab.lessons.judging.verdicts import Verdict
    from rl_tui.lab.lessons.schema import Condition
    from rl_tui.lab.run.recipe import Recipe

KEPT: Final = 64
"""Settings of which the verdicts are remembered."""


@dataclass(frozen=True, slots=True)
class PanelRequest:
    """What is to be worked out: ``conditions`` for runs of ``recipe`` under the seeds from 0.

    ``modules`` are those that the id of an environment may import.
    """

    recipe: Recipe
    conditions: tuple[Condition, ...]
    modules: frozenset[str]


class KnownPanels:
    """The verdicts of the last settings that were asked for."""

    def __init__(self) -> None:
        self._known: list[tuple[Recipe, tuple[Condition, ...], tuple[Verdict, ...]]] = []

    def of(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> tuple[Verdict, ...] | None:
        """Return what is known of ``conditions`` for runs of ``recipe``, None where that is nothing."""
        for other, same, known in self._known:
            if same_panel(other, same, recipe, conditions):
                return known
        return None

    def keep(self, recipe: Recipe, conditions: tuple[Condition, ...], verdicts: tuple[Verdict, ...]) -> None:
        """Remember ``verdicts``; of very many, the oldest are forgotten."""
        self._known = [*self._known, (recipe, conditions, verdicts)][-KEPT:]


def same_panel(one: Recipe, its: tuple[Condition, ...], other: Recipe, others: tuple[Condition, ...]) -> bool:
    """Return whether both ask for the same runs and the same conditions, whatever seed the recipes have."""
    return (
        one.algorithm == other.algorithm
        and one.hyperparameters == other.hyperparameters
        and (one.scenario is other.scenario or one.scenario.section == other.scenario.section)
        and (its is others or its == others)
    )
