"""Reads every file that a person names: a plain file, of bounded size, never waited for."""

from __future__ import annotations

import errno
import os
import stat
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO, Final

from rl_tui.common.limits import LARGEST_FILE

# Without waiting: to open a pipe would else take until somebody writes into it. The rest: a terminal named
# here does not become ours, programs that are started do not inherit it, and Windows leaves line ends alone
_FLAGS: Final = (
    os.O_RDONLY
    | getattr(os, "O_NONBLOCK", 0)
    | getattr(os, "O_NOCTTY", 0)
    | getattr(os, "O_CLOEXEC", 0)
    | getattr(os, "O_BINARY", 0)
)
_MISSING: Final = (errno.ENOENT, errno.ENOTDIR)
_KINDS: Final = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


class UnreadableError(Exception):
    """The file gives nothing at all; ``place`` is the line and column, if it is one."""

    def __init__(self, place: str, found: str, expected: str) -> None:
        super().__init__(f"found {found}; expected {expected}")
        self.place, self.found, self.expected = place, found, expected


def read_text(path: Path, kind: str = "a TOML file", most: int = LARGEST_FILE) -> str:
    """Return the text of the file, which should be of this ``kind``. Raises UnreadableError."""
    content, _ = read_bytes(path, kind, most)
    try:
        # "sig" because editors on Windows begin a file with a byte order mark
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise UnreadableError(f"line {line}", f"byte {content[error.start]:#04x}", "text in UTF-8") from error


def read_bytes(path: Path, kind: str, most: int = LARGEST_FILE) -> tuple[bytes, os.stat_result]:
    """Return the content of the file, and its status when that was read. Raises UnreadableError.

    Args:
        path: The file, as a person named it.
        kind: What is expected, with an article, such as "a JSON file".
        most: Bytes that it may have.

    """
    stream = open_plain(path, kind)
    with stream:
        try:
            status = os.fstat(stream.fileno())
            content = b"" if status.st_size > most else stream.read(most + 1)
        except OSError as error:
            raise _unreadable(error, kind) from error
    size = max(status.st_size, len(content))  # it may have grown meanwhile
    if size > most:
        raise UnreadableError("", f"{size / 1e6:,.0f} MB", f"{kind} of at most {most / 1e6:,.0f} MB")
    return content, status


def open_plain(path: Path, kind: str) -> BinaryIO:
    """Return the file opened to be read, where it is a plain one. Raises UnreadableError."""
    try:
        descriptor = os.open(path, _FLAGS)
    except (OSError, ValueError) as error:
        with suppress(OSError, ValueError):
            if path.is_dir():  # Windows opens no folder
                raise UnreadableError("", "a folder", kind) from error
        raise _unreadable(error, kind) from error
    try:
        found = _other_kind(os.fstat(descriptor).st_mode)
        if found:
            raise UnreadableError("", found, kind)
        return os.fdopen(descriptor, "rb")
    except BaseException:
        os.close(descriptor)
        raise


def check_plain(path: Path, kind: str) -> None:
    """Raise UnreadableError where there is something at ``path`` that is not a plain file.

    For files that a library opens by their name: nothing is opened here.
    """
    try:
        found = _other_kind(path.stat().st_mode)
    except OSError as error:
        if error.errno in _MISSING:
            return
        raise _unreadable(error, kind) from error
    except ValueError as error:
        raise _unreadable(error, kind) from error
    if found:
        raise UnreadableError("", found, kind)


def _other_kind(mode: int) -> str:
    """Return what has this ``mode``, nothing where it is a plain file."""
    if stat.S_ISREG(mode):
        return ""
    return next((name for is_one, name in _KINDS if is_one(mode)), "something else")


def _unreadable(error: OSError | ValueError, kind: str) -> UnreadableError:
    """Return ``error`` in words; a ValueError is a null character in the path."""
    if isinstance(error, OSError) and error.errno in _MISSING:
        return UnreadableError("", "no such file", kind)
    reason = getattr(error, "strerror", None) or str(error)
    return UnreadableError("", f"a file that cannot be read ({reason})", kind)
