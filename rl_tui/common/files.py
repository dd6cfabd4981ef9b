"""Safe files: locks between programs, and three ways to write none of which leaves half a file.

:func:`write_atomically` replaces a file, and until then leaves the old one as it is. :func:`new_file` begins
one and refuses a name that is taken. :func:`whole_file` writes over what is there and takes away what cannot
be written to its end.
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


# Replace a file, or leave the old one


# Whoever may write in the folder must not have us write elsewhere by a link in the draft's place
_FLAGS: Final = (
    os.O_WRONLY | os.O_CREAT | os.O_TRUNC | getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0)
)
_NEW: Final = ".new"
_LONGEST_WRITE: Final = 60.0  # seconds, by far


def write_atomically(path: Path, content: bytes, mode: int = OURS_ALONE) -> None:
    """Put ``content`` into ``path``, in place of what was there; on the disk once this returns.

    ``mode`` says who may read and write it, as far as the system lets new files be so. Raises OSError, which
    names a file, and then the old one is as it was.
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
        # a full disk does not say which one it is
        raise OSError(error.errno, error.strerror, error.filename or str(path)) from error
    _settle(path.parent)


def draft_of(path: Path) -> Path:
    """Return where the next content of ``path`` is written: one place, so that none is left to pile up."""
    return path.with_name(f".{path.name}{_NEW}")


def remove_old_drafts(folder: Path, suffix: str) -> None:
    """Remove the drafts in ``folder`` that programs left which were killed while they wrote.

    ``suffix`` ends the names of the files that they were to replace.
    """
    try:
        drafts = list(folder.glob(f".*{suffix}{_NEW}"))
    except OSError:  # a folder that may not be read
        return
    for draft in drafts:
        lock = FileLock(draft.with_name(draft.name[1 : -len(_NEW)]))
        with suppress(OSError):
            # on file systems without locks its age alone tells it from one that is being written
            if lock.acquire() and time.time() - draft.stat().st_mtime > _LONGEST_WRITE:
                draft.unlink()
        lock.release()


def remove_with_draft(path: Path) -> None:
    """Remove ``path`` and its draft, where they are there. Raises OSError."""
    for each in (path, draft_of(path)):
        each.unlink(missing_ok=True)


def _settle(folder: Path) -> None:
    """Bring the name itself to the disk, where the system lets a folder be opened."""
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def signature(status: os.stat_result) -> tuple[int, ...]:
    """Return what changes whenever somebody writes a file."""
    return status.st_ino, status.st_mtime_ns, status.st_size


# Begin a new file, or refuse


@contextmanager
def new_file(path: Path) -> Iterator[TextIO]:
    """Yield the new file ``path``, opened to write text; it is removed where writing is broken off.

    Raises UserError, in a line, where it is there already or cannot be written.
    """
    try:
        stream = path.open("x", encoding="utf-8", newline="")
    except FileExistsError as error:
        raise UserError(f'"{printable(str(path))}" is there already: choose another name') from error
    except (OSError, ValueError) as error:  # ValueError: no file can have such a name
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
    """Write ``text`` into the new file ``path``. Raises UserError as :func:`new_file` does."""
    with new_file(path) as stream:
        stream.write(text)


def new_path(text: str) -> Path:
    """Return the path that a person typed as ``text``; ``~`` is their home.

    Raises UserError, in a line, where no new file can be made there: it is there already, or its folder is
    not.
    """
    text = text.strip()
    if not text:
        raise UserError("type the name of a new file")
    if not is_plain(text):
        raise UserError("a file name has no control characters")
    path = Path(text)
    try:
        path = path.expanduser()
        if path.is_dir():
            raise UserError(f"{text} is a folder: type the name of a new file")
        if path.exists() or path.is_symlink():
            raise UserError(f"{text} is there already: type another name")
        if not path.parent.is_dir():
            raise UserError(f"there is no folder {path.parent}")
    except (OSError, RuntimeError, ValueError) as error:
        raise UserError(f"{text}: {getattr(error, 'strerror', None) or error}") from error
    return path


_MOST_TRIED: Final = 1_000


def free_name(stem: str, ending: str, folder: Path = Path(), taken: Container[str] = ()) -> str:
    """Return a name that no file in ``folder`` has: ``stem`` and ``ending``, else with a number between them.

    Of ``stem`` only letters, digits and ``-_.`` are kept, the rest become dashes. ``taken`` are further stems
    to avoid. Once a thousand names are in use it is the first one after all.
    """
    stem = "".join(letter if letter.isalnum() or letter in "-_." else "-" for letter in stem)
    for candidate in (stem, *(f"{stem}-{number}" for number in range(2, _MOST_TRIED))):
        if candidate not in taken and not (folder / f"{candidate}{ending}").exists():
            return f"{candidate}{ending}"
    return f"{stem}{ending}"


# Write over a file, and take away what was not finished


@contextmanager
def whole_file(path: Path) -> Iterator[TextIO]:
    """Yield the file ``path``, opened to write text in place of what was there.

    Where it cannot be written to its end it is removed, unless it is a device or reached by a link, and
    UserError is raised; whatever else fails, what was written is kept, and a file with nothing in it removed.
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
        if begun is not None:  # what could not be opened is as it was
            _remove(path, begun)
        raise _unwritable(path, error) from error


@contextmanager
def file_or_stream(target: Path | TextIO) -> Iterator[TextIO]:
    """Yield ``target``, opened if it is a path: that it cannot be written shows before there is anything.

    A file is kept or removed as :func:`whole_file` does. A stream stays open, and its errors are its own.
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
