"""What a figure is worked out of: a setup of the lesson with its settings, and the world that it makes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

from rl_tui.agents.exact.solve import returns, solve
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters
from rl_tui.common.findings import near, shown
from rl_tui.lab.lessons.figures.expression import FigureError
from rl_tui.lab.lessons.setups import scenario_for
from rl_tui.lab.run.exact_answers import NO_TABLE
from rl_tui.lab.run.library import find, recipe_for
from rl_tui.lab.run.recipe import Recipe, begin

if TYPE_CHECKING:
    from rl_tui.agents.exact.solution import Returns, Solution
    from rl_tui.lab.lessons.figures.step_budget import StepBudget
    from rl_tui.lab.lessons.lesson import Lesson
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
    from rl_tui.worlds.world import World

OTHER_WORLD: Final = ("setup", "scenario", "seed")
SETTINGS: Final = ("algorithm", *PARAMETERS)


class FigureSubject:
    """A recipe of the lesson, and what is worked out of it once: its world and its exact answer.

    ``known`` are results of runs, and ``budget`` counts their steps: all subjects of one check share both.
    """

    def __init__(
        self,
        lesson: Lesson,
        recipe: Recipe,
        known: dict[Any, Any],
        budget: StepBudget,
        changed: Callable[[Mapping[str, Any]], FigureSubject],
    ) -> None:
        self.lesson = lesson
        self.recipe = recipe
        self.known = known
        self.budget = budget
        self.changed = changed
        """Returns the subject with other settings besides."""

    @property
    def values(self) -> Hyperparameters:
        """The hyper-parameters of its setup."""
        return self.recipe.hyperparameters

    @cached_property
    def world(self) -> World:
        """The world, as the seed makes it. Raises UserError where it cannot be built."""
        key = "world", self.recipe.scenario.text or self.recipe.scenario.id, self.recipe.seed
        if key not in self.known:
            self.known[key] = begin(self.recipe).world
        world: World = self.known[key]
        return world

    @cached_property
    def mdp(self) -> TabularMDP:
        """The table of the world. Raises FigureError where it has none."""
        if self.world.mdp is None:
            raise FigureError(f"{self.recipe.scenario.id}: {NO_TABLE}", "a world with a transition table")
        return self.world.mdp

    @cached_property
    def solution(self) -> Solution:
        """The exact answer for its γ. Raises UserError where there is none."""
        return solve(self.mdp, self.values.gamma)

    @cached_property
    def returns(self) -> Returns:
        """What optimal policies earn in an episode. Raises UserError where there is no exact answer."""
        return returns(self.mdp, self.solution)

    @cached_property
    def unlimited(self) -> TabularMDP:
        """The table without a time limit."""
        return replace(self.mdp, time_limit=0)

    def with_seed(self, seed: int) -> Recipe:
        """Return the recipe under another seed."""
        return replace(self.recipe, seed=seed)

    def setting(self, name: str) -> float | str:
        """Return the algorithm, or the value of a hyper-parameter."""
        return self.recipe.algorithm if name == "algorithm" else self.values.value(plain_name(name))

    def state(self, name: object) -> int:
        """Return the number of the state of this name. Raises FigureError with near names."""
        return _place(name_of(name), self.world.space.state_names, "a state of this world")

    def action(self, name: object) -> int:
        """Return the number of the action of this name. Raises FigureError with near names."""
        return _place(name_of(name), self.world.space.action_names, "an action of this world")

    def pair(self, state: object, action: object) -> int:
        """Return the pair of state and action, by their names. Raises FigureError."""
        space = self.world.space
        number = self.state(state)
        pair = space.pair_of(number, self.action(action))
        if pair is None:
            names = ", ".join(space.action_names[space.pair_action[each]] for each in space.pairs_of(number))
            found = f"{shown(action)} in state {name_of(state)}"
            raise FigureError(found, f"one of {names}" if names else "a state that is not terminal")
        return pair


def subject_of(
    lesson: Lesson, setup: str, overrides: Mapping[str, Any], known: dict[Any, Any], budget: StepBudget
) -> FigureSubject:
    """Return the subject of a setup, with ``overrides``: setup or scenario, seed, and settings by name.

    Raises UserError where a scenario cannot be found or a setting does not fit.
    """
    others = dict(overrides)
    setup = name_of(others.pop("setup", setup))
    if setup not in lesson.setups:
        raise FigureError(shown(setup), f"the name of a setup{near(setup, lesson.setups)}")
    table = lesson.setups[setup]
    scenario = name_of(others.pop("scenario")) if "scenario" in others else None
    seed = whole(others.pop("seed", table.seed), "seed", 0, 2**31)
    settings = {plain_name(name): value for name, value in others.items()}
    key = (
        "subject",
        id(lesson),
        setup,
        scenario,
        seed,
        repr(sorted(settings.items(), key=lambda item: item[0])),
    )
    if key not in known:
        if scenario is None:
            found, settings = scenario_for(lesson, setup), {**table.settings, **settings}
        else:
            found = find(scenario)

        def changed(more: Mapping[str, Any]) -> FigureSubject:
            return subject_of(lesson, setup, {**overrides, **more}, known, budget)

        known[key] = FigureSubject(lesson, recipe_for(found, settings, seed), known, budget, changed)
    subject: FigureSubject = known[key]
    return subject


def plain_name(name: str) -> str:
    """Return the name of a setting that was written as ``lambda_``, which is no word of Python."""
    return "lambda" if name == "lambda_" else name


def name_of(value: object) -> str:
    """Return the name that an argument means: a text, or a whole number such as that of a cell."""
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise FigureError(shown(value), "a name in quotes")
    return str(int(value)) if not isinstance(value, str) and value == int(value) else str(value)


def whole(value: object, name: str, least: int, most: int) -> int:
    """Return ``value`` as the whole number that it is. Raises FigureError with the range."""
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if not is_number or value != int(value) or not least <= value <= most:  # type: ignore[call-overload, operator]
        raise FigureError(f"{name} = {shown(value)}", f"a whole number, {least:,} to {most:,}")
    return int(value)  # type: ignore[call-overload, no-any-return]


def share(value: object, name: str) -> float:
    """Return ``value`` as a number from 0 to 1. Raises FigureError."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value <= 1.0:
        raise FigureError(f"{name} = {shown(value)}", "a number from 0 to 1")
    return float(value)


def _place(name: str, names: Any, what: str) -> int:
    for place, each in enumerate(names):
        if each == name:
            return place
    raise FigureError(shown(name), f"{what}{near(name, names)}")
