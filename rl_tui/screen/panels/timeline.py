"""The timeline: one row for the time of a run, with a handle that goes to any step.

Marks show where the branch begins, where something was changed, and the steps taken by hand.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import UnionType
from typing import ClassVar, Final

from rich.cells import cell_len
from rich.style import Style
from textual import events
from textual.binding import BindingType
from textual.message import Message
from textual.strip import Strip

from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.recipe import OrderSweep, Setting, TakeAction, WorldChange
from rl_tui.runs.timeline.branches import Timeline
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Canvas, shortened
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.draggable import Draggable
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Arms

# The row


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
    last = state.timeline.current.end
    in_past = state.at < last
    if last == 0:
        text = shortened(f" timeline: no {state.unit} yet ", width, glyphs.ellipsis)
        canvas.put(0, 0, text, palette.focus if state.focused else palette.dim)
        return canvas.strips()[0]
    form = timeline_form(state.timeline, width, state.unit)
    calm = palette.press if in_past else palette.dim
    if form.label:
        focus = f" {form.label} ", palette.focus
        canvas.put(0, 0, *(focus if state.focused else (f" {form.label}", calm)))
    if form.digits:
        here = palette.press + Style(bold=True) if in_past else palette.text
        canvas.put(form.track.start - form.digits - 1, 0, numbers.count(state.at, form.digits), here)
        end = numbers.count(last, _END_DIGITS) if in_past else NOW
        canvas.put(form.track.start + form.track.cells + 1, 0, end, palette.dim)
    _draw_track(canvas, form.track, state, look)
    return canvas.strips()[0]


def _draw_track(canvas: Canvas, track: Track, state: TimelineState, look: Look) -> None:
    palette, glyphs = look.palette, look.glyphs
    handle = track.cell_of(state.at)
    done = palette.slider_done if state.at < track.end else palette.slider_rest
    canvas.put(track.start, 0, glyphs.track_done * handle, done)
    rest = glyphs.track_rest * (track.cells - handle)
    canvas.put(track.start + handle, 0, rest, palette.slider_rest)
    for cell, (mark, style) in _marks(state.timeline, track, look).items():
        canvas.put(track.start + cell, 0, mark, style)
    thumb = palette.press if state.at < track.end else palette.slider_thumb
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


# The panel


HINTS: Final = (
    "← →: move · < >: one step · pgup pgdn: a tenth",
    "← →: move · pgup pgdn: a tenth",
    "← →: move",
)
_STEP, _CELL, _TENTH = "step", "cell", "tenth"


class TimelineBar(Draggable, Panel, can_focus=True):
    """Shows the branch in force from step 0 to its end; keys, click and drag ask for another moment.

    The handle goes at once to where it is asked for, and stays there as long as ``sought`` says so.
    """

    ALLOW_SELECT = False
    BINDINGS: ClassVar[list[BindingType]] = [
        binding("left", "move('cell', -1)", "timeline.earlier", "Earlier"),
        binding("right", "move('cell', 1)", "timeline.later", "Later"),
        binding("shift+left,less_than_sign", "move('step', -1)", "timeline.step_back", "One step earlier"),
        binding("shift+right,greater_than_sign", "move('step', 1)", "timeline.step_on", "One step later"),
        binding("pagedown", "move('tenth', -1)", "timeline.much_earlier", "A tenth of the run earlier"),
        binding("pageup", "move('tenth', 1)", "timeline.much_later", "A tenth of the run later"),
        binding("home", "end(False)", "timeline.start", "Go to step 0"),
        binding("end", "end(True)", "timeline.end", "Go to the end"),
    ]

    @dataclass
    class Sought(Message):
        """The user wants to see the moment after ``step`` steps."""

        step: int

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(look, id=id, classes=classes)
        glyphs = look.glyphs
        self.tooltip = to_ascii(
            f"what was run; click or drag to go there. {glyphs.change_mark} a setting was changed, "
            f"{glyphs.world_mark} the world, "
            f"{glyphs.manual_mark} steps by hand, {glyphs.fork_mark} here the branch begins",
            glyphs,
        )
        self.sought: int | None = None

    @property
    def at(self) -> int:
        """The step that the handle stands at."""
        return self._at(self._timeline)

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the row, and blank ones below it."""
        rows = [Strip.blank(width, self.look.palette.text)] * height
        if snapshot is None or (snapshot.playback.phase is Phase.PREPARING and not snapshot.counters.step):
            return rows
        unit = "pull" if isinstance(snapshot.world.drawing, Arms) else "step"
        state = TimelineState(snapshot.timeline, self._at(snapshot.timeline), self.has_focus, unit)
        return [timeline_strip(state, self.look, width), *rows[1:]]

    # Keys

    def action_move(self, distance: str, direction: int) -> None:
        """Move the handle by one ``step``, by a ``cell`` of the track, or by a ``tenth`` of the run."""
        track = self._form.track
        by = {_STEP: 1, _CELL: track.steps_a_cell, _TENTH: max(1, round(track.end / 10))}[distance]
        self._seek(self.at + direction * by)

    def action_end(self, last: bool) -> None:
        """Go to the first or the last step."""
        self._seek(self._form.track.end if last else 0)

    def watch_has_focus(self, has_focus: bool) -> None:
        """Show the focus, or that it is gone."""
        super().watch_has_focus(has_focus)
        self.redraw()

    # Mouse

    def on_mouse_down(self, event: events.MouseDown) -> None:
        """Take hold of the handle, which jumps to the pointer."""
        offset = event.get_content_offset(self)
        if event.button != 1 or offset is None or offset.x < self._form.track.start:
            return
        self.take_hold(offset.x)

    def drag_to(self, column: int) -> None:
        """Ask for the moment that belongs to ``column``."""
        track: Track = self._form.track
        self._seek(track.step_at(column - track.start))

    @property
    def _timeline(self) -> Timeline:
        return self.snapshot.timeline if self.snapshot is not None else Timeline()

    @property
    def _form(self) -> TimelineForm:
        return timeline_form(self._timeline, self.size.width)

    def _at(self, timeline: Timeline) -> int:
        branch = timeline.current
        return branch.here if self.sought is None else min(self.sought, branch.end)

    def _seek(self, step: int) -> None:
        step = min(max(step, 0), self._timeline.current.end)
        if step != self.at:
            self.sought = step
            self.redraw()
            self.post_message(self.Sought(step))
