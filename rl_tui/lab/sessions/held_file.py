"""A session file that is being written here, and nowhere else meanwhile."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import TYPE_CHECKING, Final

from rl_tui.common.file_lock import FileLock
from rl_tui.lab.sessions.atomic_file import remove_with_draft, signature, write_atomically
from rl_tui.lab.sessions.place import VARIABLE, is_homeless

if TYPE_CHECKING:
    from rl_tui.lab.sessions.session import StoredSession

PRIVATE: Final = 0o700


class ChangedElsewhereError(Exception):
    """Somebody else has written the file since it was last read or written here."""


class HeldFile:
    """A file under lock. Made by :func:`hold` and :func:`hold_new`; ``release`` lets it go."""

    def __init__(self, path: Path, lock: FileLock, written: tuple[int, ...]) -> None:
        self.path = path
        self._lock = lock
        self._written = written

    def write(self, content: bytes) -> None:
        """Replace what is in the file, all at once.

        Raises OSError where it cannot be written, ChangedElsewhereError where somebody did so who heeds no
        lock, or has it since the folder was removed. What was removed is there again.
        """
        _make_folder(self.path.parent)
        if not self._lock.keep():
            raise ChangedElsewhereError
        if self.path.exists() and signature(self.path.stat()) != self._written:
            raise ChangedElsewhereError
        write_atomically(self.path, content)
        self._written = signature(self.path.stat())

    def remove(self) -> None:
        """Remove the file, and let it go. Raises OSError."""
        remove_with_draft(self.path)
        self.release()

    def release(self) -> None:
        """Let the file go."""
        self._lock.release()


def hold(session: StoredSession) -> HeldFile | None:
    """Return the file of ``session`` to go on with.

    None where another program has it open, or has written it since it was read, or where it cannot be
    written.
    """
    path = session.path.resolve()
    lock = FileLock(path)
    try:
        if not (os.access(path, os.W_OK) and lock.acquire()):
            return None
        if signature(path.stat()) == session.written:
            return HeldFile(path, lock, session.written)
    except OSError:
        pass
    lock.release()
    return None


def hold_new(path: Path) -> HeldFile:
    """Return a file to begin, in a folder that is made where it is missing.

    Raises FileExistsError where there is such a file, or somebody is about to begin it, and OSError.
    """
    _make_folder(path.parent)
    lock = FileLock(path)
    if not lock.acquire() or path.exists():
        lock.release()
        raise FileExistsError(path)
    return HeldFile(path, lock, ())


def _make_folder(folder: Path) -> None:
    """Make ``folder`` where it is missing. Raises OSError, never FileExistsError: that tells of a file."""
    if is_homeless(folder):
        raise OSError(errno.ENOENT, f"there is no home folder; set HOME or {VARIABLE}")
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=PRIVATE)
    except FileExistsError:
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder)) from None
