"""A scenario as a Gymnasium environment, with a transition table as in toy_text."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Final, NamedTuple

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium.error import InvalidAction
from gymnasium.spaces import Discrete

from rl_tui.common.streams import streams
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.environment import Environment
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.gym.advice import advice_kept
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.world import World

# The world as text


AGENT: Final = "@"
_CHARACTERS: Final[Mapping[CellKind, str]] = {
    CellKind.FLOOR: ".",
    CellKind.START: "S",
    CellKind.GOAL: "G",
    CellKind.HOLE: "H",
    CellKind.WALL: "#",
    CellKind.CLIFF: "C",
}


def text_picture(world: World, state: int, action: int | None) -> str:
    """Return the state as text, above the map if there is one."""
    taken = "" if action is None else f", after {world.space.action_names[action]}"
    line = f"state {world.space.state_names[state]}{taken}"
    drawing = world.drawing
    return f"{line}\n{_map(drawing, state)}" if isinstance(drawing, Grid) else f"{line}\n"


def _map(grid: Grid, state: int) -> str:
    cells = [_CHARACTERS[kind] for kind in grid.kinds]
    cells[grid.cell_of_state[state]] = AGENT
    rows = range(0, grid.rows * grid.columns, grid.columns)
    return "".join(f"{''.join(cells[first : first + grid.columns])}\n" for first in rows)


# The transition table as plain Python


Entry = tuple[float, int, float, bool]
"""Probability, next state, mean reward and end of the episode, as in Gymnasium's toy_text."""


class PairRow(NamedTuple):
    """The outcomes of one action in one state.

    `cumulative` and `reward_std` have one value per entry. `pair` is None in terminal states.
    """

    entries: list[Entry]
    cumulative: list[float]
    reward_std: list[float]
    pair: int | None


def rows_of(mdp: TabularMDP, state: int) -> list[PairRow]:
    """Return the row of each of the A actions in `state`.

    An unavailable action acts like the first available one. A terminal state leads to itself with reward 0.
    """
    pairs = mdp.pairs_of(state)
    if not pairs:
        return [PairRow([(1.0, state, 0.0, True)], [1.0], [0.0], None)] * len(mdp.action_names)
    legal = {int(mdp.pair_action[pair]): _row(mdp, pair) for pair in pairs}
    first = next(iter(legal.values()))
    return [legal.get(action, first) for action in range(len(mdp.action_names))]


def table_of(mdp: TabularMDP) -> dict[int, dict[int, list[Entry]]]:
    """Return state → action → entries."""
    return {
        state: {action: list(row.entries) for action, row in enumerate(rows_of(mdp, state))}
        for state in range(mdp.states)
    }


def _row(mdp: TabularMDP, pair: int) -> PairRow:
    here = slice(int(mdp.first_outcome[pair]), int(mdp.first_outcome[pair + 1]))
    columns = (each[here].tolist() for each in (mdp.probability, mdp.next_state, mdp.reward, mdp.terminated))
    return PairRow(
        list(zip(*columns, strict=True)), mdp.cumulative[here].tolist(), mdp.reward_std[here].tolist(), pair
    )


# The environment


class ScenarioEnv(gymnasium.Env[int, int]):  # type: ignore[misc]
    """The world of a scenario with the same states and probabilities, but without a time limit.

    ``info["prob"]`` is the probability of the outcome. If some states lack some actions,
    ``info["action_mask"]``, int8 [A], marks the available actions of the new state. An unavailable action
    acts like the first available one. Worlds without a transition table (cart pole with bins, an egg without
    a clock) have neither ``info["prob"]`` nor ``P``, and keep their own time limit.

    Args:
        scenario: Scenario id, path of a file, or a :class:`Scenario`.
        scenario_seed: Seed of a random world, as in ``rl-tui play``. The seed of ``reset`` draws the
            outcomes, and resets drifting arms.
        render_mode: ``"ansi"`` or None.

    Raises:
        UserError: The scenario does not exist, or its world cannot be made.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": ["ansi"], "render_fps": 4}

    def __init__(
        self, scenario: str | Path | Scenario, scenario_seed: int = 0, render_mode: str | None = None
    ) -> None:
        self.scenario, self.world = _found_and_built(scenario, scenario_seed)
        self.render_mode = render_mode
        space = self.world.space
        self.observation_space = Discrete(space.states)
        self.action_space = Discrete(len(space.action_names))
        self.s = 0
        self.lastaction: int | None = None
        self._actions = len(space.action_names)
        legal = np.diff(space.first_pair)
        self._is_masked = bool(((legal > 0) & (legal < self._actions)).any())
        self._mdp = self.world.mdp
        self._rows: dict[int, list[PairRow]] = {}
        self._offset: npt.NDArray[np.float64] | None = None
        self._stepped: Environment | None = None
        if self._mdp is None and self.world.new_environment is not None:
            with advice_kept():
                self._stepped = self.world.new_environment()

    @cached_property
    def P(self) -> dict[int, dict[int, list[Entry]]]:  # noqa: N802
        """State → action → [(probability, next state, reward, terminated), …].

        Rewards are means, before any drift. Changing the table does not change steps.

        Raises:
            AttributeError: The world has no transition table.
        """
        return table_of(self._table("P"))

    @cached_property
    def initial_state_distrib(self) -> npt.NDArray[np.float64]:
        """Probability of starting in each state, [S].

        Raises:
            AttributeError: The world has no transition table.
        """
        mdp = self._table("initial_state_distrib")
        start = np.zeros(mdp.states)
        np.add.at(start, mdp.start_state, mdp.start_probability)
        return start

    def _table(self, wanted: str) -> TabularMDP:
        if self._mdp is None:
            raise AttributeError(f"{wanted}: {self.scenario.id} has no transition table")
        return self._mdp

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[int, dict[str, Any]]:
        """Start an episode; see :meth:`gymnasium.Env.reset`. `options` are ignored."""
        super().reset(seed=seed)
        self.lastaction = None
        if self._mdp is None:
            assert self._stepped is not None
            self.s = self._stepped.reset(seed)
            return self.s, self._mask()
        if self._mdp.drift_std > 0.0 and (seed is not None or self._offset is None):
            self._offset = np.zeros(self._mdp.pairs)
        place = 0
        if len(self._mdp.start_state) > 1:
            draw = self.np_random.random()
            place = int(np.searchsorted(self._mdp.start_cumulative, draw, side="right"))
        self.s = int(self._mdp.start_state[place])
        return self.s, self._info(1.0)

    def step(self, action: int) -> tuple[int, float, bool, bool, dict[str, Any]]:
        """Take `action`; see :meth:`gymnasium.Env.step`.

        Raises:
            InvalidAction: The action does not exist.
        """
        if not 0 <= action < self._actions:
            raise InvalidAction(
                f"found action {action!r}; expected a whole number from 0 to {self._actions - 1}"
            )
        self.lastaction = int(action)
        if self._stepped is not None:
            result = self._stepped.step(self.lastaction)
            self.s = result.next_state
            return (*result, self._mask())
        rows = self._rows.get(self.s)
        if rows is None:
            rows = self._rows[self.s] = rows_of(self._table("step"), self.s)
        entries, cumulative, reward_std, pair = rows[action]
        outcome = bisect_right(cumulative, self.np_random.random()) if len(entries) > 1 else 0
        probability, self.s, reward, terminated = entries[outcome]
        if self._offset is not None and pair is not None:
            reward += self._drift(self._offset, pair)
        if reward_std[outcome] > 0.0:
            reward += reward_std[outcome] * self.np_random.standard_normal()
        return self.s, reward, terminated, False, self._info(probability)

    def _drift(self, offset: npt.NDArray[np.float64], pair: int) -> float:
        moved = float(offset[pair])
        offset += self._table("drift").drift_std * self.np_random.standard_normal(len(offset))
        return moved

    def _info(self, probability: float) -> dict[str, Any]:
        return {"prob": probability, **self._mask()}

    def _mask(self) -> dict[str, Any]:
        if not self._is_masked:
            return {}
        space = self.world.space
        mask = np.zeros(self._actions, dtype=np.int8)
        mask[space.pair_action[space.first_pair[self.s] : space.first_pair[self.s + 1]]] = 1
        return {"action_mask": mask}

    def render(self) -> str | None:
        """Return the world as text in the mode ``ansi``, else None."""
        return text_picture(self.world, self.s, self.lastaction) if self.render_mode == "ansi" else None

    def close(self) -> None:
        """Release the environment behind this one."""
        self._stepped = None


def time_limit_of_scenario(scenario: str | Path | Scenario) -> int | None:
    """Return the time limit in steps, or None.

    Raises:
        UserError: The scenario does not exist, or its world cannot be made.
    """
    return _found_and_built(scenario, 0)[1].space.time_limit or None


@advice_kept()
def _found_and_built(scenario: str | Path | Scenario, seed: int) -> tuple[Scenario, World]:
    found = scenario if isinstance(scenario, Scenario) else find(str(scenario))
    return found, found.build(streams(seed).world)
