"""Whether panels explain themselves, which are in view, and what cells of maps show, as last chosen."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Final

_LEGENDS_HIDDEN: Final = ".legends-hidden"
_ALL_PANELS: Final = ".panels-all"


class LegendSwitch:
    """What a person chose last: whether panels explain their symbols, and whether all panels are in view.

    Legends are on at first, and not all panels are in view. What differs is remembered by a file in
    ``folder``, which is that of the sessions; without a folder that may be written nothing is remembered.
    """

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder
        self.is_on = not self._is_remembered(_LEGENDS_HIDDEN)
        self.shows_all_panels = self._is_remembered(_ALL_PANELS)
        self.names_all_keys = False
        """Whether the key line names all keys: once a session is kept or a run paused after an episode."""
        self.numbers_states = False
        """Whether the cells of maps have the numbers of their states; that is not remembered."""
        self.shows_actions = False
        """Whether these cells show Q of every action in place of V; not remembered either."""

    def turn(self) -> None:
        """Hide legends, or show them again."""
        self.is_on = not self.is_on
        self._remember(_LEGENDS_HIDDEN, is_there=not self.is_on)

    def turn_panels(self) -> None:
        """Show all panels from now on, or only those that mean something."""
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
