"""How the timeline is drawn, in one row of any width: what was run, what is shown of it, what was changed."""

from __future__ import annotations

from dataclasses import dataclass
from types import UnionType
from typing import Final

from rich.cells import cell_len
from rich.style import Style
from textual.strip import Strip

from rl_tui.lab.run.recipe import OrderSweep, Setting, TakeAction, WorldChange
from rl_tui.lab.timeline.branches import Timeline
from rl_tui.tui.draw import numbers
from rl_tui.tui.draw.canvas import Canvas, shortened
from rl_tui.tui.theme.look import Look

NOW: Final = "now"


@dataclass(frozen=True, slots=True)
class TimelineState:
    """What a timeline shows: the handle is ``at`` a step, be it that the run is still on its way there.

    ``unit`` is what a step is called, in four letters.
    """

    timeline: Timeline
    at: int
    focused: bool = False
    unit: str = "step"

    @property
    def end(self) -> int:
        """The furthest step of the branch in force."""
        return self.timeline.current.end

    @property
    def in_past(self) -> bool:
        """Whether the handle stands before the end."""
        return self.at < self.end


@dataclass(frozen=True, slots=True)
class Track:
    """The cells from column ``start`` on that stand for the steps 0 to ``end``."""

    start: int
    cells: int
    end: int

    def cell_of(self, step: int) -> int:
        """Return the cell, from 0, of ``step``; nothing before the end stands in the last one."""
        last = self.cells - 1
        if step >= self.end or last < 1:
            return max(0, last)
        return min(round(step / self.end * last), last - 1)

    def step_at(self, cell: int) -> int:
        """Return the step in the middle of ``cell``; cells beyond the ends count as the ends."""
        last = self.cells - 1
        return round(min(max(cell, 0), last) / last * self.end) if last > 0 else self.end

    @property
    def steps_a_cell(self) -> int:
        """How many steps a cell stands for, at least 1."""
        return max(1, round(self.end / max(1, self.cells - 1)))


@dataclass(frozen=True, slots=True)
class TimelineForm:
    """A row: ``label`` (empty: no room), the step in ``digits`` columns, the track, the end in 7 columns.

    All columns are fixed, so that nothing moves while the numbers grow. Without ``digits`` there are none.
    """

    label: str
    digits: int
    track: Track


# The ways to write a row, the longest first: whether it says the unit beside the name of the branch, the
# columns of the step, and the fewest cells of track that this leaves
_FORMS: Final = ((True, 11, 20), (False, 7, 8), (False, 0, 6))
_END_DIGITS: Final = 7


def timeline_form(timeline: Timeline, width: int, unit: str = "step") -> TimelineForm:
    """Return what stands where in ``width`` cells."""
    end = timeline.current.end
    for says_unit, digits, least in _FORMS:
        label = _label(timeline, unit, says_unit=says_unit)
        before, after = (digits + 1, 1 + _END_DIGITS) if digits else (0, 0)
        start = 1 + cell_len(label) + 1 + before
        cells = width - start - after - 1
        if cells >= least:
            return TimelineForm(label, digits, Track(start, cells, end))
    return TimelineForm("", 0, Track(0, max(0, width), end))


def timeline_strip(state: TimelineState, look: Look, width: int) -> Strip:
    """Return the row."""
    palette, glyphs = look.palette, look.glyphs
    canvas = Canvas(width, 1, palette.text)
    if state.end == 0:
        text = shortened(f" timeline: no {state.unit} yet ", width, glyphs.ellipsis)
        canvas.put(0, 0, text, palette.focus if state.focused else palette.dim)
        return canvas.strips()[0]
    form = timeline_form(state.timeline, width, state.unit)
    calm = palette.accent if state.in_past else palette.dim
    if form.label:
        focus = f" {form.label} ", palette.focus
        canvas.put(0, 0, *(focus if state.focused else (f" {form.label}", calm)))
    if form.digits:
        here = palette.accent + Style(bold=True) if state.in_past else palette.text
        canvas.put(form.track.start - form.digits - 1, 0, numbers.count(state.at, form.digits), here)
        end = numbers.count(state.end, _END_DIGITS) if state.in_past else NOW
        canvas.put(form.track.start + form.track.cells + 1, 0, end, palette.dim)
    _draw_track(canvas, form.track, state, look)
    return canvas.strips()[0]


def _draw_track(canvas: Canvas, track: Track, state: TimelineState, look: Look) -> None:
    palette, glyphs = look.palette, look.glyphs
    handle = track.cell_of(state.at)
    done = palette.slider_done if state.in_past else palette.slider_rest
    canvas.put(track.start, 0, glyphs.track_done * handle, done)
    rest = glyphs.track_rest * (track.cells - handle)
    canvas.put(track.start + handle, 0, rest, palette.slider_rest)
    for cell, (mark, style) in _marks(state.timeline, track, look).items():
        canvas.put(track.start + cell, 0, mark, style)
    thumb = palette.accent if state.in_past else palette.slider_thumb
    canvas.put(track.start + handle, 0, glyphs.thumb, palette.focus if state.focused else thumb)


def _marks(timeline: Timeline, track: Track, look: Look) -> dict[int, tuple[str, Style]]:
    """Return what stands in which cell: where the branch begins, a change, or steps by hand."""
    palette, glyphs = look.palette, look.glyphs
    branch = timeline.current
    marks: dict[int, tuple[str, Style]] = {}
    # what is told of a cell is the last of these that happened in it
    kinds: tuple[tuple[type | UnionType, str], ...] = (
        (TakeAction, glyphs.manual_mark),
        (Setting | OrderSweep, glyphs.change_mark),
        (WorldChange, glyphs.world_mark),
    )
    for kind, mark in kinds:
        for entry in branch.journal:
            if isinstance(entry.change, kind):
                marks[track.cell_of(entry.step)] = mark, palette.text
    if branch.parent is not None:
        marks[track.cell_of(branch.fork)] = glyphs.fork_mark, palette.strong
    return marks


def _label(timeline: Timeline, unit: str, *, says_unit: bool) -> str:
    if len(timeline.branches) == 1:
        return unit
    label = timeline.current.name.ljust(max(cell_len(each.name) for each in timeline.branches))
    return f"{label}  {unit}" if says_unit else label
