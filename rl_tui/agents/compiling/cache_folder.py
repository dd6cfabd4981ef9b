"""The folder of machine code on disk, which clones of the program and its images can share."""

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
    """Return the folder of machine code, one for each state of what the code comes from, numba and NumPy.

    Numba itself only watches the file of the function it compiles, so that an edited helper in another file
    would leave stale code behind. Within the folder it keeps machine code for other processors and other
    versions of Python apart.
    """
    return base_folder() / KERNELS / cache_key()


@cache
def takes_code() -> bool:
    """Return whether machine code can be kept. A kiosk keeps none: what it reads was compiled before."""
    return not in_kiosk() and _writable(cache_folder())


def _writable(folder: Path) -> bool:
    """Tell whether ``folder``, made where it is missing, can be written; its time is then that of now."""
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
    """Note that machine code of ``loop`` is in the cache, where that can be written."""
    if takes_code():
        with suppress(OSError):
            _note_of(loop).touch()


def was_compiled(loop: Loop) -> bool:
    """Return whether machine code of ``loop`` ought to be in the cache, though perhaps for another processor.

    It is told without numba, in no time.
    """
    return _note_of(loop).exists()


def _note_of(loop: Loop) -> Path:
    where = "environment" if loop.stepped else loop.batching.replace(" ", "-") or "table"
    return cache_folder() / ".".join([loop.algorithm, loop.policy, where, sys.implementation.cache_tag or ""])


def remove_unfinished(now: float) -> None:
    """Remove what killed processes had begun to write into the cache more than an hour before ``now``.

    ``now`` is in seconds, as file systems count.
    """
    if takes_code():
        for file in (*cache_folder().glob("*/*.tmp.*"), *cache_folder().glob("writable-*")):
            with suppress(OSError):
                if now - file.stat().st_mtime > LONGEST_WRITTEN:
                    file.unlink()


def prune(kernels: Path, current: Path, now: float) -> None:
    """Remove the folders in ``kernels`` that no program has started from for thirty days, but ``current``.

    ``now`` is in seconds, as file systems count. A program that runs on an old one for longer has its code in
    memory, and compiles what else it needs.
    """
    with suppress(OSError):
        for folder in kernels.iterdir():
            is_ours = _OURS.fullmatch(folder.name) and folder.is_dir() and not folder.is_symlink()
            if is_ours and folder != current and now - folder.stat().st_mtime > LONGEST_UNUSED:
                shutil.rmtree(folder, ignore_errors=True)
