"""Saving a session, and the way out."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line
from rl_tui.live.sessions.autosave import Autosave
from rl_tui.live.sessions.document import LONGEST_NAME
from rl_tui.live.sessions.session import OTHER_BITS, SessionError, StoredSession, digest_of, named_path
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.dialogs.form import Prompt
from rl_tui.screen.frame.message_line import complaining
from rl_tui.screen.panels.status_line import StatusLine
from rl_tui.screen.playground.modes.mode import Modes


@dataclass(eq=False)
class SessionActions(Subject):
    """The saving by ``autosave``, and one comparison with ``resumed``."""

    status: StatusLine
    autosave: Autosave | None
    resumed: StoredSession | None
    _name: str = ""

    def show_name(self) -> None:
        """Show the session's given name."""
        name = "" if self.autosave is None else self.autosave.title
        if name != self._name:
            self._name = name
            self.status.name_session(one_line(name, LONGEST_NAME))

    def listen(self) -> None:
        """Show later notices, which may come from any thread."""
        notify = partial(self.screen.notify, severity="warning", timeout=15, markup=False)

        def listen(notice: str) -> None:
            self.screen.call_later(notify, notice)

        if self.autosave is not None:
            self.autosave.listen(listen)

    def named(self, fault: UserError) -> UserError:
        """Name the file that could not be resumed."""
        return fault if self.resumed is None else SessionError(self.resumed.path, str(fault))

    def compare_with_saved(self, snapshot: Snapshot) -> None:
        """Warn if the resumed run differs."""
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
        """A clause about the run after leaving."""
        if self.snapshot is not None and self.snapshot.program is not None:
            return "your program then ends"
        return "this run is then gone" if self.screen.in_kiosk else "this run is kept"

    def why_not(self, deed: str) -> str:
        """Explain why nothing can be saved."""
        reason = ": this is a kiosk" if self.screen.in_kiosk else ""
        return f"no session is saved here{reason}" if deed == "save" and self.autosave is None else ""

    def save(self) -> None:
        """Ask for a name, and save."""
        autosave = self.autosave
        if autosave is None:
            return

        def read(text: str) -> str:
            path = named_path(autosave.folder, text)
            if path != autosave.path and path.exists():
                raise ValueError("another session has this name: type a new one")
            return text.strip()

        def save(name: float | str) -> None:
            self.screen.run_worker(self._save(autosave, str(name)), name="save the session")

        hint = "From now on, this session has that name. The start screen lists it."
        self.ask(Prompt("Save the session as", hint, autosave.title, read, "save"), save)

    async def _save(self, autosave: Autosave, name: str) -> None:
        with complaining(self.screen.app):
            path = await asyncio.to_thread(autosave.save_as, name)
            self.screen.tell(f"saved: {path}", timeout=8)
            self.show_name()


# Leaving, in steps


LEAVING_KEYS: Final = ("escape", "q")


@dataclass(eq=False)
class Leaving(Subject):
    """The way out: close what is open, then maybe ask."""

    session: SessionActions
    modes: Modes
    is_over: Callable[[], bool]
    leave: Callable[[], None]
    asked: tuple[str, int] | None = None
    """The key that asked, and the last deed then."""

    def back(self) -> None:
        """Close what is open, or go back."""
        where = "the start screen" if self.link.wanted.lesson is None else "the lessons"
        if not self._closes() and not self._asks("esc", f"esc again: back to {where}"):
            self.leave()

    def quit(self) -> None:
        """Close what is open, or quit."""
        if not self._closes() and not self._asks("q", "q again quits"):
            self.screen.app.exit()

    def _closes(self) -> bool:
        page = self.board.lesson
        if self.board.zoomed:
            self.board.zoom(None)
        elif page.panel.takes_turns and page.is_in_view and not self.is_over():
            page.reads = False
        elif self.board.opened is not None:
            self.board.close()
        elif self.modes.current is not None and not self.is_over():
            self.modes.current.toggle()
        else:
            return False
        return True

    def _asks(self, key: str, question: str) -> bool:
        wanted = self.link.wanted
        asked = key, wanted.last_deed
        if self.is_over() or not wanted.was_used(self.snapshot) or self.asked == asked:
            return False
        self.asked = asked
        self.screen.tell(f"{question}; {self.session.after_leaving}.")
        return True
