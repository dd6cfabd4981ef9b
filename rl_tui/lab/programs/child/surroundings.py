"""What a script finds around it: no keyboard, no windows, streams that lead to the watching side."""

from __future__ import annotations

import builtins
import fcntl
import os
import pickle
import select
import signal
import sys
import threading
import warnings
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from io import TextIOWrapper
from types import ModuleType
from typing import Any, Final, NoReturn

from rl_tui.common.after_import import after_import

_NO_WINDOW: Final = ".*is non-interactive, and thus cannot be shown"
_INPUT: Final = (
    "input() cannot be answered while rl-tui watches: write the value into the script, or pass it after the "
    "script's name"
)
_NOT_REPEATABLE: Final = "the script starts {}: the same seed need not give the same run"
_OLD_GYM: Final = (
    "the script imports gym, of which rl-tui sees nothing: it watches environments of its successor; "
    "write `import gymnasium as gym`"
)


def end_with(life: int) -> None:
    """Let the system end this process and its group as soon as the other end of the pipe ``life`` is closed.

    That needs neither a thread nor Python's attention: it works while C code computes. On Linux the signal is
    one that a program cannot ignore. Nothing may ever be written to that pipe.
    """
    signal.signal(signal.SIGIO, signal.SIG_DFL)  # which ends a process; whoever started us may ignore it
    fcntl.fcntl(life, fcntl.F_SETOWN, -os.getpgrp())
    if hasattr(fcntl, "F_SETSIG"):
        fcntl.fcntl(life, fcntl.F_SETSIG, signal.SIGKILL)
    fcntl.fcntl(life, fcntl.F_SETFL, fcntl.fcntl(life, fcntl.F_GETFL) | os.O_ASYNC)
    if select.select([life], [], [], 0.0)[0]:  # it is closed already
        os.killpg(0, signal.SIGKILL)


def bound_memory(most: int) -> None:
    """Let the system refuse this process, and each that it starts, more than ``most`` bytes of memory."""
    import resource

    with suppress(OSError, ValueError):
        hard = resource.getrlimit(resource.RLIMIT_AS)[1]
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(resource.RLIMIT_AS, (most, most))


def surround(note: Callable[[str], None]) -> None:
    """Prepare this process for a script; ``note`` tells what had to be done otherwise for it to run."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(encoding="utf-8", errors="backslashreplace", line_buffering=True)
    builtins.input = _refuse_input
    sys.modules.setdefault("pickle5", pickle)  # it was the pickle of Python 3.8, for older ones
    warnings.filterwarnings("ignore", message=_NO_WINDOW)
    _tell_of_workers(note)
    for name, change in {
        "matplotlib": _draw_into_memory,
        "matplotlib.pyplot": _show_nothing,
        "tqdm.notebook": _draw_bars_as_text,
        "gym": lambda _: note(_OLD_GYM),
    }.items():
        after_import(name, change)


def _tell_of_workers(note: Callable[[str], None]) -> None:
    """Tell, once each, when the script starts a thread or forks: no seed makes repeatable when they run."""
    left = {"threads", "processes"}

    def tell(what: str) -> None:
        if what in left and os.getpid() == process:
            left.remove(what)
            note(_NOT_REPEATABLE.format(what))

    def start(thread: threading.Thread) -> None:
        if not thread.daemon:  # those of libraries, which watch over something
            tell("threads")
        start_thread(thread)

    process, start_thread = os.getpid(), threading.Thread.start
    threading.Thread.start = start  # type: ignore[method-assign, assignment]
    os.register_at_fork(before=lambda: tell("processes"))


def _refuse_input(*_: object) -> NoReturn:
    raise RuntimeError(_INPUT)


def _nothing(*_: Any, **__: Any) -> None:
    """Do nothing, in place of what would open a window or wait for one."""


def _draw_into_memory(matplotlib: ModuleType) -> None:
    """Keep scripts from choosing where to draw: without windows that raises."""
    matplotlib.use = _nothing  # type: ignore[attr-defined]


def _show_nothing(pyplot: ModuleType) -> None:
    switch = pyplot.switch_backend
    pyplot.show = pyplot.pause = _nothing  # type: ignore[attr-defined]
    pyplot.switch_backend = lambda *_: switch("agg")  # type: ignore[attr-defined]  # pyplot calls it itself


def _draw_bars_as_text(notebook: ModuleType) -> None:
    """Let bars meant for a notebook, which raise where there is none, be those of a terminal."""
    plain = import_module("tqdm.std")
    for name in ("tqdm", "tqdm_notebook"):
        setattr(notebook, name, plain.tqdm)
    for name in ("trange", "tnrange"):
        setattr(notebook, name, plain.trange)
