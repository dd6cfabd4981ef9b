"""A row with event marks and a handle."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from types import UnionType
from typing import ClassVar, Final

import numpy as np
from rich.style import Style
from textual import events
from textual.binding import BindingType
from textual.message import Message
from textual.strip import Strip

from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.recipe import OrderSweep, Setting, TakeAction, WorldChange
from rl_tui.runs.results import RunResults
from rl_tui.runs.timeline.branches import Branch, Furthest, Timeline
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Canvas, shortened
from rl_tui.screen.draw.numbers import NEGLIGIBLE
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.kit.pointing import Draggable
from rl_tui.screen.kit.snapshot_facts import episode_shown, hides_greedy
from rl_tui.screen.panels.curve.data import EpisodeAxis, episode_axis
from rl_tui.screen.panels.curve.text import label_gap, plot_columns
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.mdp.space import IntArray

# The row


_POLICIES: Final = 8  # marked changes of the greedy policy: the last ones
_APART: Final = 0.04  # of the track: distance between two of them, and
_CELLS_APART: Final = 3  # at least, so that they do not look like a comb


@dataclass(frozen=True, slots=True)
class Track:
    """The columns that show ``axis``, until step ``end``, with ``labels`` columns after them."""

    start: int
    columns: int
    labels: int
    axis: EpisodeAxis
    end: int

    @property
    def cells(self) -> int:
        """The columns of the branch."""
        return min(self.columns, self.column_of(self.axis.episode_of(self.end)) + 1)

    def column_of(self, episode: float) -> int:
        """Return the column after so many episodes."""
        return min(self.columns - 1, int(episode / self.axis.right * self.columns))

    def cells_of(self, steps: IntArray) -> IntArray:
        """Return each step's cell, the last for the end."""
        last = self.cells - 1
        places = np.interp(steps, self.axis.step, self.axis.episode) / self.axis.right * self.columns
        before_end = np.minimum(places.astype(np.int64), max(0, last - 1))
        return np.where(steps >= self.end, last, before_end)

    def cell_of(self, step: int) -> int:
        """Return the step's cell."""
        return int(self.cells_of(np.array([step]))[0])

    def step_at(self, cell: int) -> int:
        """Return the middle of ``cell``, or the end."""
        last = self.cells - 1
        if cell >= last:
            return self.end
        return round(self.axis.step_of((cell + 0.5) / self.columns * self.axis.right)) if cell > 0 else 0


@dataclass(frozen=True, slots=True)
class TimelineState:
    """The displayed state. The handle is ``at`` a step before the run gets there."""

    snapshot: Snapshot
    at: int
    focused: bool = False

    @property
    def unit(self) -> str:
        """The axis's unit, shortened."""
        is_bandit = self.snapshot.world.is_bandit
        return "sweep" if self.snapshot.agent.row.planner else "pull" if is_bandit else "ep"


def known_end(snapshot: Snapshot) -> Furthest:
    """Return the branch's furthest known state."""
    here = Furthest(snapshot.counters, snapshot.results)
    return (snapshot.timeline.in_past and snapshot.timeline.furthest) or here


def track_of(snapshot: Snapshot, look: Look, width: int) -> Track:
    """Return the track, with the curve's columns."""
    columns = plot_columns(snapshot, look, width)
    axis, end = episode_axis(snapshot), snapshot.timeline.current.end
    return Track(columns.left, columns.columns, columns.labels, axis, end)


def timeline_strip(state: TimelineState, look: Look, width: int) -> Strip:
    """Draw the row."""
    palette, timeline = look.palette, state.snapshot.timeline
    canvas = Canvas(width, 1, palette.text)
    if timeline.current.end == 0:
        unit = "pull" if state.unit == "pull" else "step"
        text = shortened(f" timeline: no {unit} yet ", width, look.glyphs.ellipsis)
        canvas.put(0, 0, text, palette.focus if state.focused else palette.dim)
        return canvas.strips()[0]
    track = track_of(state.snapshot, look, width)
    in_past = state.at < track.end
    calm = palette.press if in_past else palette.dim
    if track.start:
        number = timeline.current.name.split()[-1]
        begins = f"b{number}" if len(timeline.branches) > 1 else f"{state.unit} 0"
        if len(begins) < track.start:  # a mere 0 would seem to belong to the axis above
            canvas.put(track.start - 1 - len(begins), 0, begins, calm)
    gap = label_gap(track.labels)
    label = next((each for each in _labels(state, track) if len(each) <= track.labels - gap), "")
    canvas.put(width - track.labels + gap, 0, label, palette.focus if state.focused else calm)
    _draw_track(canvas, track, state, look)
    return canvas.strips()[0]


def _labels(state: TimelineState, track: Track) -> Iterator[str]:
    now = episode_shown(state.snapshot)
    if state.at != state.snapshot.counters.step:
        now = int(track.axis.episode_of(state.at)) + 1
    if state.at < track.end:
        last = math.ceil(track.axis.episode_of(track.end))
        yield f"{state.unit} {now:,}/{last:,}"
        yield f"{state.unit} {numbers.count(now, 4)}/{numbers.count(last, 4)}"
    yield f"{state.unit} {now:,}"
    yield f"{state.unit} {numbers.count(now, 5)}"


def _draw_track(canvas: Canvas, track: Track, state: TimelineState, look: Look) -> None:
    palette, glyphs = look.palette, look.glyphs
    handle = track.cell_of(state.at)
    in_past = state.at < track.end
    done = palette.press if in_past else palette.slider_rest
    canvas.put(track.start, 0, glyphs.track_done * handle, done)
    canvas.put(track.start + handle, 0, glyphs.track_rest * (track.cells - handle), palette.slider_rest)
    for cell, (mark, style) in _marks(state, track, look).items():
        canvas.put(track.start + cell, 0, mark, style)
    thumb = palette.press if in_past else palette.strong
    canvas.put(track.start + handle, 0, glyphs.thumb, palette.focus if state.focused else thumb)


# Events


def _marks(state: TimelineState, track: Track, look: Look) -> dict[int, tuple[str, Style]]:
    palette, glyphs, snapshot = look.palette, look.glyphs, state.snapshot
    branch, results = snapshot.timeline.current, known_end(snapshot).results
    gold = Style(color=palette.goal.color, bold=True)
    changed = {kind: _cells(branch, kind, track) for kind in _CHANGES}
    first = first_reward(results) if state.unit == "ep" else None
    events = (
        (glyphs.manual_mark, palette.text, changed[TakeAction]),
        (glyphs.policy_mark, palette.dim, [] if hides_greedy(snapshot) else _policies(results, track)),
        (glyphs.goal, gold, [] if first is None else [track.column_of(first)]),
        (glyphs.setting_mark, palette.text, changed[_SETTINGS]),
        (glyphs.fork_mark, palette.strong, [] if branch.parent is None else [track.cell_of(branch.fork)]),
        (glyphs.world_mark, palette.strong, changed[WorldChange]),
    )
    return {cell: (mark, style) for mark, style, cells in events for cell in cells if cell < track.cells}


def event_notes(snapshot: Snapshot, look: Look, width: int) -> tuple[str, ...]:
    """Return the meaning of the marks."""
    if not snapshot.timeline.current.end:
        return ()
    state = TimelineState(snapshot, snapshot.timeline.current.here)
    marks = {mark for mark, _style in _marks(state, track_of(snapshot, look, width), look).values()}
    words = {
        look.glyphs.goal: ("first reward", "reward"),
        look.glyphs.policy_mark: ("new greedy policy", "new policy"),
    }
    forms = [[f"{sign} {words[sign][form]}" for sign in words if sign in marks] for form in (0, 1)]
    return (", ".join(forms[0]), ", ".join(forms[1]), *forms[1]) if forms[0] else ()


_SETTINGS: Final = Setting | OrderSweep
_CHANGES: Final[tuple[type | UnionType, ...]] = (TakeAction, _SETTINGS, WorldChange)


def _cells(branch: Branch, kind: type | UnionType, track: Track) -> set[int]:
    steps = [entry.step for entry in branch.journal if isinstance(entry.change, kind)]
    return set(track.cells_of(np.array(steps)).tolist())  # a person may have taken thousands of steps


def first_reward(results: RunResults) -> float | None:
    """Return the number of episodes before the first reward.

    None if there is no reward above 0, a return is negative, or every early episode has a reward.
    """
    curve = results.curve
    rewarded = np.flatnonzero(curve.return_high > NEGLIGIBLE)
    if not len(rewarded) or curve.return_low.min() < -NEGLIGIBLE:
        return None
    if results.first_reward_episode > 1:
        return float(results.first_reward_episode - 1)
    first = rewarded[0]
    if first == 0:
        return 0.0 if curve.return_low[0] < NEGLIGIBLE else None
    return float(curve.episode[first - 1])


def _policies(results: RunResults, track: Track) -> list[int]:
    marks = results.marks
    if not len(marks.episode):
        return []
    values = marks.expected_return
    same = np.isclose(values[1:], values[:-1], rtol=0.0, atol=NEGLIGIBLE, equal_nan=True)
    apart = max(_CELLS_APART, math.ceil(_APART * track.columns))
    cells = [track.column_of(episode) for episode in marks.episode[1:][~same].tolist()]
    # one per stretch of the track: chosen from the newest, all would move with every new one
    first_in = {cell // apart: cell for cell in reversed(cells)}
    return sorted(first_in.values())[-_POLICIES:]


# The panel


HINTS: Final = (
    "← →: move · < >: one step · pgup pgdn: a tenth",
    "← →: move · pgup pgdn: a tenth",
    "← →: move",
)


class TimelineBar(Draggable, Panel, can_focus=True):
    """The current branch, with a handle."""

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
        """The user wants the moment after ``step``."""

        step: int

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(look, id=id, classes=classes)
        glyphs = look.glyphs
        self.tooltip = glyphs.spelled(
            f"Click or drag to go there. {glyphs.goal} first reward, "
            f"{glyphs.policy_mark} greedy policy changed, {glyphs.world_mark} world edited, "
            f"{glyphs.setting_mark} setting changed, {glyphs.manual_mark} your steps, "
            f"{glyphs.fork_mark} branch begins"
        )
        self.sought: int | None = None

    @property
    def at(self) -> int:
        """The handle's step."""
        return self._at(self._timeline)

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Draw the row, padded with blank ones."""
        rows = [Strip.blank(width, self.look.palette.text)] * height
        if snapshot is None or (snapshot.playback.phase is Phase.PREPARING and not snapshot.counters.step):
            return rows
        state = TimelineState(snapshot, self._at(snapshot.timeline), self.has_focus)
        return [timeline_strip(state, self.look, width), *rows[1:]]

    # Keys

    def action_move(self, distance: str, direction: int) -> None:
        """Move by ``step``, ``cell`` or ``tenth``."""
        track, at = self._track, self.at
        if track is None:
            return
        if distance == "cell":
            to = track.step_at(track.cell_of(at) + direction)
            self._seek(max(at + 1, to) if direction > 0 else min(at - 1, to))
        else:
            self._seek(at + direction * (1 if distance == "step" else max(1, round(track.end / 10))))

    def action_end(self, last: bool) -> None:
        """Go to the first or last step."""
        self._seek(self._timeline.current.end if last else 0)

    # Mouse

    def on_mouse_down(self, event: events.MouseDown) -> None:
        """Take and hold the handle."""
        offset, track = event.get_content_offset(self), self._track
        if event.button != 1 or offset is None or track is None or offset.x < track.start:
            return
        self.take_hold(offset.x)

    def drag_to(self, column: int) -> None:
        """Request the moment at ``column``."""
        if (track := self._track) is not None:
            self._seek(track.step_at(column - track.start))

    @property
    def _timeline(self) -> Timeline:
        return self.snapshot.timeline if self.snapshot is not None else Timeline()

    @property
    def _track(self) -> Track | None:
        return None if self.snapshot is None else track_of(self.snapshot, self.look, self.size.width)

    def _at(self, timeline: Timeline) -> int:
        branch = timeline.current
        return branch.here if self.sought is None else min(self.sought, branch.end)

    def _seek(self, step: int) -> None:
        step = min(max(step, 0), self._timeline.current.end)
        if step != self.at:
            self.sought = step
            self.redraw()
            self.post_message(self.Sought(step))
