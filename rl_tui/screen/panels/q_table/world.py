"""Names and marks in a Q-table."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Final

import numpy as np
from rich.cells import cell_len
from rich.segment import Segment
from rich.style import Style

from rl_tui.live.snapshot import Snapshot
from rl_tui.live.viewport import followed_state
from rl_tui.screen.draw.action_order import shown_order, shown_pairs, shown_place
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.draw.names import action_name, with_minus
from rl_tui.screen.draw.number_form import SteadyForms
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.panels.q_table.layers import Figures
from rl_tui.screen.panels.world.edit_marks import marks_of
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.mdp.space import IntArray, NumberNames
from rl_tui.worlds.world import World

# States and actions


LONGEST_STATE: Final = 14
NO_ROW: Final = -1
MOST_MEASURED: Final = 10_000
_MOST_NAMES: Final = 4_096
_LEADING_ZERO: Final = re.compile(r"(?<![\d.])0(?=\.\d)")


class TableWorld:
    """States with actions, and pairs, in table order."""

    def __init__(self, world: World, glyphs: Glyphs) -> None:
        self.world = world
        self.space = world.space
        self.glyphs = glyphs
        self.live: IntArray = np.flatnonzero(np.diff(self.space.first_pair))
        if isinstance(world.drawing, Grid) and world.drawing.idle_cell is not None:
            cell_of_state = np.array(world.drawing.cell_of_state)
            self.live = self.live[cell_of_state[self.live] != world.drawing.idle_cell]
        cells = len(self.live) * len(self.space.action_names)
        self.is_sparse = len(self.live) == 1 or 2 * self.space.pairs <= cells
        """Whether one row per pair is better than a mostly empty matrix."""
        self.state_width = min(LONGEST_STATE, self._longest(str))
        self.shown_actions = shown_order(world)
        self.action_names = tuple(
            glyphs.spelled(action_name(world, action, glyphs))
            for action in range(len(self.space.action_names))
        )
        self.action_width = max(map(cell_len, self.action_names))
        self.state_name = lru_cache(_MOST_NAMES)(self._state_name)
        """The name of a state: complete, compact or shortened."""

    def name_head(self, width: int) -> str:
        """Return the longest heading that fits ``width``, else the shortest in a column more."""
        drawing, names = self.world.drawing, self.space.state_names
        forms = drawing.name_parts if isinstance(drawing, Grid) else ()
        forms = tuple(each for each in forms if each.count(",") == names[0].count(","))
        fitting = next((each for each in forms if len(each) <= width), "")
        return fitting or "".join(each for each in forms[-1:] if len(each) <= width + 1)

    @cached_property
    def brief_width(self) -> int:
        """The width of compact state names."""
        return min(self.state_width, self._longest(_brief))

    @cached_property
    def least_reward(self) -> float:
        """The least mean reward of an outcome, at most 0."""
        mdp = self.world.mdp
        return 0.0 if mdp is None else min(0.0, float(mdp.reward.min()))

    def _longest(self, form: Callable[[str], str]) -> int:
        names, live = self.space.state_names, self.live
        if isinstance(names, NumberNames):
            live = live[-1:]  # they rise, so the last one is the longest
        if len(live) > MOST_MEASURED:
            live = np.append(live[:: -(-len(live) // MOST_MEASURED)], live[-1])
        return max(cell_len(form(names[state])) for state in live.tolist())

    def _state_name(self, state: int, width: int) -> str:
        name = self.glyphs.spelled(with_minus(self.space.state_names[state], self.glyphs))
        return name if cell_len(name) <= width else shortened(_brief(name), width, self.glyphs.ellipsis)

    def action_of(self, pair: int) -> int:
        """Return a pair's action."""
        return int(self.space.pair_action[pair])

    def siblings(self, pair: int) -> range:
        """Return all pairs of the pair's state."""
        return self.space.pairs_of(self.space.state_of(pair))

    def pairs_shown(self, state: int) -> list[int]:
        """Return a state's pairs in display order."""
        return shown_pairs(self.world, self.space.pairs_of(state))

    def pair_of_action(self, state: int) -> dict[int, int]:
        """Return the pair of each available action."""
        pairs = self.space.pairs_of(state)
        return dict(zip(self.space.pair_action[pairs.start : pairs.stop].tolist(), pairs, strict=True))

    def row_of(self, state: int) -> int:
        """Return a state's row, or ``NO_ROW``."""
        row = int(np.searchsorted(self.live, state))
        return row if row < len(self.live) and self.live[row] == state else NO_ROW

    def pair_near(self, state: int, action: int) -> int:
        """Return the pair with the nearest action."""
        column = shown_place(self.world, action)
        return min(
            self.pairs_shown(state),
            key=lambda pair: abs(shown_place(self.world, self.action_of(pair)) - column),
        )


def state_followed(snapshot: Snapshot) -> int:
    """Return the live state to keep visible."""
    return followed_state(snapshot.world.space, snapshot.counters.state, snapshot.counters.last_step)


def _brief(name: str) -> str:
    return _LEADING_ZERO.sub("", name.replace(", ", ","))


# Cells of both forms


Pieces = list[Segment]


@dataclass(frozen=True, slots=True)
class Scene:
    """The contents of both forms.

    ``pointed``: pairs under another panel's cursor. ``differing``: other greedy actions in the second run.
    """

    world: TableWorld
    figures: dict[Layer, Figures]
    shown: Figures
    snapshot: Snapshot
    cursor: int | None
    look: Look
    forms: SteadyForms
    pointed: range
    differing: frozenset[int]

    def state_mark(self, state: int) -> Segment:
        """Return agent or breakpoint before a state."""
        palette, glyphs, is_here = self.look.palette, self.look.glyphs, state == self.snapshot.counters.state
        if state in self.snapshot.playback.breakpoints.states:
            return Segment(glyphs.agent if is_here else glyphs.breakpoint, palette.breakpoint)
        return Segment(glyphs.agent, palette.agent) if is_here else Segment(" ", palette.text)

    def is_pointed(self, pairs: range) -> bool:
        """Return whether another panel's cursor is here."""
        return bool(self.pointed) and self.pointed.start in pairs

    def mark_behind(self, state: int) -> Segment | None:
        """Return difference or edit after a state."""
        look = self.look
        if state in self.differing:
            return Segment(look.glyphs.differs, look.palette.text)
        return next((Segment(*mark) for mark in marks_of(self.snapshot.editor, state).signs(look)), None)


def boxed(scene: Scene, figures: Figures, pair: int, width: int, digits: int, is_greedy: bool) -> Pieces:
    """Centre a pair's number in its cell."""
    number = figures.text(pair, digits).rjust(figures.cells(digits)).center(width)
    return framed(scene, figures, pair, number, is_greedy)


def framed(scene: Scene, figures: Figures, pair: int, number: str, is_greedy: bool) -> Pieces:
    """Put marks around a pair's ``number``."""
    palette, glyphs = scene.look.palette, scene.look.glyphs
    style = palette.focus if pair == scene.cursor else figures.style(pair, is_tinted=figures is scene.shown)
    left = Segment(glyphs.mark_left if is_greedy else " ", palette.best)
    right = Segment(glyphs.mark_right if is_greedy else " ", palette.best)
    error = figures.error(pair)
    if error is not None:
        left = Segment(glyphs.lit, palette.error(error))
        if error and number.endswith(" "):
            number = number[:-1] + glyphs.moved[error > 0]
        style += Style(reverse=not palette.tints, bold=True)
    stops = pair in scene.snapshot.playback.breakpoints.pairs
    if stops:
        left = Segment(glyphs.breakpoint, palette.breakpoint)
    if pair == scene.cursor:
        left = Segment(glyphs.cursor, palette.breakpoint if stops else palette.you)
    return [left, Segment(number, style), right]


def padded(text: str, width: int) -> str:
    """Pad ``text`` at the end."""
    return text + " " * (width - cell_len(text))


def aligned_right(text: str, width: int) -> str:
    """Pad ``text`` at the start."""
    return " " * (width - cell_len(text)) + text
