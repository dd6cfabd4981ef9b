"""The Q-table as a matrix: a row a state, a column an action, in several blocks where that helps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from rich.cells import cell_len
from rich.segment import Segment

from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.panels.q_table.layers import LEARNED_NOT
from rl_tui.screen.panels.q_table.world import Pieces, Scene, aligned_right, boxed, padded

LEAST_FIELD: Final = 3  # .54
FIELD_WITH_SIGN: Final = 4
MOST_FIELD: Final = 9
MOST_DIGITS: Final = 6
_MARKS: Final = 2
_GAP: Final = 1
_AROUND_LABEL: Final = 2  # the agent's mark before it, a blank after it


@dataclass(frozen=True, slots=True)
class MatrixForm:
    """``field`` cells a number, between two marks and a ``gap``; ``label`` cells for the name of a state."""

    scene: Scene
    blocks: int
    field: int
    label: int
    gap: int = _GAP

    @property
    def _column(self) -> int:
        return self.field + _MARKS + self.gap

    @property
    def block_width(self) -> int:
        """The cells that a block takes."""
        return self.label + _AROUND_LABEL + len(self.scene.world.action_names) * self._column

    @property
    def entries(self) -> int:
        """How many entries there are: one for each live state."""
        return len(self.scene.world.live)

    def heads(self) -> Pieces:
        """Return the actions, each above the middle of its column."""
        width, ellipsis = self.field + _MARKS, self.scene.look.glyphs.ellipsis
        text = " " * (self.label + _AROUND_LABEL)
        names = [self.scene.world.action_names[action] for action in self.scene.world.shown_actions]
        for name, following in zip(names, (*names[1:], ""), strict=True):
            # the gap may be used where no other name begins right behind it
            reach = self._column if cell_len(following) < width - 1 else width
            text += padded(_centred(shortened(name, reach, ellipsis), width), self._column)
        return [Segment(text, self.scene.look.palette.dim)]

    def entry(self, entry: int, is_first: bool) -> Pieces:
        """Return the row of a state, empty where an action is not legal."""
        scene, world, shown = self.scene, self.scene.world, self.scene.shown
        palette = scene.look.palette
        state = int(world.live[entry])
        pairs = world.space.pairs_of(state)
        here = state == scene.state
        name = aligned_right(world.state_name(state, self.label), self.label)
        style = palette.strong if here else palette.dim
        pieces = [
            scene.state_mark(state),
            Segment(name, palette.focus if scene.is_pointed(pairs) else style),
            scene.mark_behind(state) or Segment(" ", style),
        ]
        greedy = shown.framed(pairs)
        digits = min(self.field, MOST_DIGITS)
        blank, gap = Segment(" " * self._column, palette.text), Segment(" " * self.gap, palette.text)
        pair_of = world.pair_of_action(state)
        for action in world.shown_actions:
            pair = pair_of.get(action)
            if pair is None:
                pieces.append(blank)
                continue
            pieces += boxed(scene, shown, pair, self.field, digits, pair in greedy)
            pieces += [gap] * self.gap
        return pieces

    def pairs_in(self, entry: int) -> range:
        """Return the pairs of the state."""
        return self.scene.world.space.pairs_of(int(self.scene.world.live[entry]))

    def entry_of(self, state: int) -> int:
        """Return the row of ``state``."""
        return self.scene.world.row_of(state)

    def entry_of_pair(self, pair: int) -> int:
        """Return the row of the state that owns ``pair``."""
        return self.scene.world.row_of(self.scene.world.space.state_of(pair))

    def moved(self, pair: int, rows: int, columns: int) -> int:
        """Return the nearest pair so many rows below, or so many legal actions to the right."""
        world, state = self.scene.world, self.scene.world.space.state_of(pair)
        if rows:
            row = max(0, min(self.entries - 1, world.row_of(state) + rows))
            return world.pair_near(int(world.live[row]), world.action_of(pair))
        pairs = world.pairs_shown(state)
        return pairs[max(0, min(len(pairs) - 1, pairs.index(pair) + columns))]

    def pair_at(self, entry: int, x: int) -> int | None:
        """Return the pair of the action whose column is at ``x``."""
        column = (x - self.label - _AROUND_LABEL) // self._column
        if not 0 <= column < len(self.scene.world.shown_actions):
            return None
        pair_of = self.scene.world.pair_of_action(int(self.scene.world.live[entry]))
        return pair_of.get(self.scene.world.shown_actions[column])


def matrix_form(scene: Scene, width: int, lines: int) -> MatrixForm | None:
    """Return the form for ``width`` cells and ``lines`` rows of states, None where the columns do not fit.

    Several blocks only where they save all scrolling; no gaps, and names of states in short, only where the
    columns do not fit otherwise.
    """
    needed = -(-len(scene.world.live) // max(1, lines))
    if needed > 1:
        least = LEAST_FIELD if _fits_narrow(scene) else FIELD_WITH_SIGN
        if (form := _form(scene, needed, width, least, scene.world.state_width)) is not None:
            return form
        width -= 1  # the scroll bar
    least = LEAST_FIELD if min(scene.shown.low, scene.world.least_reward) > -99.5 else FIELD_WITH_SIGN
    labels = scene.world.state_width, scene.world.brief_width
    forms = (_form(scene, 1, width, least, label, gap) for gap in (_GAP, 0) for label in labels)
    return next(filter(None, forms), None)


def _form(
    scene: Scene, blocks: int, width: int, least: int, label: int, gap: int = _GAP
) -> MatrixForm | None:
    actions = len(scene.world.action_names)
    field = (width // blocks - label - _AROUND_LABEL) // actions - _MARKS - gap
    return MatrixForm(scene, blocks, min(MOST_FIELD, field), label, gap) if field >= least else None


def _fits_narrow(scene: Scene) -> bool:
    """Return whether the numbers say enough in three cells: fractions without signs, and nothing above 9.

    What is to come counts too, so that the layout does not change with the first number: a difference has a
    sign sooner or later, and so have estimates where rewards are negative.
    """
    figures = scene.shown
    if figures.layer not in (Layer.Q, *LEARNED_NOT) or scene.world.least_reward < 0.0:
        return False
    return figures.low >= 0.0 and len(numbers.fixed(figures.high, 1)) <= LEAST_FIELD


def _centred(text: str, width: int) -> str:
    """Return ``text`` with the blanks before it that put it in the middle of ``width`` cells."""
    return " " * (max(0, width - cell_len(text)) // 2) + text
