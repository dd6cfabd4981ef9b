"""The sections of the microscope, put below one another in one column or two."""

from __future__ import annotations

from typing import Final

from rich.segment import Segment
from textual.strip import Strip

from rl_tui.lab.live.backup import backup_of, sources
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw.pieces import KEPT_BLANK, Line, Piece, strips_of, wrapped
from rl_tui.tui.panels.last_step.last_step import NOTHING_YET
from rl_tui.tui.panels.last_step.loop_text import loop_text
from rl_tui.tui.panels.microscope import backup_tree, return_text
from rl_tui.tui.panels.microscope import step as microscope_step
from rl_tui.tui.panels.microscope import update as microscope_update
from rl_tui.tui.panels.microscope.backup_tree import backup_section
from rl_tui.tui.panels.microscope.cell_history import history_strips
from rl_tui.tui.panels.microscope.return_text import return_section
from rl_tui.tui.panels.microscope.section import MicroscopeSection, stacked
from rl_tui.tui.panels.microscope.step import step_section
from rl_tui.tui.panels.microscope.update import update_section
from rl_tui.tui.panels.q_table.layers import is_secret
from rl_tui.tui.panels.speeds import passes_too_fast
from rl_tui.tui.theme.look import Look

ROOM_FOR_TWO: Final = 96
TOO_FAST: Final = f"steps pass too fast to take one apart: space pauses, −{KEPT_BLANK}slows down"
_HISTORY_ROWS: Final = 7  # its heading, some rows of dots and the steps below them
_GAP: Final = 2


def page(
    snapshot: Snapshot | None, pair: int | None, look: Look, width: int, height: int, *, secret: bool
) -> list[Strip]:
    """Return all rows of the microscope, at least ``height`` where the history may grow.

    ``pair`` is the one whose history is shown; ``secret`` says that a bandit's means are not told.
    """
    columns = 2 if width >= ROOM_FOR_TWO else 1
    room = (width - _GAP * (columns - 1)) // columns
    if snapshot is None or snapshot.last is None:
        nothing: list[Line] = [[Piece(f" {NOTHING_YET}", look.palette.dim)]]
        return strips_of(nothing, width, 1, look)
    sections = _sections(snapshot, look, room, revealed=not secret)
    parts = (sections,) if columns == 1 else (sections[:2] + sections[3:], sections[2:3])
    least = _HISTORY_ROWS if columns == 1 else _HISTORY_ROWS - 1
    sides = [
        stacked(part, look, room, height - below)
        for part, below in zip(parts, (0, least + 1)[-columns:], strict=True)
    ]
    left = max(least, height - len(sides[-1]))
    sides[-1] = [*sides[-1], *history_strips(snapshot, pair, look, room, left, revealed=not secret)]
    return sides[0] if columns == 1 else _beside(sides[0], sides[1], room, width, look)


def _sections(snapshot: Snapshot, look: Look, width: int, *, revealed: bool) -> list[MicroscopeSection]:
    """Return the step, the update, the backup and the return."""
    last, backup = snapshot.last, backup_of(snapshot)
    if last is None or passes_too_fast(snapshot):
        return _calm(snapshot, look, width)
    text = loop_text(snapshot, last, look.glyphs)
    secret = is_secret(snapshot, revealed)
    tree = (
        backup_section(snapshot, backup, text, look, width, secret=secret)
        if backup is not None
        else MicroscopeSection(backup_tree.HEADING, [[Piece(f" {text.waiting}", look.palette.dim)]], 1)
    )
    return [
        step_section(snapshot, last, text, look, width),
        update_section(snapshot, last, text, sources(snapshot), look, width),
        tree,
        return_section(snapshot, last, look, width),
    ]


def _calm(snapshot: Snapshot, look: Look, width: int) -> list[MicroscopeSection]:
    """Return the headings with nothing below them that changes from frame to frame."""
    return [
        MicroscopeSection(
            microscope_step.HEADING,
            wrapped(TOO_FAST, width, look.palette.dim, look, " ", " "),
            microscope_step.ROWS,
        ),
        MicroscopeSection(microscope_update.HEADING, [], microscope_update.rows_of(snapshot)),
        MicroscopeSection(backup_tree.HEADING, [], backup_tree.rows_of(snapshot)),
        MicroscopeSection(return_text.HEADING, [], return_text.ROWS),
    ]


def _beside(left: list[Strip], right: list[Strip], room: int, width: int, look: Look) -> list[Strip]:
    """Return two columns of ``room`` cells side by side, as long as the longer one."""
    text = look.palette.text
    rows = max(len(left), len(right))
    blank = Strip.blank(room, text)
    padded = ([*side, *([blank] * (rows - len(side)))] for side in (left, right))
    gap = Segment(" " * (width - 2 * room), text)
    return [Strip([*one, gap, *other], width) for one, other in zip(*padded, strict=True)]
