"""File locks, and three ways to write that never leave half a file.

:func:`write_atomically` replaces a file and keeps the old one until then. :func:`new_file` refuses existing
names. :func:`whole_file` overwrites a file and removes it if writing fails.
"""

from __future__ import annotations

import errno
import os
import sys
import time
from collections.abc import Container, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from stat import S_ISREG
from typing import Final, TextIO

from rl_tui.common.errors import UserError
from rl_tui.common.findings import is_plain, printable

# Locks


OURS_ALONE: Final = 0o600
"""Mode of files that no other user may read."""
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
    """A lock for `path`, held by a hidden file next to it, because writing replaces the file itself.

    A lock left by a killed program can be taken.
    """

    def __init__(self, path: Path) -> None:
        self._path = path.with_name(f".{path.name}.lock")
        self._descriptor: int | None = None

    def acquire(self) -> bool:
        """Take the lock, or return False if another holder has it.

        File systems without locks always grant it.

        Raises:
            OSError: The lock file cannot be created.
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
            else:  # the previous holder just removed the file, so this lock has no name any more
                os.close(descriptor)
        return True

    def keep(self) -> bool:
        """Take the lock again if its file was removed. Return False if another holder has it.

        Raises:
            OSError: The lock file cannot be created.
        """
        if self._descriptor is not None and not self._is_still_there(self._descriptor):
            os.close(self._descriptor)
            self._descriptor = None
        return self.acquire()

    def release(self) -> None:
        """Release the lock, if it is held."""
        if self._descriptor is None:
            return
        with suppress(OSError):  # before closing, so that only our own lock file is removed
            self._path.unlink()
        os.close(self._descriptor)
        self._descriptor = None

    def _is_still_there(self, descriptor: int) -> bool:
        try:
            return os.path.samestat(os.fstat(descriptor), self._path.stat())
        except FileNotFoundError:
            return False


# Replace a file, or leave the old one


# Another user with access to the folder must not redirect this write by a link
_FLAGS: Final = (
    os.O_WRONLY | os.O_CREAT | os.O_TRUNC | getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0)
)
_NEW: Final = ".new"
_LONGEST_WRITE: Final = 60.0  # seconds, far more than needed


def write_atomically(path: Path, content: bytes, mode: int = OURS_ALONE) -> None:
    """Replace the content of `path` in one step. It is on disk when this returns.

    The umask limits `mode`.

    Raises:
        OSError: Writing failed. The old file is unchanged, and the error names a file.
    """
    new = draft_of(path)
    try:
        with open(os.open(new, _FLAGS, mode), "wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        new.replace(path)
    except OSError as error:
        with suppress(OSError):
            new.unlink()
        # the error of a full disk names no file
        raise OSError(error.errno, error.strerror, error.filename or str(path)) from error
    _settle(path.parent)


def draft_of(path: Path) -> Path:
    """Return the draft of `path`, always the same, so drafts cannot pile up."""
    return path.with_name(f".{path.name}{_NEW}")


def remove_old_drafts(folder: Path, suffix: str) -> None:
    """Remove drafts of programs that were killed while writing."""
    try:
        drafts = list(folder.glob(f".*{suffix}{_NEW}"))
    except OSError:  # an unreadable folder
        return
    for draft in drafts:
        lock = FileLock(draft.with_name(draft.name[1 : -len(_NEW)]))
        with suppress(OSError):
            # without locks only the age shows whether a program still writes it
            if lock.acquire() and time.time() - draft.stat().st_mtime > _LONGEST_WRITE:
                draft.unlink()
        lock.release()


def remove_with_draft(path: Path) -> None:
    """Remove `path` and its draft, if they exist, or raise OSError."""
    for each in (path, draft_of(path)):
        each.unlink(missing_ok=True)


def _settle(folder: Path) -> None:
    # The folder entry too goes to disk, where possible
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def signature(status: os.stat_result) -> tuple[int, ...]:
    """Return a value that changes whenever the file is written."""
    return status.st_ino, status.st_mtime_ns, status.st_size


# Begin a new file, or refuse


@contextmanager
def new_file(path: Path) -> Iterator[TextIO]:
    """Create `path` and yield it for text. It is removed if writing is interrupted.

    Raises:
        UserError: The file exists or cannot be written.
    """
    try:
        stream = path.open("x", encoding="utf-8", newline="")
    except FileExistsError as error:
        raise UserError(f'"{printable(str(path))}" already exists: choose another name') from error
    except (OSError, ValueError) as error:  # ValueError: not a possible file name
        raise _unwritable(path, error) from error
    begun = os.fstat(stream.fileno())
    try:
        with stream:
            yield stream
    except BaseException as error:
        _remove(path, begun)
        if isinstance(error, OSError):
            raise _unwritable(path, error) from error
        raise


def write_new(path: Path, text: str) -> None:
    """Write a new file, or raise UserError."""
    with new_file(path) as stream:
        stream.write(text)


def new_path(text: str) -> Path:
    """Return the path for a new file from user input. ``~`` is the home folder.

    Raises:
        UserError: The file exists, its folder does not, or the name is impossible.
    """
    text = text.strip()
    if not text:
        raise UserError("type the name of a new file")
    if not is_plain(text):
        raise UserError("a file name cannot have control characters")
    path = Path(text)
    try:
        path = path.expanduser()
        if path.is_dir():
            raise UserError(f"{text} is a folder: type the name of a new file")
        if path.exists() or path.is_symlink():
            raise UserError(f"{text} already exists: type another name")
        if not path.parent.is_dir():
            raise UserError(f"there is no folder {path.parent}")
    except (OSError, RuntimeError, ValueError) as error:
        raise UserError(f"{text}: {getattr(error, 'strerror', None) or error}") from error
    return path


_MOST_TRIED: Final = 1_000


def free_name(stem: str, ending: str, folder: Path = Path(), taken: Container[str] = ()) -> str:
    """Return a file name that is not in use, with a number between `stem` and `ending` if needed.

    Characters other than letters, digits and ``-_.`` become dashes. After a thousand used names, the first
    one is returned. `taken` are further stems to avoid.
    """
    stem = "".join(letter if letter.isalnum() or letter in "-_." else "-" for letter in stem)
    for candidate in (stem, *(f"{stem}-{number}" for number in range(2, _MOST_TRIED))):
        if candidate not in taken and not (folder / f"{candidate}{ending}").exists():
            return f"{candidate}{ending}"
    return f"{stem}{ending}"


# Write over a file, and take away what was not finished


@contextmanager
def whole_file(path: Path) -> Iterator[TextIO]:
    """Open `path` and yield it for writing text over the old content.

    If writing fails, the file is removed, unless it is a device or a link. After any other error the written
    part stays, but an empty file is removed.

    Raises:
        UserError: The file cannot be written.
    """
    begun: os.stat_result | None = None
    try:
        with path.open("w", encoding="utf-8", newline="") as stream:
            begun = os.fstat(stream.fileno())
            try:
                yield stream
            except BaseException:
                if S_ISREG(begun.st_mode) and stream.tell() == 0:
                    _remove(path, begun)
                raise
    except OSError as error:
        if begun is not None:  # a file that was never opened is unchanged
            _remove(path, begun)
        raise _unwritable(path, error) from error


@contextmanager
def file_or_stream(target: Path | TextIO) -> Iterator[TextIO]:
    """Yield `target` for writing. A path is opened immediately, so errors appear before the work.

    A file is handled as in :func:`whole_file`. A stream stays open, and its errors are not converted.
    """
    if isinstance(target, Path):
        with whole_file(target) as stream:
            yield stream
    else:
        yield target


def _remove(path: Path, begun: os.stat_result) -> None:
    with suppress(OSError):
        there = path.lstat()
        if S_ISREG(there.st_mode) and os.path.samestat(there, begun):
            path.unlink()


def _unwritable(path: Path, error: OSError | ValueError) -> UserError:
    reason = getattr(error, "strerror", None) or error
    return UserError(f"{printable(str(path))}: cannot be written ({reason})")
