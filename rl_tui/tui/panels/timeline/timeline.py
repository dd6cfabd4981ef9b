"""The time of a run in one row: what was run, where the moment shown stands, and a handle to go elsewhere."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Final

from textual import events
from textual.binding import BindingType
from textual.message import Message
from textual.strip import Strip

from rl_tui.lab.live.snapshot import Phase, Snapshot
from rl_tui.lab.timeline.branches import Timeline
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.panels.bindings import binding
from rl_tui.tui.panels.draggable import Draggable
from rl_tui.tui.panels.panel import Panel
from rl_tui.tui.panels.timeline.picture import (
    TimelineForm,
    TimelineState,
    Track,
    timeline_form,
    timeline_strip,
)
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.drawing import Arms

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
