"""Reading of user-named files: regular files of limited size, without blocking."""

from __future__ import annotations

import errno
import os
import stat
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO, Final

from rl_tui.common.errors import NO_FILE, complaint
from rl_tui.common.limits import LARGEST_FILE

# O_NONBLOCK: opening a pipe would wait for a writer. O_NOCTTY: a terminal named here does not become ours.
# O_CLOEXEC: child processes do not inherit the file. O_BINARY: Windows keeps line ends
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
    """A file without usable content. `place` is the line and column, if known."""

    def __init__(self, place: str, found: str, expected: str = "") -> None:
        super().__init__(complaint(found, expected))
        self.place, self.found, self.expected = place, found, expected


def read_text(path: Path, kind: str = "a TOML file", most: int = LARGEST_FILE) -> str:
    """Return the text of a UTF-8 file of at most `most` bytes. `kind` is for messages.

    Raises:
        UnreadableError: The file cannot be read, is too large, or is not UTF-8.
    """
    content, _ = read_bytes(path, kind, most)
    try:
        # editors on Windows start files with a byte order mark, hence "sig"
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise UnreadableError(
            f"line {line}", f"byte {content[error.start]:#04x} is not UTF-8; save the file as UTF-8"
        ) from error


def read_bytes(path: Path, kind: str, most: int = LARGEST_FILE) -> tuple[bytes, os.stat_result]:
    """Return the content of a file, and its status when it was read.

    Raises:
        UnreadableError: The file cannot be read or is larger than `most` bytes.
    """
    stream = open_plain(path, kind)
    with stream:
        try:
            status = os.fstat(stream.fileno())
            content = b"" if status.st_size > most else stream.read(most + 1)
        except OSError as error:
            raise _unreadable(error, kind) from error
    size = max(status.st_size, len(content))  # the file may have grown since
    if size > most:
        raise UnreadableError("", f"{size / 1e6:,.0f} MB", f"{kind} of at most {most / 1e6:,.0f} MB")
    return content, status


def open_plain(path: Path, kind: str) -> BinaryIO:
    """Open a regular file for reading. `kind` is for messages.

    Raises:
        UnreadableError: It is not a regular file, or cannot be opened.
    """
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
    """Check that `path`, which a library will open, is a regular file or does not exist.

    Raises:
        UnreadableError: It is something else.
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
    # Empty for a regular file
    if stat.S_ISREG(mode):
        return ""
    return next((name for is_one, name in _KINDS if is_one(mode)), "something else")


def _unreadable(error: OSError | ValueError, kind: str) -> UnreadableError:
    # A ValueError is a null character in the path
    if isinstance(error, OSError) and error.errno in _MISSING:
        return UnreadableError("", NO_FILE, kind)
    reason = getattr(error, "strerror", None) or str(error)
    return UnreadableError("", f"cannot be read ({reason})")
