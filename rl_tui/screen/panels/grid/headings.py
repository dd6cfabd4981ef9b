"""Texts on the border of a map."""

from __future__ import annotations

from itertools import compress
from typing import Final

from rl_tui.screen.panels.grid.action_form import ActionForm, Places
from rl_tui.screen.panels.grid.form import LEAST_ARROWS, CellForm
from rl_tui.screen.panels.grid.map import MapPart
from rl_tui.screen.panels.world.shown_policy import TITLE
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Grid

FOLLOWS: Final = "follows the agent"
FOLLOW_HINT: Final = "esc: follow the agent"
HEADING_ACTIONS: Final = f"{TITLE} · Q of every action"
HEADING_TINTS: Final = f"{HEADING_ACTIONS}, as tint"
STATE_NUMBERS: Final = "state numbers"


def heading_of_values(form: CellForm, arrows: str, look: Look) -> str:
    """Return the heading of cells with V and ``arrows``."""
    if form.has_values:
        return f"{TITLE} · V and {arrows}"
    return f"{TITLE} · {arrows}, V as colour" if look.palette.tints else f"{TITLE} · {arrows}"


def heading_of_actions(form: ActionForm) -> str:
    """Return the heading of cells with every action."""
    return HEADING_TINTS if form.places is Places.TINTS else HEADING_ACTIONS


def numbered(heading: str, form: CellForm, arrows: str, longest: int, *, in_corner: bool) -> tuple[str, ...]:
    """Return headings of cells with state numbers, longest first.

    ``longest``: characters of the longest number. ``in_corner``: numbers replace nothing.
    """
    if in_corner or form.has_corner:
        return f"{heading} · {STATE_NUMBERS}", f"{TITLE} · {STATE_NUMBERS}", STATE_NUMBERS
    has_arrows = form.has_values or longest <= form.width - LEAST_ARROWS
    what = f"{STATE_NUMBERS} and {arrows}" if has_arrows else STATE_NUMBERS
    return f"{TITLE} · {what}", f"{TITLE} · {STATE_NUMBERS}", STATE_NUMBERS


def shorter(legend: str) -> tuple[str, ...]:
    """Return ``legend`` and two shorter forms."""
    rows_and_columns = ", ".join(legend.split(", ")[:2])
    return legend, rows_and_columns, rows_and_columns.rpartition(": ")[2]


def stretch(first: int, shown: int, total: int) -> str:
    """Return the range of visible rows, counted from 0."""
    return f"{first}–{first + shown - 1} of {total:,}"


def where(grid: Grid, part: MapPart, *, follows: bool) -> tuple[str, ...]:
    """Return forms of the visible part, and how to follow the agent.

    The legend comes first while following.
    """
    follow = FOLLOWS if follows else FOLLOW_HINT
    is_cut = part.rows < grid.rows, part.columns < grid.columns
    in_view = stretch(part.top, part.rows, grid.rows), stretch(part.left, part.columns, grid.columns)
    stretches = tuple(compress(in_view, is_cut))
    named = " · ".join(map(" ".join, zip(compress(("rows", "columns"), is_cut), stretches, strict=True)))
    brief = " · ".join(stretches)
    legends = shorter(grid.legend) if grid.legend and follows else ()
    return (
        *(f"{legend} · {named}" for legend in legends),
        f"{named}, counted from 0 · {follow}",
        f"{named} · {follow}",
        f"{brief} · {follow}",
        *((named, brief) if follows else ()),  # following is obvious
        follow,
    )
