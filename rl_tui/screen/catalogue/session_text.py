"""Recent sessions and the base of their screens."""

from __future__ import annotations

import asyncio
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Final

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.text import Text
from textual.message import Message
from textual.widgets.option_list import Option

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters
from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line
from rl_tui.common.words import counted
from rl_tui.live.sessions.session import SessionError, StoredSession, files_in, remove, sessions_in
from rl_tui.runs.timeline.run_names import feature_text, features_of
from rl_tui.screen.catalogue.facts import FullWidth, labelled
from rl_tui.screen.catalogue.scenario_list import ListScreen
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.frame.message_line import complaining
from rl_tui.screen.kit.bindings import RowList
from rl_tui.screen.theme.look import Look

if TYPE_CHECKING:
    from rl_tui.live.record import Record

# Differences between similar sessions


_SCENARIO = "scenario"
_LANES = "lanes"
_Features = Mapping[str, float | str]


def differences(sessions: Sequence[StoredSession]) -> list[list[str]]:
    """Return how each session differs from most of its title."""
    by_title = defaultdict[str, list[_Features]](list)
    every = [_features(session) for session in sessions]
    for session, features in zip(sessions, every, strict=True):
        by_title[session.title].insert(0, features)
    usual = {title: _usual(alike) for title, alike in by_title.items()}
    return [
        [_text(name, value) for name, value in features.items() if usual[session.title][name] != value]
        for session, features in zip(sessions, every, strict=True)
    ]


def settings_of(session: StoredSession) -> list[str]:
    """Return the sliders' values."""
    features = _features(session)
    sliders = [name for name in features if name in PARAMETERS and PARAMETERS[name].slide is not None]
    return [feature_text(name, features[name]) for name in sliders]


def _usual(sessions: Sequence[_Features]) -> _Features:
    names = dict.fromkeys(name for features in sessions for name in features)
    values = {name: [features[name] for features in sessions if name in features] for name in names}
    return {name: max(there, key=there.count) for name, there in values.items()}


def _features(session: StoredSession) -> _Features:
    document = session.document
    lane = document.lanes[document.shown]
    features: dict[str, float | str] = {_SCENARIO: document.scenario.id}
    values = Hyperparameters()
    for name, value in lane.settings_in_force.items():
        with suppress(ValueError):
            values = values.changed(name, value)
    if lane.algorithm_in_force in BY_ID and values.policy in POLICY_BY_ID:
        features.update(features_of(lane.algorithm_in_force, values, lane.seed))
    return {**features, _LANES: len(document.lanes)}


def _text(name: str, value: float | str) -> str:
    if name == _SCENARIO:
        return str(value)
    return counted(int(value), "run") if name == _LANES else feature_text(name, value)


# Row and details of a session


_UNITS: Final = ((86_400, "d", "day"), (3_600, "h", "hour"), (60, "min", "minute"))  # seconds, names
_MOST_DAYS: Final = 14
_LONGEST_PATH: Final = 1_000
_MOST_OWN: Final = 4


class SessionRow(FullWidth):
    """Two lines, with what is ``different`` from similar sessions."""

    def __init__(
        self,
        session: StoredSession,
        now: datetime,
        look: Look,
        different: Sequence[str] = (),
        number: int = 1,
    ) -> None:
        self._look = look
        self._title = session.title
        self._age = short_age(now - session.saved, session.saved)
        self._number = f" ({number})" if number > 1 else ""
        name = algorithm_name(session.algorithm)
        step = f"step {numbers.count(session.step, 12)}"
        of_lesson = [] if session.document.lesson is None else ["lesson"]
        self._line = f"  {' · '.join((*of_lesson, step, *different, *([] if name in different else [name])))}"

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        glyphs, width = self._look.glyphs, options.max_width
        room = max(1, width - cell_len(self._number) - cell_len(self._age) - 1)
        title = f"{shortened(glyphs.spelled(self._title), room, glyphs.ellipsis)}{self._number}"
        gap = " " * max(1, width - cell_len(title) - cell_len(self._age))
        yield Text(f"{title}{gap}{self._age}", no_wrap=True)
        yield Text(shortened(glyphs.separated(self._line), width, glyphs.ellipsis), no_wrap=True)


def session_facts(session: StoredSession, now: datetime, look: Look) -> RenderableType:
    """Return world, settings, changes and step."""
    palette, glyphs, document = look.palette, look.glyphs, session.document
    lane = document.lanes[document.shown]
    branch = lane.branches[lane.branch]
    scenario = document.scenario
    world = scenario.title if scenario.title == scenario.id else f"{scenario.title} ({scenario.id})"
    stands = f"step {session.step:,}"
    if branch.here < branch.end:
        stands = f"{stands} of {branch.end:,}"
    if len(document.lanes) > 1:
        stands = f"{stands} · run {document.shown + 1} of {len(document.lanes)}"
    if len(lane.branches) > 1:
        stands = f"{stands} · branch {branch.name.removeprefix('branch ')} of {len(lane.branches)}"
    lines = {
        "scenario": world,
        "algorithm": f"{algorithm_name(session.algorithm)} · seed {lane.seed}",
        "settings": " · ".join(settings_of(session)) or "none",
        "position": stands,
        "changes": f"{session.changes:,}" if session.changes else "none so far",
        "saved": f"{long_age(now - session.saved)} · {session.saved.astimezone():%Y-%m-%d %H:%M}",
        "file": one_line(str(session.path), _LONGEST_PATH),
    }
    rows = [(label, Text(glyphs.separated(line), overflow="fold")) for label, line in lines.items()]
    return Group(labelled(rows, look), Text(""), Text(_how_long(session), palette.dim))


def _how_long(session: StoredSession) -> str:
    if session.document.kept:
        return "Saved under a name: it stays until you delete it."
    if session.document.lesson is not None:
        return "A lesson, saved automatically. It stays until you delete it."
    return "Saved automatically. The newest 50 are kept. m s names it and keeps it."


def kept_line(count: int, look: Look) -> Text:
    """Return which key resumes one of ``count`` sessions, and which begins another."""
    text = f"enter: new run · tab: resume {'it' if count == 1 else f'one of {count}'}"
    return Text(look.glyphs.separated(text), look.palette.press, no_wrap=True, overflow="crop")


def own_sessions_text(sessions: Sequence[StoredSession], now: datetime, look: Look) -> RenderableType:
    """Return a heading, and a line per session."""
    lines = [Text("Sessions", look.palette.strong)]
    for session in sessions[:_MOST_OWN]:
        age = short_age(now - session.saved, session.saved)
        line = f"{age:<6} step {numbers.count(session.step, 7)} · {algorithm_name(session.algorithm)}"
        lines.append(Text(look.glyphs.separated(line), look.palette.text, no_wrap=True, overflow="crop"))
    return Group(*lines)


def algorithm_name(algorithm: str) -> str:
    """Return an algorithm's name, or its id."""
    return BY_ID[algorithm].name if algorithm in BY_ID else algorithm


def short_age(age: timedelta, moment: datetime) -> str:
    """Write a short ``age``, after two weeks the date."""
    seconds = int(age.total_seconds())
    if age.days >= _MOST_DAYS:
        return moment.astimezone().strftime("%Y-%m-%d")
    return next((f"{seconds // length} {unit}" for length, unit, _ in _UNITS if seconds >= length), "now")


def long_age(age: timedelta) -> str:
    """Write ``age`` in words."""
    seconds = int(age.total_seconds())
    ages = (f"{counted(seconds // length, word)} ago" for length, _, word in _UNITS if seconds >= length)
    return next(ages, "less than a minute ago")


# The list of sessions


_LONGEST_NAME: Final = 255

Entry = StoredSession | SessionError


class SessionList(RowList):
    """A list of sessions."""

    def __init__(self, look: Look) -> None:
        super().__init__(id="sessions", classes="panel")
        self.look = look
        self.border_title = "Sessions"
        self.border_subtitle = "enter: go on   del: delete"
        self.entries: Sequence[Entry] = ()  # the sessions, the newest first, then unreadable files

    def show(self, entries: Sequence[Entry], now: datetime) -> None:
        """List ``entries``."""
        self.entries = entries
        place = self.highlighted or 0
        self.clear_options()
        self.add_options(self._rows(now))
        if entries:
            self.highlighted = min(place, len(entries) - 1)

    @property
    def current(self) -> Entry | None:
        """The entry under the cursor, if any."""
        if self.highlighted is None or self.highlighted >= len(self.entries):
            return None
        return self.entries[self.highlighted]

    @property
    def sound(self) -> list[StoredSession]:
        """The sessions without unreadable files."""
        return [entry for entry in self.entries if isinstance(entry, StoredSession)]

    def _rows(self, now: datetime) -> Iterable[Option]:
        different = iter(differences(self.sound))
        alike = Counter[tuple[str, str, int]]()
        for entry in self.entries:
            if isinstance(entry, StoredSession):
                key = entry.title, short_age(now - entry.saved, entry.saved), entry.step
                alike[key] += 1
                yield Option(SessionRow(entry, now, self.look, next(different), alike[key]))
            else:
                name = self.look.glyphs.spelled(one_line(entry.path.name, _LONGEST_NAME))
                yield Option(Text(f"{name}\n  faulty", no_wrap=True))


class SavedSessions(ListScreen):
    """A screen with the sessions from the folder ``sessions``."""

    @dataclass
    class Resumed(Message):
        """The user goes on with a session, whose contents are ``record``."""

        session: StoredSession
        record: Record

    def __init__(self, look: Look, start_at: str, fault: UserError | None, sessions: Path | None) -> None:
        super().__init__(look, start_at, fault, sessions)
        self._sessions_read = asyncio.Event()

    @property
    def has_files(self) -> bool:
        """True if the folder may have sessions."""
        return self._sessions is not None and bool(files_in(self._sessions))

    def show_sessions(self, sessions: Sequence[StoredSession]) -> None:
        """Show what depends on ``sessions``."""
        raise NotImplementedError

    def begin(self) -> None:
        """Read the files."""
        self._read_sessions()

    async def sessions_read(self) -> None:
        """Wait until the files are listed."""
        await self._sessions_read.wait()

    def _read_sessions(self) -> None:
        if self._sessions is None:
            self._sessions_read.set()
            return
        self._sessions_read.clear()
        Thread(target=self._read, args=(self._sessions,), name="read sessions", daemon=True).start()

    def _read(self, folder: Path) -> None:
        sound, broken = sessions_in(folder)  # in the thread: only scheduled calls leave it
        with suppress(RuntimeError):  # the program has ended meanwhile
            self.deliver(self._list_sessions, [*sound, *broken])

    def _list_sessions(self, entries: Sequence[Entry]) -> None:
        sessions = self.query_one(SessionList)
        sessions.show(entries, datetime.now(UTC))
        if sessions.has_focus and not entries:
            self.query_one("#scenarios").focus()
        self.show_sessions(sessions.sound)
        self._sessions_read.set()
        self.show_current()

    def resume(self, session: StoredSession) -> None:
        """Go on with ``session``."""
        self.run_worker(self._resume(session), name="resume the session", exclusive=True, group="resume")

    async def _resume(self, session: StoredSession) -> None:
        with complaining(self.app):
            record = await asyncio.to_thread(session.record)  # may import Gymnasium
            self.post_message(self.Resumed(session, record))

    def ask_to_delete(self, session: StoredSession) -> None:
        """Delete ``session`` after a confirmation."""
        from rl_tui.screen.dialogs.dialog import Confirm

        def delete(answer: bool | None) -> None:
            if not answer:
                return
            with complaining(self.app):
                remove(session)
            self._read_sessions()

        question = f"Delete the session {session.title}, at step {session.step:,}? This cannot be undone."
        self.app.push_screen(Confirm("Delete", question, "delete", self.look.glyphs), delete)
