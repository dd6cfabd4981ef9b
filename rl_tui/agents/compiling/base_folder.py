"""The cache folder, and the check that other users cannot write to it.

It contains pickles: anyone with write access can run code in every process that reads it.
"""

from __future__ import annotations

import os
import stat
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

VARIABLE: Final = "RL_TUI_CACHE_DIR"
KERNELS: Final = "kernels"
"""Subfolder for machine code."""
_OTHERS: Final = stat.S_IWGRP | stat.S_IWOTH
_UMASK: Final = threading.Lock()


def base_folder() -> Path:
    """Return the cache folder: RL_TUI_CACHE_DIR, or the platform's folder for this user.

    Unsafe folders are skipped. The last resort is the null device.
    """
    chosen = os.environ.get(VARIABLE)
    if chosen and not _why_passed_over(Path(chosen)):
        return Path(os.path.realpath(chosen))
    own = _own_folder()
    return Path(os.devnull) if _why_passed_over(own) else Path(os.path.realpath(own))


def refusals() -> Iterator[str]:
    """Yield the reason and the fix for each skipped folder."""
    chosen = os.environ.get(VARIABLE)
    if chosen:
        why = _why_passed_over(Path(chosen))
        if not why:
            return
        yield f"{VARIABLE}={chosen} is ignored: {why}"
    own = _own_folder()
    why = _why_passed_over(own)
    if why:
        yield f"{own}: machine code is not saved there: {why}"


def _why_passed_over(base: Path) -> str:
    return "" if base == Path(os.devnull) else why_unsafe(base) or why_unsafe(base / KERNELS)


def why_unsafe(folder: Path) -> str:
    """Return why other users could change files in `folder`, and the fix. Empty if they cannot.

    The folder and all folders above must belong to this user or root, and must not be writable for others.
    Above it, a sticky bit as in /tmp is enough. Missing folders are ignored.
    """
    place = os.path.realpath(folder)
    parts = [place]
    while os.path.dirname(parts[-1]) != parts[-1]:
        parts.append(os.path.dirname(parts[-1]))
    for part in reversed(parts):
        try:
            status = os.stat(part)
        except OSError:  # missing or inaccessible, so nothing in it can be read
            return ""
        why = why_others_can_write(status, is_above=part != place)
        if why:
            return why.format(part)
    return ""


def why_others_can_write(status: os.stat_result, *, is_above: bool = False) -> str:
    """Return why another user can change something with this `status`, with ``{}`` for the path.

    On Windows nothing is checked. A group that contains only the owner counts as the owner. Folders above the
    cache are `is_above`.
    """
    if sys.platform == "win32":
        return ""
    if status.st_uid not in (0, os.geteuid()):
        return "{} belongs to another user; choose a folder of your own or of root"
    if is_above and status.st_mode & stat.S_ISVTX:
        return ""
    if status.st_mode & stat.S_IWOTH:
        return "all users can write to {0}; run chmod -R go-w {0}"
    if status.st_mode & stat.S_IWGRP and not _is_private(status.st_gid, status.st_uid):
        return "its group can write to {0}; run chmod -R go-w {0}"
    return ""


def _is_private(group: int, owner: int) -> bool:
    if sys.platform == "win32":
        return False
    import grp
    import pwd

    try:
        name, entry = pwd.getpwuid(owner).pw_name, grp.getgrgid(group)
    except KeyError:
        return False
    return entry.gr_name == name and set(entry.gr_mem) <= {name}


@contextmanager
def closed_to_others() -> Iterator[None]:
    """Create files closed to others, whatever the umask. One thread at a time."""
    with _UMASK:
        before = os.umask(_OTHERS)
        os.umask(before | _OTHERS)
        try:
            yield
        finally:
            os.umask(before)


def _own_folder() -> Path:
    import platformdirs

    try:
        return platformdirs.user_cache_path("rl-tui", appauthor=False)
    except RuntimeError:  # no home folder
        return Path(os.devnull)
