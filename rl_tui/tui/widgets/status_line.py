"""One row: what runs, whether it runs, how fast, and how far it has come."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from rich.cells import cell_len, set_cell_size
from rich.style import Style
from textual.strip import Strip

from rl_tui.agents.catalogue import BY_ID
from rl_tui.lab.snapshot import Phase, Snapshot
from rl_tui.tui import numbers
from rl_tui.tui.canvas import shortened
from rl_tui.tui.theme.look import Look
from rl_tui.tui.widgets.panel import Panel
from rl_tui.tui.widgets.pieces import Line, Piece, strips_of
from rl_tui.tui.widgets.settings import speed_text
from rl_tui.tui.written import separated, written
from rl_tui.worlds.drawing import Arms

WIDE: Final = 100
WAITING: Final = "the world is being built"
_GAP: Final = 2
_LEAST_TITLE: Final = 12
_STATE_COLUMNS: Final = 11


@dataclass(frozen=True, slots=True)
class _Field:
    """A part of fixed width, so that nothing beside it moves while its number grows."""

    text: str
    columns: int
    style: Style


class StatusLine(Panel):
    """Draws phase, speed, episodes and steps of the newest snapshot; a message takes the whole row."""

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the row, and blank ones below it."""
        return strips_of([status_line(snapshot, self.look, width)], width, height, self.look)


def status_line(snapshot: Snapshot | None, look: Look, width: int) -> Line:
    """Return the row for ``width`` cells."""
    palette, glyphs = look.palette, look.glyphs
    if snapshot is None:
        return [Piece(f" {WAITING}", palette.dim)]
    if snapshot.phase is Phase.STOPPED:
        message = shortened(
            written(f" {glyphs.stopped} stopped: {snapshot.message}", glyphs), width, glyphs.ellipsis
        )
        return [Piece(message, palette.bad)]
    if snapshot.phase is Phase.PREPARING:
        return _preparing(snapshot, look, width)
    fields = _fields(snapshot, look, wide=width >= WIDE)
    room = width - 1 - _LEAST_TITLE
    while len(fields) > 1 and sum(field.columns + _GAP for field in fields) > room:
        fields = fields[:-1]
    right = [
        Piece(" " * _GAP + set_cell_size(written(field.text, glyphs), field.columns), field.style)
        for field in fields
    ]
    taken = sum(cell_len(piece.text) for piece in right)
    title = _title(snapshot, look, width - 1 - taken)
    return [Piece(f" {set_cell_size(title, max(0, width - 1 - taken))}", palette.strong), *right]


def _title(snapshot: Snapshot, look: Look, width: int) -> str:
    recipe = snapshot.recipe
    full = f"{recipe.scenario.title} · {BY_ID[snapshot.algorithm].name} · seed {recipe.seed}"
    full, title = (separated(each, look.glyphs) for each in (full, recipe.scenario.title))
    return full if cell_len(full) <= width else shortened(title, max(0, width), look.glyphs.ellipsis)


def _preparing(snapshot: Snapshot, look: Look, width: int) -> Line:
    palette, glyphs = look.palette, look.glyphs
    message = written(f"  preparing: {snapshot.message}", glyphs)
    title = _title(snapshot, look, max(0, width - 1 - cell_len(message)))
    if cell_len(title) < _LEAST_TITLE:
        title = ""
    message = shortened(
        message if title else message[1:], width - cell_len(title) - bool(title), glyphs.ellipsis
    )
    return [*([Piece(f" {title}", palette.strong)] if title else []), Piece(message, palette.accent)]


def _fields(snapshot: Snapshot, look: Look, *, wide: bool) -> list[_Field]:
    """Return state, progress and measured speed, the most important first."""
    palette = look.palette
    fields = [_state(snapshot, look)]
    plans = BY_ID[snapshot.algorithm].planner
    if isinstance(snapshot.world.drawing, Arms) and snapshot.bandit is not None and not plans:
        pulls, budget = snapshot.bandit.pulls, f"{snapshot.bandit.budget:,}"
        text = f"pull {numbers.count(pulls)} of {budget}"
        fields.append(_Field(text, len(f"pull {budget} of {budget}"), palette.text))
    else:
        episode = "sweep" if plans else "episode" if wide else "ep"
        for label, count, columns in (
            (episode, snapshot.episodes, 9),
            ("step", snapshot.step, 11 if wide else 9),
        ):
            text = f"{label} {numbers.count(count, columns)}"
            fields.append(_Field(text, len(label) + 1 + columns, palette.text))
    speed = snapshot.steps_per_second
    if wide:
        text, columns = "" if speed is None else numbers.long_rate(speed), len("999.9 M steps/s")
    else:
        text, columns = "" if speed is None else numbers.rate(speed), len("999 M/s")
    fields.append(_Field(f"{text:>{columns}}", columns, palette.dim))
    return fields


def _state(snapshot: Snapshot, look: Look) -> _Field:
    palette, glyphs = look.palette, look.glyphs
    if snapshot.phase is Phase.SPENT:
        text = f"{glyphs.stopped} budget spent"
        return _Field(text, len(text), palette.accent)
    if snapshot.phase is Phase.DONE:
        text = f"{glyphs.stopped} {snapshot.message.partition(':')[0] or snapshot.phase.value}"
        return _Field(text, cell_len(written(text, glyphs)), palette.accent)
    if snapshot.phase is Phase.PAUSED:
        return _Field(f"{glyphs.paused} paused", _STATE_COLUMNS, palette.dim)
    return _Field(f"{glyphs.running} {speed_text(snapshot.speed)}", _STATE_COLUMNS, palette.good)
