"""What a map that shows Q of every action says about itself: its heading and its signs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from rl_tui.tui.panels.legend import GREEDY_IN_FULL, LegendSign
from rl_tui.tui.panels.world.grid.action_form import ActionForm, Places
from rl_tui.tui.theme.look import Look

HEADING_NUMBERS: Final = "Q of every action"
HEADING_TINTS: Final = "Q of every action, as tint"


def heading_of(form: ActionForm) -> str:
    """Return what is drawn."""
    return HEADING_TINTS if form.places is Places.TINTS else HEADING_NUMBERS


def action_signs(form: ActionForm, look: Look) -> Iterator[LegendSign]:
    """Yield the signs of numbers and sides."""
    palette, glyphs = look.palette, look.glyphs
    # first: between others it would be taken for the dot that separates them
    yield LegendSign(glyphs.stay, "not tried", palette.unvisited)
    if form.places is Places.TINTS:
        yield LegendSign(glyphs.up, "greedy", palette.strong, GREEDY_IN_FULL)
    else:
        frame = glyphs.mark_left + glyphs.mark_right if form.is_framed else glyphs.mark_after
        yield LegendSign(frame, "greedy", palette.greedy, GREEDY_IN_FULL)
    if palette.tints:
        yield LegendSign(" tint ", "Q", palette.value(1.0), "value Q(s,a)")
