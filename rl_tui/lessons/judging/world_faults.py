"""Names in tasks that do not exist in their worlds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from rl_tui.agents.compatibility import check_compatible
from rl_tui.common.errors import Fault, UserError
from rl_tui.common.findings import Finding, Location, near, place, shown
from rl_tui.lessons.file.setups import recipe_of
from rl_tui.lessons.judging.measures import MEASURES, MeasureKind
from rl_tui.lessons.judging.moment import why_too_dear
from rl_tui.runs.changes import journal_of, read_change
from rl_tui.runs.recipe import Recipe, begin

if TYPE_CHECKING:
    from rl_tui.lessons.file.schema import Attempt, Measured
    from rl_tui.lessons.lesson import Lesson
    from rl_tui.worlds.world import World

_OF_BANDITS = ("winnings", "regret", "best_arm_rate")


def reference_faults(lesson: Lesson) -> list[Fault]:
    """Return errors of setups, conditions and attempts in their worlds."""
    worlds: dict[str, tuple[Recipe, World]] = {}
    findings: list[Finding] = []
    for name in lesson.setups:
        try:
            recipe = recipe_of(lesson, name)
            worlds[name] = recipe, begin(recipe).world
            check_compatible(worlds[name][1].space, recipe.algorithm, recipe.hyperparameters)
        except UserError as reason:
            findings.append(Finding(("setups", name), f"this setup cannot run: {reason}"))
    for number, page in enumerate(lesson.pages):
        found = worlds.get(lesson.setup_of(page.id))
        if found is None:
            continue
        world = found[1]
        if page.prediction is not None and page.prediction.shows is not None:
            shows = _of_condition(page.prediction.shows, world)
            findings += (f.inside("pages", number, "prediction", "shows") for f in shows)
        if page.task is None:
            continue
        where = ("pages", number, "task")
        for each, condition in enumerate(page.task.conditions):
            findings += (f.inside(*where, "conditions", each) for f in _of_condition(condition, world))
        for kind, attempts in (("accepts", page.task.accepts), ("rejects", page.task.rejects)):
            for each, attempt in enumerate(attempts):
                findings += (f.inside(*where, kind, each) for f in _of_attempt(attempt, world))
    return [Fault(str(lesson.source), place(each.location), each.found, each.expected) for each in findings]


def _of_condition(condition: Measured, world: World) -> Iterator[Finding]:
    space = world.space
    measure = MEASURES[condition.measure]
    state = None
    if condition.state is not None:
        if condition.state not in space.state_names:
            yield Finding(
                ("state",), shown(condition.state), _one_of("a state", space.state_names, condition.state)
            )
        else:
            state = space.state_names.index(condition.state)
    for where, action in _actions_named(condition):
        yield from _of_action(where, action, state, world)
    if measure.name in _OF_BANDITS and world.budget is None:
        yield Finding(("measure",), f"{measure.name} works only for bandits; choose another measure")
    if measure.kind is MeasureKind.EXACT and world.mdp is None:
        found = f"{measure.name} needs a transition table, and this world has none; choose another measure"
        yield Finding(("measure",), found)
    elif measure.kind is MeasureKind.EXACT and world.mdp is not None:
        refused = why_too_dear(world.mdp, value_of_policy=measure.name == "value_at_start")
        if refused:
            yield Finding(("measure",), f"{measure.name} is not available: {refused}; choose another measure")


def _actions_named(condition: Measured) -> Iterator[tuple[Location, str]]:
    from rl_tui.lessons.file.schema import Condition

    if condition.action is not None:
        yield ("action",), condition.action
    for number, action in enumerate(condition.actions):
        yield ("actions", number), action
    if isinstance(condition, Condition) and condition.measure in ("policy_in", "optimal_actions_in"):
        for action in str(condition.equals or "").split(", "):
            if action:
                yield ("equals",), action
        for number, each in enumerate(condition.one_of):
            for action in str(each).split(", "):
                yield ("one_of", number), action


def _of_action(where: Location, action: str, state: int | None, world: World) -> Iterator[Finding]:
    space = world.space
    if action not in space.action_names:
        yield Finding(where, shown(action), _one_of("an action", space.action_names, action))
    elif state is not None and space.pair_of(state, space.action_names.index(action)) is None:
        possible = [space.action_names[space.pair_action[pair]] for pair in space.pairs_of(state)]
        expected = _one_of(f"an action of {space.state_names[state]}", possible, action)
        yield Finding(where, shown(action), expected)


def _of_attempt(attempt: Attempt, world: World) -> Iterator[Finding]:
    for number, change in enumerate(attempt.changes):
        try:
            journal_of([read_change(change)], world.space.action_names)
        except UserError as reason:
            yield Finding(("changes", number), f"{shown(change)}: {reason}")


def _one_of(kind: str, names: Sequence[str], name: str) -> str:
    known = ", ".join(names[:20]) + (", …" if len(names) > 20 else "") or "none"
    return f"{kind}, one of {known}{near(name, names)}"
