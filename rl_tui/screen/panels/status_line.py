"""One row: what runs, whether it runs, how fast, and how far it has come."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from rich.cells import cell_len, set_cell_size
from rich.style import Style
from textual.strip import Strip

from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.bandit import BanditFigures
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Line, Piece, shortened, strips_of
from rl_tui.screen.draw.to_ascii import separated, to_ascii
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.kit.snapshot_facts import episode_shown
from rl_tui.screen.panels.controls.settings import speed_text
from rl_tui.screen.panels.program.words import name_of
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Arms

WIDE: Final = 100
WAITING: Final = "the world is being built"
BUDGET_SPENT: Final = "budget spent"
PROGRAM_ENDED: Final = "your program has ended"
_WORTH_SHOWING: Final = 3.0  # seconds without an answer
_GAP: Final = 2
_LEAST_END: Final = 4  # columns of ``100M``
_LEAST_TITLE: Final = 12
COMPILING: Final = "compiling"
"""In place of the speed: machine code is on its way."""
IN_PYTHON: Final = "in Python"
"""The same: there will be none."""
_STATE_COLUMNS: Final = 11
_KEEPS_UP: Final = 0.8  # from this share of the wanted speed on, the measured one is not shown beside it
_SPEED_RANK: Final = 3  # above all others


@dataclass(frozen=True, slots=True)
class _Field:
    """A part of fixed width, so that nothing beside it moves while its number grows.

    Where there is no room for all, those of the highest ``rank`` are left out first.
    """

    text: str
    columns: int
    style: Style
    rank: int = 0


class StatusLine(Panel):
    """Draws phase, speed, episode under way and steps of the newest snapshot; a message takes the whole row.

    ``is_manual`` says that a person takes the steps.
    """

    is_manual = False
    _title = ""
    _session = ""
    _unanswered = 0

    def show_unanswered(self, seconds: float) -> None:
        """Say for how many seconds the environment has not answered, if that is long."""
        shown = int(seconds) if seconds >= _WORTH_SHOWING else 0
        if shown != self._unanswered:
            self._unanswered = shown
            self.redraw()

    def begin_with(self, title: str) -> None:
        """Name the scenario by its ``title`` until the first snapshot does."""
        self._title = title

    def name_session(self, name: str) -> None:
        """Say what a person called the session; ``name`` is empty without one."""
        if name != self._session:
            self._session = name
            self.redraw()

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the row, and blank ones below it."""
        line = status_line(
            snapshot,
            self.look,
            width,
            is_manual=self.is_manual,
            unanswered=self._unanswered,
            session=self._session,
            scenario=self._title,
        )
        return strips_of([line], width, height, self.look)


def status_line(
    snapshot: Snapshot | None,
    look: Look,
    width: int,
    *,
    is_manual: bool = False,
    unanswered: int = 0,
    session: str = "",
    scenario: str = "",
) -> Line:
    """Return the row for ``width`` cells; ``is_manual`` says that a person takes the steps.

    ``unanswered`` is for how many seconds the environment has not answered, 0 where it does. ``session`` is
    the name of the session, empty without one: it stands there where there is room. ``scenario`` is the title
    to show while there is no snapshot.
    """
    palette, glyphs = look.palette, look.glyphs
    if unanswered:
        program = None if snapshot is None else snapshot.program
        who = "the environment" if program is None else "your program"
        if program is not None and program.stands_at is not None:
            who += f", in line {program.stands_at},"
        text = f"{who} has not answered for {unanswered:,} s; esc leaves it"
        if snapshot is None:
            return [Piece(shortened(f" {text}", width, glyphs.ellipsis), palette.strong)]
        return _waiting(snapshot, text, look, width)
    if snapshot is None:
        room = width - len(f"   {WAITING}")
        title = shortened(separated(scenario, glyphs), max(0, room), glyphs.ellipsis)
        return [Piece(f" {title} " if title else "", palette.strong), Piece(f" {WAITING}", palette.dim)]
    if snapshot.playback.phase is Phase.STOPPED:
        said = snapshot.playback.message
        # of a program what it raised is worth more than that it stopped, which the sign says
        forms = (f"stopped: {said}",) if snapshot.program is None else (said, said.partition(": ")[2] or said)
        texts = [to_ascii(f" {glyphs.stopped} {each}", glyphs) for each in forms]
        fitting = next((each for each in texts if cell_len(each) <= width), texts[-1])
        return [Piece(shortened(fitting, width, glyphs.ellipsis), palette.bad)]
    if snapshot.playback.phase is Phase.PREPARING:
        whole = f"preparing: {snapshot.playback.message}"
        fits = cell_len(to_ascii(whole, glyphs)) < width
        return _waiting(snapshot, whole if fits else snapshot.playback.message, look, width)
    waits = snapshot.editor.rebuilding or snapshot.playback.phase is Phase.SEEKING
    if waits and snapshot.playback.message:
        return _waiting(snapshot, snapshot.playback.message, look, width)
    fields = _fitting(_fields(snapshot, look, width, is_manual=is_manual), width - 1)
    right = [
        Piece(" " * _GAP + set_cell_size(to_ascii(field.text, glyphs), field.columns), field.style)
        for field in fields
    ]
    taken = sum(cell_len(piece.text) for piece in right)
    room = max(0, width - 1 - taken)
    title = _title(snapshot, look, room, session)
    if room < _LEAST_TITLE and cell_len(title) > room - 1:
        title = ""
    return [Piece(f" {set_cell_size(title, room)}", palette.strong), *right]


def _fitting(fields: list[_Field], width: int) -> list[_Field]:
    """Return those of ``fields`` that fit beside a title.

    A long state, which tells what the run waits for or why it paused, is worth more than the title, though
    not the speed.
    """

    def room_beside(kept: list[_Field]) -> int:
        return width - sum(field.columns + _GAP for field in kept)

    kept = fields
    while len(kept) > 1 and room_beside(kept) < _LEAST_TITLE:
        last = max(kept, key=lambda field: field.rank)
        if last.rank < _SPEED_RANK and fields[0].columns > _STATE_COLUMNS and room_beside(kept) >= 0:
            break
        kept = [field for field in kept if field is not last]
    return kept


def _title(snapshot: Snapshot, look: Look, width: int, session: str = "") -> str:
    forms = _titles(snapshot, session)
    texts = (separated(" · ".join(filter(None, form)), look.glyphs) for form in forms)
    fitting = next((text for text in texts if cell_len(text) <= width), None)
    title = snapshot.recipe.scenario.title
    name = title if snapshot.program is None else name_of(snapshot.program)
    parts = (session, name) if snapshot.lesson is None else forms[-1]
    longest = separated(" · ".join(filter(None, parts)), look.glyphs)
    return fitting or shortened(longest, max(0, width), look.glyphs.ellipsis)


def _titles(snapshot: Snapshot, session: str) -> list[tuple[str, ...]]:
    """Return the parts of each title that there may be, the longest first: of a program its name first."""
    recipe, timeline = snapshot.recipe, snapshot.timeline
    title, seed = recipe.scenario.title, f"seed {recipe.seed}"
    if snapshot.program is not None:
        name = name_of(snapshot.program)
        return [(name, title, seed), (name, title), (name,)]
    branch = timeline.current.name if len(timeline.branches) > 1 else ""
    if snapshot.lesson is not None:
        lesson = snapshot.lesson.record.lesson.title
        return [(lesson, title, snapshot.agent.row.name, branch), (lesson, title), (lesson,)]
    if session:
        shorter = [(session, title, branch), *([(session, branch)] if branch else [])]
    else:
        shorter = [(title, seed, branch), (title, branch)] if branch else []
    return [(session, title, snapshot.agent.row.name, seed, branch), *shorter]


def _waiting(snapshot: Snapshot, text: str, look: Look, width: int) -> Line:
    palette, glyphs = look.palette, look.glyphs
    message = to_ascii(f"  {text}", glyphs)
    title = _title(snapshot, look, max(0, width - 1 - cell_len(message)))
    if cell_len(title) < _LEAST_TITLE and title.endswith(glyphs.ellipsis):
        title = ""
    message = shortened(
        message if title else message[1:], width - cell_len(title) - bool(title), glyphs.ellipsis
    )
    return [*([Piece(f" {title}", palette.strong)] if title else []), Piece(message, palette.strong)]


def _fields(snapshot: Snapshot, look: Look, width: int, *, is_manual: bool) -> list[_Field]:
    """Return state, progress and measured speed, whatever learns and wherever in its time.

    In the past the step has the place of the speed too, to say how far the branch has come.
    """
    wide, bandit = width >= WIDE, snapshot.results.bandit
    in_past = snapshot.timeline.in_past and snapshot.playback.phase is not Phase.RUNNING
    plans = snapshot.agent.row.planner
    speed, has_speed = _speed(snapshot, look, wide=wide), True
    if isinstance(snapshot.world.drawing, Arms) and bandit is not None and not plans:
        progress = [_pull(bandit, look.palette.strong if in_past else look.palette.text)]
    else:
        label = "sweep" if plans else "episode" if wide else "ep"
        step = _counted("step", snapshot.counters.step, 11 if wide else 9, look, rank=1)
        if in_past:
            has_speed, step = False, _step_in_past(snapshot, step.columns + _GAP + speed.columns, look)
        progress = [_counted(label, episode_shown(snapshot), 9, look, rank=2), step]
    state = _state(snapshot, look, width - 1 - _GAP, is_manual=is_manual)
    return [state, *progress, *([speed] if has_speed else [])]


def _pull(bandit: BanditFigures, style: Style) -> _Field:
    budget = f"{bandit.budget:,}"
    text = f"pull {numbers.count(bandit.pulls)} of {budget}"
    return _Field(text, len(f"pull {budget} of {budget}"), style)


def _counted(label: str, count: int, columns: int, look: Look, *, rank: int) -> _Field:
    text = f"{label} {numbers.count(count, columns)}"
    return _Field(text, len(label) + 1 + columns, look.palette.text, rank)


def _step_in_past(snapshot: Snapshot, columns: int, look: Look) -> _Field:
    """Return the step and how far the branch has come; ``columns`` are those of step and speed otherwise."""
    room = columns - len("step  of ")
    here = numbers.count(snapshot.counters.step, room - _LEAST_END)
    end = numbers.count(snapshot.timeline.current.end, room - len(here))
    return _Field(f"step {here} of {end}", columns, look.palette.strong, rank=1)


def _speed(snapshot: Snapshot, look: Look, *, wide: bool) -> _Field:
    """Return the measured speed; without room for its unit only where the wanted one does not tell it."""
    speed = snapshot.playback.steps_per_second
    if wide:
        text, columns = "" if speed is None else numbers.long_rate(speed), len("999.9 M steps/s")
    else:
        is_redundant = speed is None or _keeps_up(snapshot, speed)
        text, columns = "" if speed is None or is_redundant else numbers.rate(speed), len("999 M/s")
    return _Field(f"{text:>{columns}}", columns, look.palette.dim, _SPEED_RANK)


def _keeps_up(snapshot: Snapshot, speed: float) -> bool:
    """Return whether the state names a wanted speed that the measured ``speed`` comes up to."""
    if snapshot.playback.speed is None or snapshot.playback.until or snapshot.timeline.in_past:
        return False
    return speed >= _KEEPS_UP * snapshot.playback.speed


def _state(snapshot: Snapshot, look: Look, most: int, *, is_manual: bool) -> _Field:
    """Return what the run does now, in at most ``most`` columns where that is a sentence."""
    palette, glyphs = look.palette, look.glyphs
    if snapshot.playback.phase is Phase.SPENT:
        text = f"{glyphs.stopped} {BUDGET_SPENT if snapshot.program is None else PROGRAM_ENDED}"
        return _Field(text, len(text), palette.strong)
    if snapshot.playback.phase is Phase.DONE:
        text = (
            f"{glyphs.stopped} {snapshot.playback.message.partition(':')[0] or snapshot.playback.phase.value}"
        )
        return _Field(text, cell_len(to_ascii(text, glyphs)), palette.strong)
    if snapshot.playback.phase in (Phase.PAUSED, Phase.SEEKING):
        if snapshot.playback.paused_by:
            return _long_state(f"{glyphs.paused} {snapshot.playback.paused_by}", look, most)
        if snapshot.timeline.in_past:
            past = "the past" if snapshot.program is None else "past, only shown"
            text = f"{glyphs.past} {past}"
            return _Field(text, max(_STATE_COLUMNS, cell_len(to_ascii(text, glyphs))), palette.strong)
        if is_manual:
            return _Field(f"{glyphs.agent} you act", _STATE_COLUMNS, palette.you)
        return _Field(f"{glyphs.paused} paused", _STATE_COLUMNS, palette.dim)
    if snapshot.playback.until:
        return _long_state(f"{glyphs.running} until {snapshot.playback.until}", look, most)
    if snapshot.timeline.in_past:
        return _Field(f"{glyphs.running} replaying", _STATE_COLUMNS, palette.strong)
    if snapshot.playback.watching:
        return _long_state(f"{glyphs.running} watching: {snapshot.playback.watching}", look, most)
    if snapshot.playback.interpreted and snapshot.playback.speed is None:
        text = IN_PYTHON if snapshot.playback.stays_interpreted else COMPILING
        return _Field(f"{glyphs.running} {text}", _STATE_COLUMNS, palette.strong)
    return _Field(f"{glyphs.running} {speed_text(snapshot.playback.speed)}", _STATE_COLUMNS, palette.good)


def _long_state(text: str, look: Look, most: int) -> _Field:
    text = shortened(to_ascii(text, look.glyphs), max(_STATE_COLUMNS, most), look.glyphs.ellipsis)
    return _Field(text, max(_STATE_COLUMNS, cell_len(text)), look.palette.strong)
