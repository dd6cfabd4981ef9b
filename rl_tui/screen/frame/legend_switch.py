"""Whether panels explain themselves, and what cells of maps show, as a person last chose."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Final

_FILE: Final = ".legends-hidden"


class LegendSwitch:
    """On at first. Off is remembered by a file in ``folder``, which is that of the sessions.

    Where there is no folder, or none that may be written, nothing is remembered.
    """

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder
        self.is_on = True
        self.numbers_states = False
        """Whether the cells of maps have the numbers of their states; that is not remembered."""
        self.shows_actions = False
        """Whether these cells show Q of every action in place of V; not remembered either."""
        if folder is not None:
            with suppress(OSError):
                self.is_on = not (folder / _FILE).exists()

    def turn(self) -> None:
        """Turn it off, or on again."""
        self.is_on = not self.is_on
        if self._folder is None:
            return
        from rl_tui.live.sessions.place import is_homeless

        if is_homeless(self._folder):
            return
        with suppress(OSError):
            if self.is_on:
                (self._folder / _FILE).unlink(missing_ok=True)
            else:
                self._folder.mkdir(parents=True, exist_ok=True)
                (self._folder / _FILE).touch()
