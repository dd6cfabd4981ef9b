"""A lock that one program holds for a file, and that the system takes back however the program ends."""

from __future__ import annotations

import errno
import os
import sys
from contextlib import suppress
from pathlib import Path
from typing import Final

OURS_ALONE: Final = 0o600
"""The mode of files that no other user may read."""
_TAKEN: Final = (errno.EACCES, errno.EAGAIN, errno.EWOULDBLOCK, errno.EDEADLK)
_WITHOUT_LOCKS: Final = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP)

if sys.platform == "win32":
    import msvcrt

    def _seize(descriptor: int) -> None:
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _seize(descriptor: int) -> None:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)


class FileLock:
    """The lock of ``path``: a hidden file beside it, as the file itself is replaced when it is written.

    A lock file that was left behind by a program that was killed is nobody's, and is taken over.
    """

    def __init__(self, path: Path) -> None:
        self._path = path.with_name(f".{path.name}.lock")
        self._descriptor: int | None = None

    def acquire(self) -> bool:
        """Take the lock; False where another program, or another part of this one, holds it.

        Some network file systems know no locks: there everybody gets one. Raises OSError where the lock file
        cannot be made.
        """
        while self._descriptor is None:
            descriptor = os.open(self._path, os.O_RDWR | os.O_CREAT, OURS_ALONE)
            try:
                _seize(descriptor)
            except OSError as error:
                if error.errno not in _WITHOUT_LOCKS:
                    os.close(descriptor)
                    if error.errno in _TAKEN:
                        return False
                    raise
            if self._is_still_there(descriptor):
                self._descriptor = descriptor
            else:  # whoever held it has just let go and removed the file: this one has no name any more
                os.close(descriptor)
        return True

    def keep(self) -> bool:
        """Take the lock once more where its file was removed; False where somebody else has it by now.

        Raises OSError as :meth:`acquire` does.
        """
        if self._descriptor is not None and not self._is_still_there(self._descriptor):
            os.close(self._descriptor)
            self._descriptor = None
        return self.acquire()

    def release(self) -> None:
        """Give the lock back; nothing happens without one."""
        if self._descriptor is None:
            return
        with suppress(OSError):  # while it is held, so that nobody else's is removed
            self._path.unlink()
        os.close(self._descriptor)
        self._descriptor = None

    def _is_still_there(self, descriptor: int) -> bool:
        try:
            return os.path.samestat(os.fstat(descriptor), self._path.stat())
        except FileNotFoundError:
            return False
