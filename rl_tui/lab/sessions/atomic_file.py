"""Writing a file so that whoever reads it finds the old one or the new one, whole, whatever happens."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import Final

from rl_tui.common.file_lock import OURS_ALONE

# Whoever may write in the folder must not have us write elsewhere by a link in the draft's place
_FLAGS: Final = (
    os.O_WRONLY | os.O_CREAT | os.O_TRUNC | getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0)
)
_NEW: Final = ".new"


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


def drafts_in(folder: Path, suffix: str) -> list[tuple[Path, Path]]:
    """Return the drafts in ``folder``, each after the path, ending in ``suffix``, that it was to replace.

    They are being written, or were when their program was killed.
    """
    try:
        drafts = sorted(folder.glob(f".*{suffix}{_NEW}"))
    except OSError:  # a folder that may not be read
        return []
    return [(draft.with_name(draft.name[1 : -len(_NEW)]), draft) for draft in drafts]


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
