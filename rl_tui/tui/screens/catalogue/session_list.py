"""The recent sessions, the last one saved first; files that are faulty stand at the end."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from datetime import datetime
from typing import Final

from rich.text import Text
from textual.widgets import OptionList
from textual.widgets.option_list import Option

from rl_tui.common.findings import one_line
from rl_tui.lab.sessions.session import SessionError, StoredSession
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.screens.catalogue.session_differences import differences
from rl_tui.tui.screens.catalogue.session_text import SessionRow, short_age
from rl_tui.tui.theme.look import Look

_LONGEST_NAME: Final = 255
_WITHOUT_FOCUS: Final = "shift+tab: here"
_WITH_FOCUS: Final = "enter: go on   del: delete"

Entry = StoredSession | SessionError


class SessionList(OptionList):
    """A list of sessions, of which ``current`` is under the cursor.

    Until the files are read it keeps room for ``files`` of them, so that nothing jumps.
    """

    def __init__(self, look: Look, files: int) -> None:
        super().__init__(
            *(Option(Text("\n"), disabled=True) for _ in range(files)), id="sessions", classes="panel"
        )
        self.look = look
        self.border_title = "Recent sessions"
        self.border_subtitle = _WITHOUT_FOCUS
        self.display = files > 0
        self._entries: Sequence[Entry] = ()

    def show(self, entries: Sequence[Entry], now: datetime) -> None:
        """List ``entries``; where there is none, not even the frame is there."""
        self._entries = entries
        place = self.highlighted or 0
        self.clear_options()
        self.add_options(self._rows(now))
        self.display = bool(entries)
        if self.has_focus and entries:
            self.highlighted = min(place, len(entries) - 1)

    @property
    def current(self) -> Entry | None:
        """The entry under the cursor, None where there is no cursor."""
        if self.highlighted is None or self.highlighted >= len(self._entries):
            return None
        return self._entries[self.highlighted]

    def on_blur(self) -> None:
        """Show in the border how to come here."""
        self.border_subtitle = _WITHOUT_FOCUS

    def on_focus(self) -> None:
        """Begin at the newest; tell what can be done."""
        self.border_subtitle = _WITH_FOCUS
        if self.highlighted is None and self._entries:
            self.highlighted = 0

    def _rows(self, now: datetime) -> Iterable[Option]:
        different = iter(differences([entry for entry in self._entries if isinstance(entry, StoredSession)]))
        alike = Counter[tuple[str, str, int]]()
        for entry in self._entries:
            if isinstance(entry, StoredSession):
                key = entry.title, short_age(now - entry.saved, entry.saved), entry.step
                alike[key] += 1
                yield Option(SessionRow(entry, now, self.look, next(different), alike[key]))
            else:
                name = to_ascii(one_line(entry.path.name, _LONGEST_NAME), self.look.glyphs)
                yield Option(Text(f"{name}\n  faulty", no_wrap=True))
