"""The entry point of a watched program's process."""

from __future__ import annotations

import builtins
import fcntl
import os
import pickle
import random
import select
import signal
import sys
import threading
import warnings
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from io import TextIOWrapper
from itertools import count
from pathlib import Path
from time import sleep  # the script may put another one in its place
from types import ModuleType
from typing import Any, Final, NoReturn

import numpy as np

from rl_tui.common.after_import import after_import
from rl_tui.programs.watched.child.boxes.box_worlds import BoxWorlds
from rl_tui.programs.watched.child.channel import Channel, Gate
from rl_tui.programs.watched.child.environments.making import Making
from rl_tui.programs.watched.child.errors import described, users_place, watch_file
from rl_tui.programs.watched.child.old_gym.modules import offer_old_gym
from rl_tui.programs.watched.child.recorder import Recorder
from rl_tui.programs.watched.child.removed_names import give_back_conversions, give_back_removed_names
from rl_tui.programs.watched.child.script import read_script, run_script
from rl_tui.programs.watched.child.stand_ins import stand_in
from rl_tui.programs.watched.child.worlds.functions import watch_functions
from rl_tui.programs.watched.child.worlds.own_worlds import OwnWorlds
from rl_tui.programs.watched.child.worlds.windows import offer_windows
from rl_tui.programs.watched.messages import MessageKind

assert sys.platform != "win32"  # for mypy, which skips the rest there

# Seeds of all random generators


def _seed_all(seed: int) -> None:
    random.seed(seed)
    np.random.seed(seed % 2**32)
    original, made = np.random.default_rng, count(1)

    def default_rng(seed_given: Any = None) -> np.random.Generator:
        return original([seed, next(made)] if seed_given is None else seed_given)

    np.random.default_rng = default_rng  # type: ignore[assignment]


# Input, windows and limits


_NO_WINDOW: Final = ".*is non-interactive, and thus cannot be shown"
_INPUT: Final = (
    "input() does not work while rl-tui watches: write the value into the script, or pass it after the "
    "script's name"
)
_NOT_REPEATABLE: Final = "the script starts {}, so the same seed may give another run"


def end_with(life: int) -> None:
    """Let the system kill this process group when the other end of the pipe `life` is closed.

    It needs no thread, and works during C code. On Linux the signal cannot be ignored. Nothing may ever be
    written to the pipe.
    """
    signal.signal(signal.SIGIO, signal.SIG_DFL)  # it ends the process, even if the parent ignored it
    fcntl.fcntl(life, fcntl.F_SETOWN, -os.getpgrp())
    if hasattr(fcntl, "F_SETSIG"):
        fcntl.fcntl(life, fcntl.F_SETSIG, signal.SIGKILL)
    fcntl.fcntl(life, fcntl.F_SETFL, fcntl.fcntl(life, fcntl.F_GETFL) | os.O_ASYNC)
    if select.select([life], [], [], 0.0)[0]:  # already closed
        os.killpg(0, signal.SIGKILL)


def _bound_memory(most: int) -> None:
    import resource

    with suppress(OSError, ValueError):
        hard = resource.getrlimit(resource.RLIMIT_AS)[1]
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(resource.RLIMIT_AS, (most, most))


def _surround(note: Callable[[str], None]) -> None:
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(encoding="utf-8", errors="backslashreplace", line_buffering=True)
    builtins.input = _refuse_input
    for name in ("pickle5", "cPickle"):  # of older versions
        sys.modules.setdefault(name, pickle)
    warnings.filterwarnings("ignore", message=_NO_WINDOW)
    _tell_of_workers(note)
    for name, change in {
        "matplotlib": _draw_into_memory,
        "matplotlib.pyplot": _show_nothing,
        "tqdm.notebook": _draw_bars_as_text,
        "pygame.time": _wait_for_nothing,
    }.items():
        after_import(name, change)


def _tell_of_workers(note: Callable[[str], None]) -> None:
    """Report a thread or fork once, because their order is not reproducible."""
    left = {"threads", "processes"}

    def tell(what: str) -> None:
        if what in left and os.getpid() == process:
            left.remove(what)
            note(_NOT_REPEATABLE.format(what))

    def start(thread: threading.Thread) -> None:
        if not thread.daemon:  # libraries use daemons to watch something
            tell("threads")
        start_thread(thread)

    process, start_thread = os.getpid(), threading.Thread.start
    threading.Thread.start = start  # type: ignore[method-assign, assignment]
    os.register_at_fork(before=lambda: tell("processes"))


def _refuse_input(*_: object) -> NoReturn:
    raise RuntimeError(_INPUT)


def _nothing(*_: Any, **__: Any) -> None: ...


def _draw_into_memory(matplotlib: ModuleType) -> None:
    """Ignore the choice of a backend, which would fail without windows."""
    matplotlib.use = _nothing  # type: ignore[attr-defined]


def _show_nothing(pyplot: ModuleType) -> None:
    switch = pyplot.switch_backend
    pyplot.show = pyplot.pause = _nothing  # type: ignore[attr-defined]
    pyplot.switch_backend = lambda *_: switch("agg")  # type: ignore[attr-defined]  # pyplot calls it itself


def _wait_for_nothing(pygame_time: ModuleType) -> None:
    class Clock:
        def tick(self, *_: float) -> int:
            return 1

        tick_busy_loop = get_time = get_rawtime = tick

        def get_fps(self) -> float:
            return 60.0

    pygame_time.Clock = Clock  # type: ignore[attr-defined]
    pygame_time.wait = pygame_time.delay = lambda milliseconds: milliseconds  # type: ignore[attr-defined]


def _draw_bars_as_text(notebook: ModuleType) -> None:
    plain = import_module("tqdm.std")
    for name in ("tqdm", "tqdm_notebook"):
        setattr(notebook, name, plain.tqdm)
    for name in ("trange", "tnrange"):
        setattr(notebook, name, plain.trange)


# Silence and sudden ends


_LOOK: Final = 0.1  # seconds
_SILENT: Final = 10  # checks without a step before the position is reported
_FORK: Final = ".*use of fork.. may lead to deadlocks"


def _watch_beside(channel: Channel, gate: Gate, recorder: Recorder) -> None:
    """Start a thread next to the program, which writes pending steps.

    After a second without a step it reports the program's current line, once. It does not read the table,
    which only the program's own thread may do.
    """
    program = threading.get_ident()

    def watch() -> None:
        count, silent, last_place = -1, 0, None
        while True:
            sleep(_LOOK)
            is_idle = recorder.count == count and not gate.is_waiting
            count, silent = recorder.count, silent + 1 if is_idle else 0
            if channel.is_late:
                channel.flush(but_last=silent < _SILENT)
            if not silent:
                last_place = None
            if silent and silent % _SILENT == 0:
                place = users_place(sys._current_frames().get(program))
                if place is not None and place != last_place:
                    last_place = place
                    channel.message(MessageKind.STANDS, file=place[0], line=place[1])

    warnings.filterwarnings("ignore", message=_FORK, category=DeprecationWarning)  # the thread is ours
    threading.Thread(target=watch, name="rl-tui", daemon=True).start()


def _flush_at_exit(recorder: Recorder) -> None:
    """Let `os._exit` report the last steps first."""
    leave, process = os._exit, os.getpid()

    def tell_and_leave(status: int) -> Any:
        try:
            if os.getpid() == process:
                recorder.tell_rest()
        finally:
            leave(status)

    os._exit = tell_and_leave


# Entry point


def main(said: dict[str, Any]) -> None:
    """Run the program described by `said` to its end."""
    channel = Channel(said["reports"])
    gate = Gate(channel, said["asked"], said["shared"])
    recorder, note = Recorder(channel, gate, most=said["steps"], wanted=said["table"]), channel.note
    end_with(said["life"])
    if said["memory"] is not None:
        _bound_memory(said["memory"])
    _surround(note)
    give_back_removed_names(note)
    stand_in(note)
    offer_windows(note)
    making = Making(recorder, said["seed"])
    making.install()
    offer_old_gym(making)
    own_worlds = OwnWorlds(making)
    own_worlds.install()
    boxes = BoxWorlds(making, own_worlds.has_steps)
    boxes.install()
    own_worlds.may_take_over = boxes.table_steps.take_over
    _seed_all(said["seed"])
    _flush_at_exit(recorder)
    _watch_beside(channel, gate, recorder)
    channel.message(MessageKind.STARTED)
    path = Path(said["path"])
    watch_file(path)
    try:
        if said["agent"] is None:
            script = read_script(path)
            give_back_conversions(script.tree, note)
            boxes.sites.add_calls(script)
            watch_functions(script.tree, own_worlds)
            run_script(script, said["arguments"], note)
        else:
            from rl_tui.programs.watched.child.agent import run_agent

            run_agent(said, channel.message)
        own_worlds.finish()
        boxes.finish()
        making.tell_what_was_missed()
    except BaseException as error:
        boxes.finish()
        channel.message(MessageKind.ERROR, **described(error))
    recorder.end()
