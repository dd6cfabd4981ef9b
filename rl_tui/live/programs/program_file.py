"""The file of a program: its lines, and whether it was saved again."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.common.limits import LARGEST_SOURCE
from rl_tui.common.text_file import UnreadableError, open_plain
from rl_tui.programs.watched.child.script import check_script

LOOKS: Final = 0.1
"""Seconds between two looks at the file."""
SETTLED: Final = 0.3
"""So many seconds after it was saved last it counts."""


class ProgramFile:
    """Looks whether the file at ``path`` was saved; ``clock`` gives seconds."""

    def __init__(self, path: Path, clock: Callable[[], float]) -> None:
        self.path = path
        self.source: tuple[str, ...] = _lines(path)
        """Its lines as they were when the program was started."""
        self._clock = clock
        self._stamp = self._seen = _stamp(path)
        self._looked_at = self._changed_at = clock()

    def was_saved(self) -> bool:
        """Return whether it is another file than before, and has been for a moment; once for each time."""
        now = self._clock()
        if now - self._looked_at < LOOKS:
            return False
        self._looked_at = now
        stamp = _stamp(self.path)
        if stamp != self._seen:
            self._seen, self._changed_at = stamp, now
        if self._seen == self._stamp or self._seen is None or now - self._changed_at < SETTLED:
            return False
        self._stamp = self._seen
        return True

    def fault(self) -> str:
        """Return what keeps its text from being a program, in one line; empty where nothing does."""
        try:
            check_script(self.path)
        except UserError as fault:
            return str(fault)
        return ""

    def read_again(self) -> None:
        """Take its lines as they are now for those of the program."""
        self.source = _lines(self.path)


def _stamp(path: Path) -> tuple[int, int] | None:
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size


def _lines(path: Path) -> tuple[str, ...]:
    try:
        with open_plain(path, "a Python file") as file:
            return tuple(file.read(LARGEST_SOURCE).decode("utf-8", "replace").splitlines())
    except (OSError, UnreadableError):
        return ()
