"""Choices that hold for all screens."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Final

_LEGENDS_HIDDEN: Final = ".legends-hidden"
_ALL_PANELS: Final = ".panels-all"


class LegendSwitch:
    """Choices saved in ``folder``."""

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder
        self.is_on = not self._is_remembered(_LEGENDS_HIDDEN)
        self.shows_all_panels = self._is_remembered(_ALL_PANELS)
        self.names_all_keys = False
        """True if the key line names all keys, for users with some experience."""
        self.numbers_states = False
        """True if cells of maps show the numbers of their states (not saved)."""
        self.shows_actions = False
        """True if these cells show Q rather than V (not saved)."""

    def turn(self) -> None:
        """Hide or show the legends."""
        self.is_on = not self.is_on
        self._remember(_LEGENDS_HIDDEN, is_there=not self.is_on)

    def turn_panels(self) -> None:
        """Switch between all panels and usual ones."""
        self.shows_all_panels = not self.shows_all_panels
        self._remember(_ALL_PANELS, is_there=self.shows_all_panels)

    def _is_remembered(self, name: str) -> bool:
        if self._folder is None:
            return False
        with suppress(OSError):
            return (self._folder / name).exists()
        return False

    def _remember(self, name: str, *, is_there: bool) -> None:
        if self._folder is None:
            return
        from rl_tui.live.sessions.place import is_homeless

        if is_homeless(self._folder):
            return
        with suppress(OSError):
            if is_there:
                self._folder.mkdir(parents=True, exist_ok=True)
                (self._folder / name).touch()
            else:
                (self._folder / name).unlink(missing_ok=True)
