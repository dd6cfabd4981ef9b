"""What the two forms of the Q-table, a matrix and a list of pairs, have in common."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from rich.cells import cell_len
from rich.segment import Segment

from rl_tui.lab.live.editing.world_editor import EditorView
from rl_tui.lab.live.until import Breakpoints
from rl_tui.tui.draw.number_form import SteadyForms
from rl_tui.tui.panels.pointing import NOWHERE
from rl_tui.tui.panels.q_table.layers import Figures, Layer
from rl_tui.tui.panels.q_table.world import TableWorld
from rl_tui.tui.panels.world.edit_marks import marks_of
from rl_tui.tui.theme.look import Look

Pieces = list[Segment]
NO_BREAKPOINTS: Final = Breakpoints()
NOBODY_DRAWS: Final = EditorView()


@dataclass(frozen=True, slots=True)
class Scene:
    """What is drawn: the figures of each layer that can be shown, the agent's state and the cursor's pair.

    ``last_pair`` is the pair taken last. ``cursor`` is None where no cursor is to be seen; ``pointed`` are
    the pairs on which the cursor of another panel stands, or none. ``hides_means`` says that the means of a
    bandit are hidden. ``differing`` are the states whose greedy actions are others in the lane beside,
    ``editor`` knows what a person draws.
    """

    world: TableWorld
    figures: dict[Layer, Figures]
    layer: Layer
    state: int
    last_pair: int | None
    cursor: int | None
    hides_means: bool
    look: Look
    forms: SteadyForms
    breakpoints: Breakpoints = NO_BREAKPOINTS
    pointed: range = NOWHERE
    differing: frozenset[int] = frozenset()
    editor: EditorView = NOBODY_DRAWS

    @property
    def shown(self) -> Figures:
        """The figures of the layer in force."""
        return self.figures[self.layer]

    def state_mark(self, state: int) -> Segment:
        """Return the mark before a state: of the agent, of a breakpoint, or of both, or a blank."""
        palette, glyphs = self.look.palette, self.look.glyphs
        if state in self.breakpoints.states:
            return Segment(glyphs.agent if state == self.state else glyphs.breakpoint, palette.breakpoint)
        return Segment(glyphs.agent, palette.agent) if state == self.state else Segment(" ", palette.text)

    def is_pointed(self, pairs: range) -> bool:
        """Return whether the cursor of another panel stands on the state that owns ``pairs``, or on one."""
        return bool(self.pointed) and self.pointed.start in pairs

    def mark_behind(self, state: int) -> Segment | None:
        """Return the mark behind a state: other greedy actions in the lane beside, else that of an edit."""
        look = self.look
        if state in self.differing:
            return Segment(look.glyphs.differs, look.palette.accent)
        return next((Segment(*mark) for mark in marks_of(self.editor, state).signs(look)), None)


def boxed(scene: Scene, figures: Figures, pair: int, width: int, digits: int, is_greedy: bool) -> Pieces:
    """Return the cell of ``pair``: a number of up to ``digits`` cells amid ``width`` ones, between marks."""
    number = figures.text(pair, digits).rjust(figures.cells(digits)).center(width)
    return framed(scene, figures, pair, number, is_greedy)


def framed(scene: Scene, figures: Figures, pair: int, number: str, is_greedy: bool) -> Pieces:
    """Return the cell of ``pair``: ``number`` between marks.

    Marks stand on the background of the panel, so that they are seen beside every tint; a breakpoint takes
    the place of the left one.
    """
    palette, glyphs = scene.look.palette, scene.look.glyphs
    if pair == scene.cursor:
        style = palette.focus
    else:
        style = figures.style(pair) if figures.layer is scene.layer else figures.plain_style(pair)
    left = right = " "
    if is_greedy:
        lit = figures.is_lit(pair)
        left = glyphs.lit_left if lit else glyphs.mark_left
        right = glyphs.lit_right if lit else glyphs.mark_right
    if pair == scene.cursor:
        left = glyphs.cursor
    mark = Segment(left, palette.greedy)
    if pair in scene.breakpoints.pairs:
        mark = Segment(left if pair == scene.cursor else glyphs.breakpoint, palette.breakpoint)
    return [mark, Segment(number, style), Segment(right, palette.greedy)]


def padded(text: str, width: int) -> str:
    """Return ``text``, which is no wider than ``width`` cells, with blanks after it."""
    return text + " " * (width - cell_len(text))


def aligned_right(text: str, width: int) -> str:
    """Return ``text``, which is no wider than ``width`` cells, with blanks before it."""
    return " " * (width - cell_len(text)) + text
