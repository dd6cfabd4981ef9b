"""What the Q-table has to know of a world once: its live states, and how states and actions are written."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cached_property
from typing import Final

import numpy as np
from rich.cells import cell_len

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.lab.live.viewport import followed_state
from rl_tui.tui.draw.action_order import shown_order, shown_pairs, shown_place
from rl_tui.tui.draw.canvas import shortened
from rl_tui.tui.draw.names import action_name, with_minus
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.mdp.number_names import NumberNames
from rl_tui.worlds.mdp.space import IntArray
from rl_tui.worlds.world import World

LONGEST_STATE: Final = 14
NO_ROW: Final = -1
MOST_MEASURED: Final = 10_000
_LEADING_ZERO: Final = re.compile(r"(?<![\d.])0(?=\.\d)")


class TableWorld:
    """A world's states and pairs as the table lists them: live states only, in their order.

    ``shown_actions`` are the numbers of all actions in the order of the columns.
    """

    def __init__(self, world: World, glyphs: Glyphs) -> None:
        self._world = world
        self.space = world.space
        self.glyphs = glyphs
        self.is_bandit = isinstance(world.drawing, Arms)
        self.live: IntArray = np.flatnonzero(np.diff(self.space.first_pair))
        self.state_width = min(LONGEST_STATE, self._longest(str))
        self.shown_actions = shown_order(world)
        self.action_names = tuple(
            to_ascii(action_name(world, action, glyphs), glyphs)
            for action in range(len(self.space.action_names))
        )
        self.action_width = max(map(cell_len, self.action_names))

    @cached_property
    def brief_width(self) -> int:
        """The cells that names of states take where they are written close together."""
        return min(self.state_width, self._longest(_brief))

    @cached_property
    def least_reward(self) -> float:
        """The least mean reward of an outcome; 0 where none is less or there is no table."""
        mdp = self._world.mdp
        return 0.0 if mdp is None else min(0.0, float(mdp.reward.min()))

    def _longest(self, form: Callable[[str], str]) -> int:
        """Return the cells of the longest name; of very many states, those of the last and of a sample.

        A name that the sample overlooks is drawn shortened.
        """
        names, live = self.space.state_names, self.live
        if isinstance(names, NumberNames):
            live = live[-1:]  # they rise
        if len(live) > MOST_MEASURED:
            live = np.append(live[:: -(-len(live) // MOST_MEASURED)], live[-1])
        return max(cell_len(form(names[state])) for state in live.tolist())

    def describes(self, world: World, glyphs: Glyphs) -> bool:
        """Return whether this is what is known of ``world`` in these characters."""
        return world is self._world and glyphs is self.glyphs

    @property
    def is_sparse(self) -> bool:
        """Whether one row a pair says it better: one state, or half the cells of a matrix would be empty."""
        cells = len(self.live) * len(self.space.action_names)
        return len(self.live) == 1 or 2 * self.space.pairs <= cells

    def state_name(self, state: int, width: int) -> str:
        """Return the name of ``state`` in ``width`` cells: written close together, or shortened."""
        name = to_ascii(with_minus(self.space.state_names[state], self.glyphs), self.glyphs)
        return name if cell_len(name) <= width else shortened(_brief(name), width, self.glyphs.ellipsis)

    def action_of(self, pair: int) -> int:
        """Return the action of ``pair``."""
        return int(self.space.pair_action[pair])

    def pairs_shown(self, state: int) -> list[int]:
        """Return the pairs of ``state`` in the order in which their actions are shown."""
        return shown_pairs(self._world, self.space.pairs_of(state))

    def pair_of_action(self, state: int) -> dict[int, int]:
        """Return the pair of each action that is legal in ``state``."""
        return {self.action_of(pair): pair for pair in self.space.pairs_of(state)}

    def row_of(self, state: int) -> int:
        """Return which of the live states ``state`` is, ``NO_ROW`` if none."""
        row = int(np.searchsorted(self.live, state))
        return row if row < len(self.live) and self.live[row] == state else NO_ROW

    def pair_near(self, state: int, action: int) -> int:
        """Return the pair of ``state`` whose column is nearest to that of ``action``."""
        column = shown_place(self._world, action)
        return min(
            self.pairs_shown(state),
            key=lambda pair: abs(shown_place(self._world, self.action_of(pair)) - column),
        )


def state_followed(snapshot: Snapshot) -> int:
    """Return the state that is to be in view: the agent's, or that of its last step where it has none."""
    return followed_state(snapshot.world.space, snapshot.counters.state, snapshot.counters.last_step)


def _brief(name: str) -> str:
    """Return ``-.03,1.8`` for ``-0.03, 1.8``."""
    return _LEADING_ZERO.sub("", name.replace(", ", ","))
