"""Files that are written where the user asked for them: wholly, or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from stat import S_ISREG
from typing import TextIO

from rl_tui.common.errors import UserError


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
        raise UserError(f"{path}: cannot be written ({error.strerror or error})") from error


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
