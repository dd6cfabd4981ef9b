"""The drawing and the transition table of a watched program."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line
from rl_tui.common.limits import LONGEST_NAME, LONGEST_TIME_LIMIT, MOST_PAIRS
from rl_tui.common.own_ids import OWN_IDS
from rl_tui.common.streams import streams
from rl_tui.programs.watched.program_log import ProgramEnvironment
from rl_tui.runs.library import find
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.gym.blackjack import DREW, LOST, WON
from rl_tui.worlds.gym.section import GymnasiumSection
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray, all_pairs
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp
from rl_tui.worlds.sections.schema import WorldRefusedError, WorldSection
from rl_tui.worlds.world import World

_VERSION: Final = "-v0"
_BLACKJACK: Final = "Blackjack-v1"
_NOT_OF_THE_WORLD: Final = ("render_mode", "max_episode_steps")
_UNKNOWN: Final = -1
_LEAST_SHOWN: Final = 16
_SHOWN_FOR_EACH: Final = 2
"""States shown of a world that numbers them as it meets them, for each that was met at first."""
_FURTHER: Final = "further states"


@dataclass(frozen=True, slots=True, eq=False)
class ProgramWorld:
    """The world of a program's environment, with maps between its numbers and ours.

    The program's table has a cell, observation · A + action, for each pair. Our world may have several states
    for one observation, such as Blackjack's natural 21, which has another reward. P is the number of our
    pairs.
    """

    scenario: Scenario
    """Scenario of built-in runs for comparison."""
    world: World
    """The world, with a transition table if known."""
    cell_of_pair: IntArray
    """The cell of each pair, possibly shared, `[P]`."""
    pair_of_cell: IntArray
    """The pair of each cell, −1 if there is none, `[observations · A]`."""
    state_of: IntArray
    """The state of an observation within an episode, −1 if there is none, `[observations]`."""
    first_state_of: IntArray
    """The same for the first observation of an episode."""
    ends: Mapping[str, int] = field(default_factory=dict)
    """Blackjack's final states, which are not observations, else empty."""

    def is_same(self, other: ProgramWorld) -> bool:
        """Return True for the same environment and the same way."""
        mine, theirs = self.scenario, other.scenario
        is_made_alike = (mine.id, mine.section) == (theirs.id, theirs.section)
        spaces = self.world.space, other.world.space
        sizes = [(each.states, each.pairs, each.time_limit) for each in spaces]
        return is_made_alike and sizes[0] == sizes[1] and not isinstance(mine.section, _Unknown)

    def q_of(self, table: FloatArray) -> FloatArray:
        """Return our estimates, `[P]`, from the program's `table`, `[cells]`, 0 for missing ones."""
        return np.nan_to_num(table)[self.cell_of_pair]

    def state(self, observation: int, episode_step: int) -> int:
        """Return our state of `observation` after `episode_step` steps."""
        known = self.state_of if episode_step else self.first_state_of
        return max(int(known[observation]), 0)

    def landing(self, observation: int, reward: float, *, terminated: bool) -> int:
        """Return our state after a step."""
        if terminated and self.ends:
            return self.ends[WON if reward > 0.0 else DREW if reward == 0.0 else LOST]
        return max(int(self.state_of[observation]), 0)

    def pair(self, observation: int, action: int, episode_step: int) -> int:
        """Return our pair after `episode_step` steps, or −1."""
        state, space = self.state(observation, episode_step), self.world.space
        first, last = space.first_pair[state : state + 2].tolist()
        found = np.flatnonzero(space.pair_action[first:last] == action)
        return first + int(found[0]) if len(found) else _UNKNOWN


def world_of_program(environment: ProgramEnvironment) -> ProgramWorld:
    """Return the known world, the program's, or one without exact results. Raises UserError if too large."""
    cells = environment.states * environment.actions
    if cells > MOST_PAIRS:
        raise UserError(
            f"{_name(environment)} has {cells:,} state–action pairs; at most {MOST_PAIRS:,} can be watched"
        )
    for build in (_of_ours, _of_registered, _of_transitions):
        with suppress(Exception):  # an environment may raise anything here
            found = build(environment)
            if found is not None:
                return found
    return _program_world(_scenario(environment, _Unknown()), _bare_world(environment), environment)


class _Unknown(WorldSection):
    def build(self, generator: np.random.Generator) -> World:
        raise WorldRefusedError(
            ("id",), "a world that only the program knows", "a world that rl-tui can create"
        )


def _of_ours(environment: ProgramEnvironment) -> ProgramWorld | None:
    if not environment.id.startswith(OWN_IDS):
        return None
    kwargs = environment.kwargs or {}
    name = environment.id.removeprefix(OWN_IDS).removesuffix(_VERSION)
    scenario, seed = find(str(kwargs.get("scenario", name))), kwargs.get("scenario_seed", 0)
    return _fitting(scenario, scenario.build(streams(int(seed)).world), environment)


def _of_registered(environment: ProgramEnvironment) -> ProgramWorld | None:
    if environment.kwargs is None:
        return None
    kwargs = {name: value for name, value in environment.kwargs.items() if name not in _NOT_OF_THE_WORLD}
    for table in (True, None):
        section = GymnasiumSection(id=environment.id, kwargs=kwargs, table=table)
        try:
            world = section.build(streams(0).world)
        except WorldRefusedError:
            continue
        return _fitting(_scenario(environment, section), world, environment)
    return None


def _of_transitions(environment: ProgramEnvironment) -> ProgramWorld | None:
    from rl_tui.worlds.gym.table_layout import layout_of

    if environment.transitions is None or environment.start is None:
        return None
    start = {state: float(chance) for state, chance in enumerate(environment.start) if chance > 0.0}
    layout = layout_of(object(), environment.states, environment.actions, start)
    mdp = tabular_mdp(
        _state_names(environment),
        _action_names(environment),
        _transitions(environment.transitions),
        start,
        max(environment.time_limit, 0),
    )
    return _program_world(_scenario(environment, _Unknown()), World(mdp, layout.grid), environment)


def _transitions(table: Any) -> Iterator[Transition]:
    for state, actions in enumerate(table):
        for action, outcomes in enumerate(actions):
            listed = [Outcome(float(p), int(after), float(r), bool(ended)) for p, after, r, ended in outcomes]
            yield Transition(state, action, listed)


def _fitting(scenario: Scenario, world: World, environment: ProgramEnvironment) -> ProgramWorld | None:
    limit = min(max(environment.time_limit, 0), LONGEST_TIME_LIMIT)
    if world.space.time_limit != limit:
        world = replace(world, space=replace(world.space, time_limit=limit))
    if len(world.space.action_names) != environment.actions:
        return None
    if world.space.states == environment.states:
        return _program_world(scenario, world, environment)
    return _blackjack(scenario, world, environment) if environment.id == _BLACKJACK else None


def _program_world(scenario: Scenario, world: World, environment: ProgramEnvironment) -> ProgramWorld:
    """Return a world of observations. The last state may have all further ones."""
    space, numbers = world.space, np.minimum(np.arange(environment.states), world.space.states - 1)
    cell_of_pair: IntArray = space.pair_state * environment.actions + space.pair_action
    return ProgramWorld(
        scenario, world, cell_of_pair, _inverse(cell_of_pair, environment), numbers, numbers.copy()
    )


def _blackjack(scenario: Scenario, world: World, environment: ProgramEnvironment) -> ProgramWorld | None:
    space = world.space
    if not isinstance(space, TabularMDP) or len(environment.parts) != 3:
        return None
    state_of = np.full(environment.states, _UNKNOWN)
    first_state_of, observation_of = state_of.copy(), np.full(space.states, _UNKNOWN)
    for state, name in enumerate(space.state_names):
        if name in (WON, DREW, LOST):
            continue
        total, showing, kind = name.split(", ")
        made = (int(total), int(showing), int(kind != "no"))
        observation = int(np.ravel_multi_index(made, environment.parts))
        observation_of[state], first_state_of[observation] = observation, state
        if kind != "natural":
            state_of[observation] = state
    cell_of_pair: IntArray = observation_of[space.pair_state] * environment.actions + space.pair_action
    ends = {name: list(space.state_names).index(name) for name in (WON, DREW, LOST)}
    return ProgramWorld(
        scenario,
        world,
        cell_of_pair,
        _inverse(cell_of_pair, environment),
        state_of,
        first_state_of,
        ends,
    )


def _inverse(cell_of_pair: IntArray, environment: ProgramEnvironment) -> IntArray:
    pair_of_cell = np.full(environment.states * environment.actions, _UNKNOWN)
    pair_of_cell[cell_of_pair[::-1]] = np.arange(len(cell_of_pair))[::-1]
    return pair_of_cell


def _bare_world(environment: ProgramEnvironment) -> World:
    from rl_tui.worlds.gym.stepped_layout import product_grid

    space: FiniteSpace = all_pairs(
        _state_names(environment), _action_names(environment), max(environment.time_limit, 0)
    )
    parts = (space.states,) if environment.state_names else environment.parts
    return World(space, product_grid(parts, environment.actions))


def _state_names(environment: ProgramEnvironment) -> tuple[str, ...]:
    from rl_tui.worlds.gym.states import ProductNames

    met = len(environment.state_names)
    if met:
        shown = max(_LEAST_SHOWN, _SHOWN_FOR_EACH * met)
        return (*_distinct(environment.state_names, min(shown, environment.states - 1)), _FURTHER)
    first = environment.first_state or (0,) * len(environment.parts)
    numbers = [
        [str(start + place) for place in range(size)]
        for start, size in zip(first, environment.parts, strict=True)
    ]
    return tuple(ProductNames(numbers))


def _distinct(names: Sequence[str], count: int) -> Iterator[str]:
    seen: set[str] = set()
    for number in range(count):
        known = number < len(names)
        name = (one_line(names[number], LONGEST_NAME) if known else "") or f"#{number}"
        while name in seen:
            name += "′"
        seen.add(name)
        yield name


def _action_names(environment: ProgramEnvironment) -> tuple[str, ...]:
    if environment.action_names:
        return tuple(_distinct(environment.action_names, environment.actions))
    return tuple(str(environment.first_action + action) for action in range(environment.actions))


def _scenario(environment: ProgramEnvironment, section: WorldSection) -> Scenario:
    name = _name(environment)
    return Scenario(
        id=name,
        title=name,
        summary="",
        notes="",
        order=0,
        kind="gymnasium",
        defaults={},
        source=Path(name),
        section=section,
    )


def _name(environment: ProgramEnvironment) -> str:
    return one_line(environment.id, 80) or "environment"
