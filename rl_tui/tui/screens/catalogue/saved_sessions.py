"""The sessions of the catalogue: listed, gone on with, deleted."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING

from textual.message import Message

from rl_tui.common.errors import UserError
from rl_tui.lab.sessions.folder import files_in, remove, sessions_in
from rl_tui.lab.sessions.session import SessionError, StoredSession
from rl_tui.terminal.linked_app import LinkedApp
from rl_tui.tui.screens.action_screen import ActionScreen
from rl_tui.tui.screens.catalogue.session_list import SessionList
from rl_tui.tui.theme.look import Look

if TYPE_CHECKING:
    from rl_tui.lab.live.record import Record


class SavedSessions(ActionScreen):
    """A screen with a list of sessions, which are read in a thread. Subclasses put the list somewhere.

    ``sessions`` is their folder, None where none are kept.
    """

    @dataclass
    class Resumed(Message):
        """The user wants to go on with a session; ``record`` is what it says."""

        session: StoredSession
        record: Record

    @dataclass
    class SessionsRead(Message):
        """The files of the sessions are read."""

        entries: list[StoredSession | SessionError]

    def __init__(self, look: Look, sessions: Path | None) -> None:
        super().__init__(look)
        self._sessions = sessions
        self._sessions_read = asyncio.Event()

    def new_session_list(self) -> SessionList:
        """Return the list, with room for as many sessions as there are files."""
        return SessionList(self.look, 0 if self._sessions is None else len(files_in(self._sessions)))

    def show_current(self) -> None:
        """Show what is under the cursor."""
        raise NotImplementedError

    def on_mount(self) -> None:
        """Begin what is slow once the first paint is done."""
        self.run_worker(self._begin_when_painted, name="begin", group="begin")  # type: ignore[arg-type]

    async def _begin_when_painted(self) -> None:
        if isinstance(self.app, LinkedApp):
            await self.app.painted()
        self.begin()

    def begin(self) -> None:
        """Begin to read the files."""
        self._read_sessions()

    async def sessions_read(self) -> None:
        """Wait until the files are read and listed."""
        await self._sessions_read.wait()

    def _read_sessions(self) -> None:
        if self._sessions is None:
            self._sessions_read.set()
            return
        self._sessions_read.clear()
        Thread(target=self._read, args=(self._sessions,), name="read sessions", daemon=True).start()

    def _read(self, folder: Path) -> None:
        """In the thread: only messages leave it."""
        sound, broken = sessions_in(folder)
        with suppress(RuntimeError):  # the program has ended meanwhile
            self.post_message(self.SessionsRead([*sound, *broken]))

    def on_saved_sessions_sessions_read(self, event: SessionsRead) -> None:
        """List the sessions."""
        sessions = self.query_one(SessionList)
        had_focus = sessions.has_focus
        sessions.show(event.entries, datetime.now(UTC))
        if had_focus and not event.entries:
            self.query_one("#scenarios").focus()
        self._sessions_read.set()
        if had_focus:
            self.show_current()

    def resume(self, session: StoredSession) -> None:
        """Go on with ``session``."""
        self.run_worker(self._resume(session), name="resume the session", exclusive=True, group="resume")

    async def _resume(self, session: StoredSession) -> None:
        try:
            record = await asyncio.to_thread(session.record)  # may import Gymnasium
        except UserError as fault:
            self.notify(str(fault), severity="error", timeout=15, markup=False)
        else:
            self.post_message(self.Resumed(session, record))

    def ask_to_delete(self, session: StoredSession) -> None:
        """Delete ``session`` once that is confirmed."""
        from rl_tui.tui.screens.dialogs.confirm import Confirm

        def delete(answer: bool | None) -> None:
            if not answer:
                return
            try:
                remove(session)
            except UserError as fault:
                self.notify(str(fault), severity="error", markup=False)
            self._read_sessions()

        question = f"Delete the session {session.title}, at step {session.step:,}? It cannot be brought back."
        self.app.push_screen(Confirm("Delete", question, "delete", self.look.glyphs), delete)
