"""The session of a playground: saving, and a check after resuming."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from functools import partial

from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line
from rl_tui.live.sessions.autosave import Autosave
from rl_tui.live.sessions.document import LONGEST_NAME
from rl_tui.live.sessions.session import OTHER_BITS, SessionError, StoredSession, digest_of, named_path
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.dialogs.form import Prompt
from rl_tui.screen.panels.status_line import StatusLine


@dataclass(eq=False)
class SessionActions(Subject):
    """The saving by ``autosave``, and one comparison of the run with ``resumed``."""

    status: StatusLine
    autosave: Autosave | None
    resumed: StoredSession | None
    _name: str = ""

    def show_name(self) -> None:
        """Show the name of the session, if a person gave one."""
        name = "" if self.autosave is None else self.autosave.title
        if name != self._name:
            self._name = name
            self.status.name_session(one_line(name, LONGEST_NAME))

    def listen(self) -> None:
        """Show all later notices about the session, which may come from any thread."""
        notify = partial(self.screen.notify, severity="warning", timeout=15, markup=False)

        def listen(notice: str) -> None:
            self.screen.call_later(notify, notice)

        if self.autosave is not None:
            self.autosave.listen(listen)

    def named(self, fault: UserError) -> UserError:
        """Return ``fault`` with the file of the session that could not be resumed."""
        return fault if self.resumed is None else SessionError(self.resumed.path, str(fault))

    def compare_with_saved(self, snapshot: Snapshot) -> None:
        """Warn if the resumed run differs from the saved one."""
        if self.resumed is None or snapshot.playback.phase in (Phase.PREPARING, Phase.SEEKING):
            return
        document, self.resumed = self.resumed.document, None
        lane = document.lanes[document.shown]
        left = (document.shown, lane.branch, lane.branches[lane.branch].here)
        here = (snapshot.run_group.shown, snapshot.timeline.branch, snapshot.counters.step)
        if here != left or snapshot.agent.part is not None:
            return
        if document.digest and digest_of(snapshot.agent.q) != document.digest:
            if self.autosave is not None:
                self.autosave.become_copy()
            self.screen.notify(
                f"{OTHER_BITS}. What you do here is saved in a copy.", severity="warning", timeout=15
            )

    @property
    def after_leaving(self) -> str:
        """A clause about the run after a person has left it."""
        if self.snapshot is not None and self.snapshot.program is not None:
            return "your program then ends"
        return "this run is then gone" if self.screen.in_kiosk else "this run is kept"

    def why_not(self, deed: str) -> str:
        """Return why nothing can be saved."""
        reason = ": this is a kiosk" if self.screen.in_kiosk else ""
        return f"no session is saved here{reason}" if deed == "save" and self.autosave is None else ""

    def save(self) -> None:
        """Ask for a name, and save the session."""
        autosave = self.autosave
        if autosave is None:
            return

        def read(text: str) -> str:
            try:
                path = named_path(autosave.folder, text)
            except UserError as fault:
                raise ValueError(str(fault)) from fault
            if path != autosave.path and path.exists():
                raise ValueError("another session has this name: type another")
            return text.strip()

        def save(name: float | str) -> None:
            self.screen.run_worker(self._save(autosave, str(name)), name="save the session")

        hint = "This session is now saved under that name."
        self.ask(Prompt("Save the session as", hint, autosave.title, read, "save"), save)

    async def _save(self, autosave: Autosave, name: str) -> None:
        try:
            path = await asyncio.to_thread(autosave.save_as, name)
        except UserError as fault:
            self.screen.notify(str(fault), severity="error", timeout=15, markup=False)
        else:
            self.screen.notify(f"saved: {path}", timeout=8, markup=False)
            self.show_name()
