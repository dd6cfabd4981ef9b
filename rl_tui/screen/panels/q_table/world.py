"""The world of a Q-table: names and marks."""

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

from rl_tui.live.pace.until import Breakpoints
from rl_tui.live.snapshot import Snapshot
from rl_tui.live.viewport import followed_state
from rl_tui.live.world_editor import EditorView
from rl_tui.screen.draw.action_order import shown_order, shown_pairs, shown_place
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.draw.names import action_name, with_minus
from rl_tui.screen.draw.number_form import SteadyForms
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.panels.q_table.layers import Figures
from rl_tui.screen.panels.world.edit_marks import marks_of
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Arms, Grid
from rl_tui.worlds.mdp.space import IntArray, NumberNames
from rl_tui.worlds.world import World

# States and actions


LONGEST_STATE: Final = 14
NO_ROW: Final = -1
MOST_MEASURED: Final = 10_000
_MOST_NAMES: Final = 4_096
_LEADING_ZERO: Final = re.compile(r"(?<![\d.])0(?=\.\d)")


class TableWorld:
    """The states with actions and the pairs, in table order."""

    def __init__(self, world: World, glyphs: Glyphs) -> None:
        self.world = world
        self.space = world.space
        self.glyphs = glyphs
        self.is_bandit = isinstance(world.drawing, Arms)
        self.live: IntArray = np.flatnonzero(np.diff(self.space.first_pair))
        cells = len(self.live) * len(self.space.action_names)
        self.is_sparse = len(self.live) == 1 or 2 * self.space.pairs <= cells
        """Whether one row per pair is better than a mostly empty matrix."""
        self.state_width = min(LONGEST_STATE, self._longest(str))
        self.shown_actions = shown_order(world)
        self.action_names = tuple(
            to_ascii(action_name(world, action, glyphs), glyphs)
            for action in range(len(self.space.action_names))
        )
        self.action_width = max(map(cell_len, self.action_names))
        self.state_name = lru_cache(_MOST_NAMES)(self._state_name)
        """The name of a state: complete, compact or shortened."""

    def name_head(self, width: int) -> str:
        """Return the longest heading of state names in ``width`` cells, or nothing."""
        drawing, names = self.world.drawing, self.space.state_names
        forms = drawing.name_parts if isinstance(drawing, Grid) else ()
        fitting = (each for each in forms if len(each) <= width and each.count(", ") == names[0].count(", "))
        return next(fitting, "")

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
        """Return the width of the longest name, from a sample if many."""
        names, live = self.space.state_names, self.live
        if isinstance(names, NumberNames):
            live = live[-1:]  # they rise, so the last one is the longest
        if len(live) > MOST_MEASURED:
            live = np.append(live[:: -(-len(live) // MOST_MEASURED)], live[-1])
        return max(cell_len(form(names[state])) for state in live.tolist())

    def _state_name(self, state: int, width: int) -> str:
        name = to_ascii(with_minus(self.space.state_names[state], self.glyphs), self.glyphs)
        return name if cell_len(name) <= width else shortened(_brief(name), width, self.glyphs.ellipsis)

    def action_of(self, pair: int) -> int:
        """Return the action of ``pair``."""
        return int(self.space.pair_action[pair])

    def siblings(self, pair: int) -> range:
        """Return all pairs of ``pair``'s state."""
        return self.space.pairs_of(self.space.state_of(pair))

    def pairs_shown(self, state: int) -> list[int]:
        """Return the pairs of ``state`` in display order."""
        return shown_pairs(self.world, self.space.pairs_of(state))

    def pair_of_action(self, state: int) -> dict[int, int]:
        """Return the pair of each action available in ``state``."""
        pairs = self.space.pairs_of(state)
        return dict(zip(self.space.pair_action[pairs.start : pairs.stop].tolist(), pairs, strict=True))

    def row_of(self, state: int) -> int:
        """Return the row of ``state``, or ``NO_ROW``."""
        row = int(np.searchsorted(self.live, state))
        return row if row < len(self.live) and self.live[row] == state else NO_ROW

    def pair_near(self, state: int, action: int) -> int:
        """Return the pair of ``state`` with the nearest action."""
        column = shown_place(self.world, action)
        return min(
            self.pairs_shown(state),
            key=lambda pair: abs(shown_place(self.world, self.action_of(pair)) - column),
        )


def state_followed(snapshot: Snapshot) -> int:
    """Return the state to keep visible, not a terminal one."""
    return followed_state(snapshot.world.space, snapshot.counters.state, snapshot.counters.last_step)


def _brief(name: str) -> str:
    return _LEADING_ZERO.sub("", name.replace(", ", ","))


# Cells of both forms


Pieces = list[Segment]


@dataclass(frozen=True, slots=True)
class Scene:
    """The contents of both forms of the table.

    ``shown``: current layer. ``pointed``: pairs under another panel's cursor. ``differing``: other greedy
    actions in the second run.
    """

    world: TableWorld
    figures: dict[Layer, Figures]
    shown: Figures
    state: int
    last_pair: int | None
    cursor: int | None
    hides_means: bool
    look: Look
    forms: SteadyForms
    breakpoints: Breakpoints
    pointed: range
    differing: frozenset[int]
    editor: EditorView

    def state_mark(self, state: int) -> Segment:
        """Return the mark before a state: agent or breakpoint."""
        palette, glyphs = self.look.palette, self.look.glyphs
        if state in self.breakpoints.states:
            return Segment(glyphs.agent if state == self.state else glyphs.breakpoint, palette.breakpoint)
        return Segment(glyphs.agent, palette.agent) if state == self.state else Segment(" ", palette.text)

    def is_pointed(self, pairs: range) -> bool:
        """Return whether another panel's cursor is on ``pairs``."""
        return bool(self.pointed) and self.pointed.start in pairs

    def mark_behind(self, state: int) -> Segment | None:
        """Return the mark after a state: difference or edit."""
        look = self.look
        if state in self.differing:
            return Segment(look.glyphs.differs, look.palette.text)
        return next((Segment(*mark) for mark in marks_of(self.editor, state).signs(look)), None)


def boxed(scene: Scene, figures: Figures, pair: int, width: int, digits: int, is_greedy: bool) -> Pieces:
    """Return the cell of ``pair``, with its number centred."""
    number = figures.text(pair, digits).rjust(figures.cells(digits)).center(width)
    return framed(scene, figures, pair, number, is_greedy)


def framed(scene: Scene, figures: Figures, pair: int, number: str, is_greedy: bool) -> Pieces:
    """Return the cell of ``pair``, with marks around ``number``."""
    palette, glyphs = scene.look.palette, scene.look.glyphs
    style = palette.focus if pair == scene.cursor else figures.style(pair, is_tinted=figures is scene.shown)
    left = Segment(glyphs.mark_left if is_greedy else " ", palette.best)
    right = Segment(glyphs.mark_right if is_greedy else " ", palette.best)
    if figures is scene.shown and (side := figures.side(pair)):
        number = _in_margin(number, glyphs.beyond[side > 0], 0)
    error = figures.error(pair)
    if error is not None:
        left = Segment(glyphs.lit, palette.error(error))
        number = _in_margin(number, glyphs.moved[error > 0], -1) if error else number
        style += Style(reverse=not palette.tints, bold=True)
    if pair in scene.breakpoints.pairs:
        left = Segment(glyphs.breakpoint, palette.breakpoint)
    if pair == scene.cursor:
        left = Segment(glyphs.cursor, palette.breakpoint if pair in scene.breakpoints.pairs else palette.you)
    return [left, Segment(number, style), right]


def _in_margin(number: str, sign: str, at: int) -> str:
    """Put ``sign`` over a blank at the start (0) or end (−1) of ``number``."""
    if number[at : at + 1 or None] != " ":
        return number
    return number[:-1] + sign if at else sign + number[1:]


def padded(text: str, width: int) -> str:
    """Return ``text`` padded at the end."""
    return text + " " * (width - cell_len(text))


def aligned_right(text: str, width: int) -> str:
    """Return ``text`` padded at the start."""
    return " " * (width - cell_len(text)) + text
