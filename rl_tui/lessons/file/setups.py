"""The setups with which a lesson's runs begin."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final
from weakref import WeakKeyDictionary

from rl_tui.runs.library import find, recipe_for
from rl_tui.worlds.files.scenario import Scenario, scenario_of
from rl_tui.worlds.files.shipped import SUFFIX

if TYPE_CHECKING:
    from rl_tui.lessons.lesson import Lesson
    from rl_tui.runs.recipe import Recipe


def recipe_of(lesson: Lesson, setup: str) -> Recipe:
    """Return a setup's recipe. Raises UserError if a part does not fit."""
    table = lesson.setups[setup]
    return recipe_for(scenario_for(lesson, setup), table.settings, table.seed)


def check_setups(lesson: Lesson) -> None:
    """Raise UserError for an impossible setup, without building worlds."""
    for setup in lesson.setups:
        recipe_of(lesson, setup)


def scenario_for(lesson: Lesson, setup: str) -> Scenario:
    """Return a setup's scenario: by id, in a file next to the lesson, or from its text.

    All runs share it.
    """
    known = _KNOWN.setdefault(lesson, {})
    if setup not in known:
        known[setup] = _read(lesson, setup)
    return known[setup]


_KNOWN: Final[WeakKeyDictionary[Lesson, dict[str, Scenario]]] = WeakKeyDictionary()


def _read(lesson: Lesson, setup: str) -> Scenario:
    table = lesson.setups[setup]
    if table.world:
        return scenario_of(table.world, Path(f"{lesson.id}-{setup}{SUFFIX}"), ask_environment=False)
    if table.scenario.endswith(SUFFIX):
        return find(str(lesson.source.parent / table.scenario))
    return find(table.scenario)
