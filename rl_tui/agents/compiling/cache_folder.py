"""The folder of machine code, which copies of the program can share."""

from __future__ import annotations

import os
import re
import shutil
import sys
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

from rl_tui.agents.compiling.base_folder import KERNELS, base_folder, closed_to_others
from rl_tui.agents.compiling.cache_key import cache_key
from rl_tui.common.kiosk import in_kiosk

if TYPE_CHECKING:
    from rl_tui.agents.kernels.machine_code import Loop

LONGEST_UNUSED: Final = 30 * 24 * 3600.0
LONGEST_WRITTEN: Final = 3600.0
_OURS: Final = re.compile(r"\d[\w.+]*-[0-9a-f]{16}")


@cache
def cache_folder() -> Path:
    """Return the folder of machine code for this state of the sources, numba and NumPy.

    Numba only checks the file of the compiled function, not of its helpers.
    """
    return base_folder() / KERNELS / cache_key()


@cache
def takes_code() -> bool:
    """Return True if machine code can be stored. A kiosk only reads it."""
    return not in_kiosk() and _writable(cache_folder())


def _writable(folder: Path) -> bool:
    # Its time is updated too
    try:
        with closed_to_others():
            folder.mkdir(parents=True, exist_ok=True)
        probe = folder / f"writable-{os.getpid()}"
        probe.touch()
        probe.unlink()
    except OSError:
        return False
    return True


def note_compiled(loop: Loop) -> None:
    """Record that machine code of `loop` is in the cache, if possible."""
    if takes_code():
        with suppress(OSError):
            _note_of(loop).touch()


def was_compiled(loop: Loop) -> bool:
    """Return True if machine code of `loop` should be in the cache, perhaps for another processor."""
    return _note_of(loop).exists()


def _note_of(loop: Loop) -> Path:
    where = "environment" if loop.stepped else loop.batching.replace(" ", "-") or "table"
    return cache_folder() / ".".join([loop.algorithm, loop.policy, where, sys.implementation.cache_tag or ""])


def remove_unfinished(now: float) -> None:
    """Remove partial files written over an hour before `now`, in seconds."""
    if takes_code():
        for file in (*cache_folder().glob("*/*.tmp.*"), *cache_folder().glob("writable-*")):
            with suppress(OSError):
                if now - file.stat().st_mtime > LONGEST_WRITTEN:
                    file.unlink()


def prune(kernels: Path, current: Path, now: float) -> None:
    """Remove folders unused for thirty days before `now`, in seconds, except `current`."""
    with suppress(OSError):
        for folder in kernels.iterdir():
            is_ours = _OURS.fullmatch(folder.name) and folder.is_dir() and not folder.is_symlink()
            if is_ours and folder != current and now - folder.stat().st_mtime > LONGEST_UNUSED:
                shutil.rmtree(folder, ignore_errors=True)
