"""A setup of the lesson, with its world and runs."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rl_tui.agents.exact.solve import returns, solve
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters
from rl_tui.common.findings import near, shown
from rl_tui.lessons.figures.expression import FigureError
from rl_tui.lessons.file.schema import MOST_STEPS, Condition
from rl_tui.lessons.file.setups import scenario_for
from rl_tui.lessons.judging.measures import MEASURES, MissingError, Value
from rl_tui.lessons.judging.moment import JudgedMoment, Kept
from rl_tui.runs.exact_answers import NO_TABLE
from rl_tui.runs.library import find, recipe_for
from rl_tui.runs.recipe import Recipe, begin

if TYPE_CHECKING:
    from rl_tui.agents.exact.policy_evaluation import Returns, Solution
    from rl_tui.lessons.figures.step_budget import StepBudget
    from rl_tui.lessons.lesson import Lesson
    from rl_tui.runs.run import Run
    from rl_tui.worlds.mdp.space import IntArray
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
    from rl_tui.worlds.world import World


# A setup and its world


OTHER_WORLD: Final = ("setup", "scenario", "seed")
SETTINGS: Final = ("algorithm", *PARAMETERS)


class FigureSubject:
    """A recipe with results that all subjects of a check share."""

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
        """Returns the subject with further settings."""

    @property
    def values(self) -> Hyperparameters:
        """Hyperparameters of the setup."""
        return self.recipe.hyperparameters

    @cached_property
    def world(self) -> World:
        """World of the seed. Raises UserError without one."""
        key = "world", self.recipe.scenario.text or self.recipe.scenario.id, self.recipe.seed
        if key not in self.known:
            self.known[key] = begin(self.recipe).world
        world: World = self.known[key]
        return world

    @cached_property
    def mdp(self) -> TabularMDP:
        """Table of the world. Raises FigureError without one."""
        if self.world.mdp is None:
            raise FigureError(f"{self.recipe.scenario.id}: {NO_TABLE}; choose a world that has one")
        return self.world.mdp

    @cached_property
    def solution(self) -> Solution:
        """Solution for its γ. Raises UserError without one."""
        return solve(self.mdp, self.values.gamma)

    @cached_property
    def returns(self) -> Returns:
        """Returns of optimal policies. Raises UserError."""
        return returns(self.mdp, self.solution)

    @cached_property
    def unlimited(self) -> TabularMDP:
        """The table without a time limit."""
        return replace(self.mdp, time_limit=0)

    def with_seed(self, seed: int) -> Recipe:
        """Return the recipe with another seed."""
        return replace(self.recipe, seed=seed)

    def setting(self, name: str) -> float | str:
        """Return the algorithm, or the value of a hyperparameter."""
        return self.recipe.algorithm if name == "algorithm" else self.values.value(plain_name(name))

    def state(self, name: object) -> int:
        """Return a state's number. Raises FigureError with similar names."""
        return _place(name_of(name), self.world.space.state_names, "a state of this world")

    def action(self, name: object) -> int:
        """Return an action's number. Raises FigureError with similar names."""
        return _place(name_of(name), self.world.space.action_names, "an action of this world")

    def pair(self, state: object, action: object) -> int:
        """Return the pair of a state and action. Raises FigureError."""
        space = self.world.space
        number = self.state(state)
        pair = space.pair_of(number, self.action(action))
        if pair is None:
            names = ", ".join(space.action_names[space.pair_action[each]] for each in space.pairs_of(number))
            if not names:
                raise FigureError(f"state {name_of(state)} is terminal; choose a state with actions")
            found = f"{shown(action)} is not available in state {name_of(state)}"
            raise FigureError(f"{found}; choose one of {names}")
        return pair


def subject_of(
    lesson: Lesson, setup: str, overrides: Mapping[str, Any], known: dict[Any, Any], budget: StepBudget
) -> FigureSubject:
    """Return the subject of a setup. Raises UserError if a scenario or setting does not fit.

    `overrides` are another setup or scenario, seed, and settings by name.
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
    """Return a setting's name, which Python needs as `lambda_`."""
    return "lambda" if name == "lambda_" else name


def name_of(value: object) -> str:
    """Return a name given as text or whole number."""
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise FigureError(shown(value), "a name in quotes")
    return str(int(value)) if not isinstance(value, str) and value == int(value) else str(value)


def whole(value: object, name: str, least: int, most: int) -> int:
    """Return `value` as an integer. Raises FigureError with the range."""
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if not is_number or value != int(value) or not least <= value <= most:  # type: ignore[call-overload, operator]
        raise FigureError(f"{name} = {shown(value)}", f"a whole number, {least:,} to {most:,}")
    return int(value)  # type: ignore[call-overload, no-any-return]


def share(value: object, name: str) -> float:
    """Return a number from 0 to 1. Raises FigureError."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value <= 1.0:
        raise FigureError(f"{name} = {shown(value)}", "a number from 0 to 1")
    return float(value)


def _place(name: str, names: Any, what: str) -> int:
    for place, each in enumerate(names):
        if each == name:
            return place
    raise FigureError(shown(name), f"{what}{near(name, names)}")


# Metrics of a run


ARGUMENTS: Final = ("state", "action", "actions", "first", "last", "at")
"""Further arguments of some metrics."""


def measured(run: Run, measure: str, arguments: Mapping[str, Any]) -> Value:
    """Return a metric of `run`. Raises FigureError without a value."""
    condition = _condition(measure, arguments)
    try:
        return MEASURES[measure].of(JudgedMoment(run, run.recipe, Kept()), condition)
    except MissingError as reason:
        raise FigureError(f"{measure} has no value at that step: {reason}; choose another") from reason


def measuring(measure: str, arguments: Mapping[str, Any]) -> Callable[[Run], Value | None]:
    """Return a thread-safe function that measures a run, or returns None."""
    condition = _condition(measure, arguments)
    in_turn, kept = threading.Lock(), Kept()

    def of_run(run: Run) -> Value | None:
        with in_turn:
            try:
                return MEASURES[measure].of(JudgedMoment(run, run.recipe, kept), condition)
            except MissingError:
                return None

    return of_run


def _condition(measure: str, arguments: Mapping[str, Any]) -> Condition:
    row = MEASURES.get(measure)
    if row is None:
        raise FigureError(shown(measure), f"the name of a measure{near(measure, MEASURES)}")
    missing = [name for name in row.needs if name not in arguments]
    if missing:
        raise FigureError(f"{measure} needs {', '.join(row.needs)}; add {missing[0]}")
    given: dict[str, Any] = dict(arguments)
    for name in ("state", "action", "at"):
        if name in given:
            given[name] = name_of(given[name])
    for name in ("first", "last"):
        if name in given:
            given[name] = whole(given[name], name, 0, MOST_STEPS)
    if "actions" in given:
        actions = given["actions"]
        if not isinstance(actions, list) or len(actions) != 2:
            raise FigureError(f"actions = {shown(actions)}", "a list of two actions")
        given["actions"] = [name_of(each) for each in actions]
    try:
        return Condition.model_validate({"text": measure, "measure": measure, "equals": 0.0, **given})
    except ValueError as fault:
        raise FigureError(f"{shown(str(arguments))} are not arguments of {measure}; correct them") from fault


# Facts from the transition table


def states(subject: FigureSubject) -> int:
    """Return the number of states, including terminal and unreachable ones."""
    return subject.world.space.states


def live_states(subject: FigureSubject) -> int:
    """Return the number of states with actions: they can be reached, and the episode continues there."""
    return int(np.count_nonzero(np.diff(subject.world.space.first_pair)))


def pairs(subject: FigureSubject) -> int:
    """Return the number of state–action pairs, the cells of the table."""
    return subject.world.space.pairs


def actions(subject: FigureSubject, state: object = None) -> int:
    """Return the number of actions in all, or of those available in a state."""
    space = subject.world.space
    return len(space.action_names) if state is None else len(space.pairs_of(subject.state(state)))


def time_limit(subject: FigureSubject) -> int:
    """Return the largest number of steps in an episode, or 0 without a limit."""
    return subject.world.space.time_limit


def budget(subject: FigureSubject) -> int:
    """Return the budget of a bandit in pulls, or in episodes."""
    if subject.world.budget is None:
        raise FigureError("this world has no budget; choose a bandit")
    return subject.world.budget


def reward(subject: FigureSubject, state: object, action: object, next_state: object = None) -> float:
    """Return the mean reward of an action in a state, or of that action if it leads to `next_state`."""
    mdp = subject.mdp
    pair = subject.pair(state, action)
    if next_state is None:
        return float(mdp.expected_reward[pair])
    outcomes = _outcomes(subject, pair, next_state)
    if not len(outcomes):
        raise FigureError(
            f"{mdp.pair_name(pair)} never leads to {shown(name_of(next_state))}; "
            "choose a state to which it leads"
        )
    chances = mdp.probability[outcomes]
    return float(np.dot(chances, mdp.reward[outcomes]) / chances.sum())


def chance(subject: FigureSubject, state: object, action: object, next_state: object) -> float:
    """Return the probability that an action in a state leads to `next_state`."""
    return float(subject.mdp.probability[_outcomes(subject, subject.pair(state, action), next_state)].sum())


def _outcomes(subject: FigureSubject, pair: int, next_state: object) -> IntArray:
    mdp = subject.mdp
    own = np.array(mdp.outcomes_of(pair), dtype=np.int64)
    landing: IntArray = own[mdp.next_state[own] == subject.state(next_state)]
    return landing
