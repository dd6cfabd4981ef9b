"""The folder of what is cached, and whether others can write to it.

The cache of machine code holds pickles: whoever can write there can run code in every process that reads
them. So a folder that others can write to is left out.
"""

from __future__ import annotations

import os
import stat
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

VARIABLE: Final = "RL_TUI_CACHE_DIR"
KERNELS: Final = "kernels"
"""The folder in it that holds machine code."""
_OTHERS: Final = stat.S_IWGRP | stat.S_IWOTH
_UMASK: Final = threading.Lock()


def base_folder() -> Path:
    """Return the folder of what is cached: that of RL_TUI_CACHE_DIR, else the platform's for this user.

    One that others can write to is passed over. Where none is left it is the null device, in which no folder
    can be made.
    """
    chosen = os.environ.get(VARIABLE)
    if chosen and not _why_passed_over(Path(chosen)):
        return Path(os.path.realpath(chosen))
    own = _own_folder()
    return Path(os.devnull) if _why_passed_over(own) else Path(os.path.realpath(own))


def refusals() -> Iterator[str]:
    """Yield, for each folder that is passed over, a sentence that says why and how to change that."""
    chosen = os.environ.get(VARIABLE)
    if chosen:
        why = _why_passed_over(Path(chosen))
        if not why:
            return
        yield f"{VARIABLE}={chosen} is left out: {why}"
    own = _own_folder()
    why = _why_passed_over(own)
    if why:
        yield f"{own}: machine code is not kept there: {why}"


def _why_passed_over(base: Path) -> str:
    return "" if base == Path(os.devnull) else why_unsafe(base) or why_unsafe(base / KERNELS)


def why_unsafe(folder: Path) -> str:
    """Return why others could change what is in ``folder``, and what to do; nothing where they cannot.

    Neither it nor a folder above it may belong to anybody but us and root, or be writable for others. Above
    it the sticky bit, as of /tmp, will do: there nobody can take away what is ours. What is not there yet
    does not count. Windows keeps others away by other means, which are not looked at.
    """
    if os.name != "posix":
        return ""
    place = os.path.realpath(folder)
    parts = [place]
    while os.path.dirname(parts[-1]) != parts[-1]:
        parts.append(os.path.dirname(parts[-1]))
    for part in reversed(parts):
        try:
            status = os.stat(part)
        except OSError:  # not there, or out of reach: then nothing in it can be read either
            return ""
        why = why_others_can_write(status, is_above=part != place)
        if why:
            return why.format(part)
    return ""


def why_others_can_write(status: os.stat_result, *, is_above: bool = False) -> str:
    """Return why somebody else can change what has this ``status``, ``{}`` in place of its path; or nothing.

    The group of the same name as the owner, which has no other member, is the owner.
    """
    if status.st_uid not in (0, os.geteuid()):
        return "{} belongs to another user; choose a folder of your own or of root"
    if is_above and status.st_mode & stat.S_ISVTX:
        return ""
    if status.st_mode & stat.S_IWOTH:
        return "anybody can write to {0}; run chmod -R go-w {0}"
    if status.st_mode & stat.S_IWGRP and not _is_private(status.st_gid, status.st_uid):
        return "its group can write to {0}; run chmod -R go-w {0}"
    return ""


def _is_private(group: int, owner: int) -> bool:
    import grp
    import pwd

    try:
        name, entry = pwd.getpwuid(owner).pw_name, grp.getgrgid(group)
    except KeyError:
        return False
    return entry.gr_name == name and set(entry.gr_mem) <= {name}


@contextmanager
def closed_to_others() -> Iterator[None]:
    """Let nobody else write to what is made meanwhile, whatever the umask says; one thread at a time."""
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
    except RuntimeError:  # there is no home
        return Path(os.devnull)
