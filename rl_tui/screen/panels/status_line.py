"""The status line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from rich.cells import cell_len
from rich.style import Style
from textual.strip import Strip

from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Line, Piece, length, shortened, strips_of
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.kit.snapshot_facts import BEING_BUILT, episode_shown
from rl_tui.screen.panels.controls.settings import speed_text
from rl_tui.screen.panels.program.words import name_of
from rl_tui.screen.theme.look import Look

WIDE: Final = 98  # columns between the margins of a broad screen
SMALL: Final = 70
PROGRAM_ENDED: Final = "your program has ended"
_WORTH_SHOWING: Final = 3.0  # seconds without an answer
_GAP: Final = 2
_MARGIN: Final = 1
_LEAST_TITLE: Final = 12
COMPILING: Final = "compiling"  # shown instead of the speed while machine code is compiled
IN_PYTHON: Final = "in Python"  # no machine code
_CHIP: Final = 13  # columns of the phase
_SPEED_COLUMNS: Final = (8, 15)  # short and long form
_BETWEEN: Final = " · "
_KEEPS_UP: Final = 0.8  # share of the wanted speed above which the measured one is not shown
_SPEED_RANK: Final = 3  # above all others
_SHARE: Final = 0.8  # of a line that also has the scale, including a title


@dataclass(frozen=True, slots=True)
class _Field:
    """A part of fixed width. High ``rank`` is dropped first."""

    text: str
    columns: int
    style: Style
    rank: int = 0
    label: str = ""
    after: int = 0


class WaitingRow(Panel):
    """A panel with a row for :func:`waiting_line`."""

    unanswered = 0
    """Seconds without an answer of the environment, or 0."""

    def show_unanswered(self, seconds: float) -> None:
        """Show the seconds, if many."""
        shown = int(seconds) if seconds >= _WORTH_SHOWING else 0
        if shown != self.unanswered:
            self.unanswered = shown
            self.redraw()


class StatusLine(WaitingRow):
    """Phase, speed, episode and steps, or a message. ``is_captioned``: a caption says why it waits."""

    is_manual = is_captioned = False
    title = ""
    """The title of the scenario, until the first snapshot provides it."""
    _session = ""

    def name_session(self, name: str) -> None:
        """Show the session's name."""
        if name != self._session:
            self._session = name
            self.redraw()

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Draw the line, padded with blank rows."""
        return strips_of([self._line(snapshot, width)], width, height, self.look)

    def _line(self, snapshot: Snapshot | None, width: int) -> Line:
        look = self.look
        waits = waiting_line(snapshot, look, width, unanswered=self.unanswered, scenario=self.title)
        if waits is not None or snapshot is None:
            return waits or []
        fields = _fields(snapshot, look, width, is_manual=self.is_manual, is_captioned=self.is_captioned)
        beside = width - 2 * _MARGIN - sum(field.columns + _GAP for field in fields)
        title = cell_len(look.glyphs.separated(_names(snapshot, self._session)[0]))
        if beside < title <= beside + fields[0].columns + _GAP:
            fields = fields[1:]  # a whole title instead of the speed
        right = [piece for field in _fitting(fields, width - 2 * _MARGIN) for piece in _pieces(field, look)]
        room = max(0, width - 2 * _MARGIN - length(right))
        name = _title(snapshot, look, room, self._session)
        if room < _LEAST_TITLE and name[0].text.endswith(look.glyphs.ellipsis):
            name = []
        blanks = Piece(" " * (room - length(name)), look.palette.text)
        return [Piece(" " * _MARGIN, look.palette.text), *name, blanks, *right]


def how_far(snapshot: Snapshot, look: Look, width: int, *, is_manual: bool) -> tuple[Piece, ...]:
    """Return phase and progress, unless :func:`waiting_line` has a text."""
    if waiting_line(snapshot, look, width) is not None:
        return ()
    fields = _fields(snapshot, look, width, is_manual=is_manual, is_captioned=True)[1:]
    fields = _fitting(fields, round(_SHARE * width))
    return tuple(piece for field in fields for piece in _pieces(field, look))


def waiting_line(
    snapshot: Snapshot | None, look: Look, width: int, *, unanswered: int = 0, scenario: str = ""
) -> Line | None:
    """Return why a run has stopped or waits.

    ``unanswered``: seconds without an answer of the environment. ``scenario``: title without a snapshot.
    """
    palette, glyphs = look.palette, look.glyphs
    if unanswered:
        program = None if snapshot is None else snapshot.program
        who = "the environment" if program is None else "your program"
        if program is not None and program.stands_at is not None:
            who += f", in {program.stands_at},"
        text = f"{who} has not answered for {unanswered:,} s; esc leaves it"
        if snapshot is None:
            return [Piece(shortened(f" {text}", width, glyphs.ellipsis), palette.strong)]
        return _waiting(snapshot, text, look, width)
    if snapshot is None:
        room = width - len(f"   {BEING_BUILT}")
        title = shortened(glyphs.separated(scenario), max(0, room), glyphs.ellipsis)
        return [Piece(f" {title} " if title else "", palette.strong), Piece(f" {BEING_BUILT}", palette.dim)]
    if snapshot.playback.phase is Phase.STOPPED:
        said = snapshot.playback.message
        # the error of a program matters more than the fact that it stopped, which has a sign
        forms = (f"stopped: {said}",) if snapshot.program is None else (said, said.partition(": ")[2] or said)
        texts = [glyphs.spelled(f" {glyphs.stopped} {each}") for each in forms]
        fitting = next((each for each in texts if cell_len(each) <= width), texts[-1])
        return [Piece(shortened(fitting, width, glyphs.ellipsis), palette.bad)]
    if snapshot.playback.phase is Phase.PREPARING:
        whole = f"preparing: {snapshot.playback.message}"
        fits = cell_len(glyphs.spelled(whole)) < width
        return _waiting(snapshot, whole if fits else snapshot.playback.message, look, width)
    waits = snapshot.editor.rebuilding or snapshot.playback.phase is Phase.SEEKING
    if waits and snapshot.playback.message:
        return _waiting(snapshot, snapshot.playback.message, look, width)
    return None


def _pieces(field: _Field, look: Look) -> list[Piece]:
    label, text = (look.glyphs.spelled(each) for each in (field.label, field.text))
    blanks = " " * (field.columns - cell_len(label) - cell_len(text) - field.after)
    gap = Piece(" " * _GAP + ("" if label else blanks), look.palette.text)
    shown = [Piece(text, field.style), Piece(" " * field.after, look.palette.text)]
    return [gap, Piece(label + blanks, look.palette.dim), *shown] if label else [gap, *shown]


def _fitting(fields: list[_Field], width: int) -> list[_Field]:
    def room_beside(kept: list[_Field]) -> int:
        return width - sum(field.columns + _GAP for field in kept)

    kept, is_long = fields, any(not field.rank and field.columns > _CHIP for field in fields)
    while len(kept) > 1 and room_beside(kept) < _LEAST_TITLE:
        last = max(kept, key=lambda field: field.rank)
        if last.rank < _SPEED_RANK and is_long and room_beside(kept) >= 0:
            break
        kept = [field for field in kept if field is not last]
    return kept


def _title(snapshot: Snapshot, look: Look, width: int, session: str = "") -> list[Piece]:
    palette, glyphs = look.palette, look.glyphs
    first, *others = _names(snapshot, session)
    branch = snapshot.timeline.current.name if len(snapshot.timeline.branches) > 1 else ""
    name = glyphs.separated(first)
    forms = [filter(None, (*others[:count], branch)) for count in range(len(others), -1, -1)]
    for each in (glyphs.separated(_BETWEEN.join(form)) for form in (*forms, ())):
        details = f"  {each}" if each else ""
        if cell_len(name + details) <= width:
            return [Piece(name, palette.strong), Piece(details, palette.dim)]
    return [Piece(shortened(name, max(0, width), glyphs.ellipsis), palette.strong)]


def _names(snapshot: Snapshot, session: str) -> tuple[str, ...]:
    title, policy = snapshot.recipe.scenario.title, snapshot.agent.hyperparameters.policy
    if snapshot.program is not None:
        return name_of(snapshot.program), title, f"seed {snapshot.recipe.seed}"
    if snapshot.lesson is not None:
        session = snapshot.lesson.record.lesson.title
    row = snapshot.agent.row
    agent = (row.name, POLICY_BY_ID[policy].name) if "policy" in row.parameters else (row.name,)
    return (session, title, *agent) if session else (title, *agent)


def _waiting(snapshot: Snapshot, text: str, look: Look, width: int) -> Line:
    palette, glyphs = look.palette, look.glyphs
    message = glyphs.spelled(text)
    room = width - 1 - _GAP - cell_len(message)
    title = _title(snapshot, look, room)
    if not title[0].text or (room < _LEAST_TITLE and title[0].text.endswith(glyphs.ellipsis)):
        return [Piece(shortened(f" {message}", width, glyphs.ellipsis), palette.strong)]
    return [Piece(" ", palette.text), *title, Piece(" " * _GAP + message, palette.strong)]


def _fields(
    snapshot: Snapshot, look: Look, width: int, *, is_manual: bool, is_captioned: bool
) -> list[_Field]:
    wide, bandit = width >= WIDE, snapshot.results.bandit
    in_past = snapshot.timeline.in_past and snapshot.playback.phase is not Phase.RUNNING
    plans = snapshot.agent.row.planner
    if snapshot.world.is_bandit and bandit is not None and not plans:
        of = f" of {bandit.budget:,}"
        text, room = f"{numbers.count(bandit.pulls)}{of}", len(f"pull {bandit.budget:,}{of}")
        progress = [_Field(text, room, look.palette.strong, label="pull ")]
    else:
        label = "sweep" if plans else "episode" if wide else "ep"
        progress = [
            _counted(label, episode_shown(snapshot), 7, look, rank=2),
            _counted("step", snapshot.counters.step, 10 if wide else 9 if width > SMALL else 7, look, rank=1),
        ]
    columns = _SPEED_COLUMNS[wide]
    end = f"end {numbers.count(snapshot.timeline.current.end, columns - len('end '))}"
    text = end if in_past else _speed(snapshot, wide=wide)
    speed = _Field(text, columns, look.palette.dim, _SPEED_RANK)
    doing = _doing(snapshot, look, is_manual=is_manual, is_captioned=is_captioned)
    return [speed, _state(look, width - 1 - _GAP, doing), *progress]


def _counted(label: str, count: int, columns: int, look: Look, *, rank: int) -> _Field:
    text, label = numbers.count(count, columns), f"{label} "
    return _Field(text, len(label) + columns, look.palette.strong, rank, label)


def _speed(snapshot: Snapshot, *, wide: bool) -> str:
    speed, wanted = snapshot.playback.steps_per_second, snapshot.playback.speed
    if speed is None:
        return ""
    if wide:
        return numbers.long_rate(speed)
    keeps_up = wanted is not None and speed >= _KEEPS_UP * wanted
    # then the phase beside it is enough, if it names the wanted speed
    is_said = keeps_up and not snapshot.playback.until and not snapshot.timeline.in_past
    return "" if is_said else numbers.rate(speed)


def _state(look: Look, most: int, doing: tuple[str, str, bool]) -> _Field:
    sign, text, is_mode = doing
    style = (look.palette.you if is_mode else look.palette.strong) + Style(reverse=True)
    shown = shortened(look.glyphs.spelled(f"{sign} {text}"), max(_CHIP, most) - 2, look.glyphs.ellipsis)
    columns = cell_len(shown) + 2
    return _Field(f" {shown} ", max(_CHIP, columns), style, after=max(0, _CHIP - columns))


def _doing(snapshot: Snapshot, look: Look, *, is_manual: bool, is_captioned: bool) -> tuple[str, str, bool]:
    glyphs, playback, in_past = look.glyphs, snapshot.playback, snapshot.timeline.in_past
    is_program = snapshot.program is not None
    if playback.phase is Phase.SPENT:
        return glyphs.stopped, PROGRAM_ENDED if is_program else "budget spent", False
    if playback.phase is Phase.DONE:
        return glyphs.stopped, playback.message.partition(":")[0] or playback.phase.value, False
    if playback.phase in (Phase.PAUSED, Phase.SEEKING):
        if playback.paused_by:
            return glyphs.paused, playback.paused_by, False
        if in_past:
            return glyphs.past, "past, only shown" if is_program else "the past", False
        return (glyphs.agent, "you act", True) if is_manual else (glyphs.paused, "paused", False)
    if playback.until:
        return glyphs.running, f"until {playback.until}", False
    if in_past:
        return glyphs.running, "replaying", False
    if playback.watching:
        return glyphs.running, "watching" if is_captioned else f"watching: {playback.watching}", False
    if playback.interpreted and playback.speed is None:
        return glyphs.running, IN_PYTHON if playback.stays_interpreted else COMPILING, False
    return glyphs.running, speed_text(playback.speed), False
