"""Automatic saving, so that little is lost however the program ends."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Final, NamedTuple

from rl_tui.live.record import LearnedTable, Record, RecordSink
from rl_tui.live.sessions.place import settled
from rl_tui.live.sessions.session import MOST_PAIRS_DIGESTED, StoredSession, digest_of
from rl_tui.live.sessions.writer import SessionWriter, reason
from rl_tui.runs.recipe import Recipe, WorldChange
from rl_tui.runs.timeline.branches import RunRecord

INTERVAL: Final = 0.3
AGAIN: Final = 2.0  # seconds until a failed write is repeated
LONGEST_GOODBYE: Final = 3.0
_REST: Final = 3  # pause after a write, as a multiple of its duration

OnNotice = Callable[[str], None]


def untouched(recipe: Recipe) -> Record:
    """Return the record of a run at its start."""
    return Record((RunRecord(recipe),))


class KeptSession(NamedTuple):
    """A complete session on disk."""

    title: str
    """Name given by the user, or title of the lesson or scenario."""
    step: int
    """Current step."""
    path: Path
    """Path of the file."""


class Autosave:
    """Writes the newest record to its own file, at most every 0.3 s.

    A file is created only after a step, a drawing, progress in a lesson, or a save by name. It is locked
    while in use. Players offer records to `sink`. Before another player continues the session, call
    `hand_over`. Messages go to the listener from any thread.

    The screen starts with the record `opened`. A session `resumed` continues, in its own file if possible.
    """

    def __init__(self, opened: Record, folder: Path, resumed: StoredSession | None = None) -> None:
        self.folder = settled(folder)
        self._changed = threading.Condition()  # guards the lines up to the next lock
        self._notices: list[str] = []
        self._on_notice: OnNotice | None = None
        self._closing = False
        self._thread: threading.Thread | None = None
        self._session = _Session(opened, SessionWriter(self.folder, resumed, self._tell))
        self._left: list[_Session] = []  # earlier sessions that are not written yet
        self._before: _Session | None = None  # the last earlier session with content
        self._sink = _PlayerSink(self, self._changed)  # earlier sinks ignore offers
        self._writing = threading.Lock()  # guards the files and the following lines
        self._in_trouble = False

    @property
    def path(self) -> Path | None:
        """Path of the file, if any."""
        return self._session.writer.path

    @property
    def title(self) -> str:
        """The user's name, or ""."""
        return self._session.writer.title

    @property
    def kept(self) -> KeptSession | None:
        """The session on disk, or the previous one if nothing was done in this one."""
        for session in (self._session, self._before):
            path = None if session is None else session.writer.path
            if session is not None and path is not None and not session.is_due and path.exists():
                record = session.newest.record
                shown = record.lanes[record.shown]
                subject = shown.recipe.scenario if record.lesson is None else record.lesson.lesson
                return KeptSession(session.writer.title or subject.title, shown.step, path)
        return None

    @property
    def has_something(self) -> bool:
        """True if something is or will be saved."""
        return self.kept is not None or self.has_work

    def offer(self, record: Record, table: LearnedTable | None = None) -> None:
        """Take `record` as the newest without waiting, and copy `table`, at its position."""
        with self._changed:
            newest = self._session.newest
            is_news = record != newest.record or (table is not None and not newest.has_table)
            if is_news and not self._closing:
                self._session.take(_Offer(record, table))
                self._start_or_wake()

    def begin_anew(self, record: Record) -> None:
        """Begin another session without waiting.

        A session of a lesson, or with no more than `record`, is reused instead.
        """
        with self._changed:
            old = self._session
            is_as_before = record.lanes == old.newest.record.lanes
            gives_way = (is_as_before or _is_blank(old.newest.record)) and not old.writer.kept
            if self._closing or gives_way or record.lesson is not None:
                same_session = old
            else:
                self._left.append(old)
                if old.is_due or old.writer.path is not None:
                    self._before = old
                before = tuple(RunRecord(lane.recipe) for lane in old.newest.record.lanes)
                opened = replace(record, lanes=before)
                same_session = _Session(opened, SessionWriter(self.folder, None, self._tell))
                self._session = same_session
            same_session.take(_Offer(record, None))
            self._start_or_wake()

    @property
    def sink(self) -> RecordSink:
        """Sink of the newest player; closing it closes this too."""
        return self._sink

    def hand_over(self, record: Record) -> None:
        """Continue the session with the next player from `record`, without waiting.

        The old player's sink has no effect from now on. Call this before that player is closed, because
        closing the newest sink ends the session.
        """
        with self._changed:
            self._sink.is_newest = False
            self._sink = _PlayerSink(self, self._changed)
            self.offer(record)

    def save_as(self, title: str) -> Path:
        """Save as `title`, waiting for the disk, and continue at the returned path.

        Raises UserError if another session has that name, or the file cannot be written.
        """
        with self._writing:
            session = self._session
            newest = session.newest
            path = session.writer.save_as(title, newest.record, newest.digest)
            session.written, session.begun = newest, True
            self._in_trouble = False
            if self._closing:
                session.writer.release()
        return path

    def become_copy(self) -> None:
        """Leave the file unchanged and continue in another one."""
        with self._writing:
            self._session.writer.become_copy()

    def listen(self, on_notice: OnNotice) -> None:
        """Call `on_notice` with all messages for the user."""
        with self._changed:
            self._on_notice = on_notice
            waiting, self._notices = self._notices, []
        for notice in waiting:
            on_notice(notice)

    def close(self) -> None:
        """Write what is due, and release the file."""
        with self._changed:
            self._closing = True
            self._changed.notify_all()
        if self._thread is not None:
            self._thread.join(LONGEST_GOODBYE)
            if self._thread.is_alive():
                return  # the disk hangs: the lock remains until the program ends
        for session in (*self._left, self._session):
            session.writer.release()

    def _start_or_wake(self) -> None:
        if self._thread is None and self.has_work:
            thread = threading.Thread(target=self._live, name="autosave", daemon=True)
            try:
                thread.start()
            except RuntimeError as error:  # too many threads; the next offer tries again
                if not self._in_trouble:
                    self._in_trouble = True
                    self._tell(f"this session is not being saved: {error}")
                return
            self._thread = thread
        self._changed.notify_all()

    @property
    def has_work(self) -> bool:
        """True if something is unwritten."""
        return bool(self._left) or self._session.is_due

    def _tell(self, notice: str) -> None:
        with self._changed:
            on_notice = self._on_notice
            if on_notice is None:
                self._notices.append(notice)
        if on_notice is not None:
            on_notice(notice)

    # The thread

    def _live(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._closing or self.has_work)
                closing = self._closing
            started = time.perf_counter()
            self.write_due()
            if closing:
                return
            least = AGAIN if self._in_trouble else INTERVAL
            pause = max(least, _REST * (time.perf_counter() - started))
            with self._changed:
                self._changed.wait_for(lambda: self._closing, pause)

    def write_due(self) -> None:
        """Write what is due, waiting for the disk."""
        with self._writing:
            with self._changed:
                left, self._left = self._left, []
            faults = [(session, self._fault_of(session)) for session in (*left, self._session)]
            for session, fault in faults:
                if session in left and fault is None:
                    session.writer.release()
            with self._changed:
                self._left = [each for each, fault in faults if each in left and fault] + self._left
            self._tell_of([fault for _, fault in faults if fault is not None])

    def _tell_of(self, faults: list[Exception]) -> None:
        if faults and not self._in_trouble:
            self._tell(f"this session is not being saved: {reason(faults[0])}")
        elif self._in_trouble and not faults:
            self._tell("this session is being saved again")
        self._in_trouble = bool(faults)

    def _fault_of(self, session: _Session) -> Exception | None:
        if not session.is_due:
            return None
        newest = session.newest
        try:
            session.writer.write(newest.record, newest.digest)
        except Exception as error:  # the program continues after any error, with a message
            return error
        session.written = newest
        return None


class _PlayerSink:
    def __init__(self, autosave: Autosave, changed: threading.Condition) -> None:
        self.is_newest = True
        self._autosave = autosave
        self._changed = changed  # guards is_newest

    def offer(self, record: Record, table: LearnedTable | None = None) -> None:
        with self._changed:
            if self.is_newest:
                self._autosave.offer(record, table)

    def begin_anew(self, record: Record) -> None:
        with self._changed:
            if self.is_newest:
                self._autosave.begin_anew(record)

    def close(self) -> None:
        with self._changed:
            is_newest = self.is_newest
        if is_newest:
            self._autosave.close()


class _Session:
    """A session with its writer, `begun` once a record differs from `opened`."""

    def __init__(self, opened: Record, writer: SessionWriter) -> None:
        self.writer = writer
        self.newest = _Offer(opened, None)
        self.begun = False
        self.written = self.newest
        self._opened = opened

    @property
    def is_due(self) -> bool:
        is_worth_it = self.writer.path is not None or _has_deeds(self.newest.record)
        return self.begun and self.newest is not self.written and is_worth_it

    def take(self, offer: _Offer) -> None:
        self.newest = offer
        # the speed is not content
        here, opened = replace(offer.record, speed=None), replace(self._opened, speed=None)
        self.begun = self.begun or here != opened


class _Offer:
    def __init__(self, record: Record, table: LearnedTable | None) -> None:
        self.has_table = table is not None
        self._copy = None if table is None or len(table.q) > MOST_PAIRS_DIGESTED else _copied(table)
        self.record = record if self._copy is None else replace(record, table=self._copy)

    @property
    def digest(self) -> str:
        return "" if self._copy is None else digest_of(self._copy.q)


def _copied(table: LearnedTable) -> LearnedTable:
    return replace(table, q=table.q.copy(), visits=table.visits.copy())


def _has_deeds(record: Record) -> bool:
    branches = [branch for lane in record.lanes for branch in lane.branches]
    is_drawn = any(isinstance(entry.change, WorldChange) for each in branches for entry in each.journal)
    return (
        is_drawn
        or any(each.end for each in branches)
        or bool(record.drawn.choices)
        or (record.lesson is not None and record.lesson.is_begun)
    )


def _is_blank(record: Record) -> bool:
    is_changed = any(branch.journal for lane in record.lanes for branch in lane.branches)
    return not (is_changed or _has_deeds(record))
