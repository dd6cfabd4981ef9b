"""A process that imports the modules of test programs once, and then forks those programs.

:mod:`warm_start` starts it. It has only one thread, because a fork would lose others.
"""

# ruff: noqa: F401

from __future__ import annotations

import atexit
import builtins
import fcntl
import gc
import io
import json
import os
import runpy
import socket
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from importlib.machinery import BuiltinImporter
from types import ModuleType
from typing import Any, Final

LARGEST: Final = 200_000
"""Bytes of a request, which is one datagram."""
MOST_DESCRIPTORS: Final = 32
_ABOVE: Final = 300
"""Programs get no descriptors from this number on."""

Request = dict[str, Any]


class _Ending:
    status: int | None = None

    def leave(self) -> None:
        """Skip Python's own shutdown, which takes a tenth of a second."""
        if self.status is not None:
            for stream in (sys.stdout, sys.stderr):
                with suppress(Exception):
                    stream.flush()
            os._exit(self.status)


def serve(door: socket.socket) -> tuple[Request, list[int]] | None:
    """Fork a process for each request and return the request there, or None once the door is closed."""
    while True:
        message, descriptors, *_ = socket.recv_fds(door, LARGEST, MOST_DESCRIPTORS)
        if not message:
            return None
        held, release = os.pipe()
        reading, writing = os.pipe()
        # The process between ends at once. The program then becomes a child of the process that asked
        between = os.fork()
        if between == 0:
            program = os.fork()
            if program:
                os.write(writing, str(program).encode())
                os._exit(0)
            os.close(release)
            os.read(held, 1)  # until it is adopted
            for each in (held, reading, writing):
                os.close(each)
            door.close()
            return json.loads(message), descriptors
        os.waitpid(between, 0)
        door.send(os.read(reading, 20))
        for each in (held, release, reading, writing, *descriptors):
            os.close(each)


def prepare(request: Request, descriptors: Sequence[int]) -> None:
    if request["session"]:
        os.setsid()
    os.umask(request["umask"])
    os.chdir(request["folder"])
    _place(descriptors, request["descriptors"])
    os.environ.clear()
    os.environ.update(request["environment"])
    time.tzset()
    sys.stdin = sys.__stdin__ = _stream(0, sys.stdin)  # type: ignore[misc]
    sys.stdout = sys.__stdout__ = _stream(1, sys.stdout)  # type: ignore[misc]
    sys.stderr = sys.__stderr__ = _stream(2, sys.stderr)  # type: ignore[misc]
    sys.orig_argv = request["command"]
    if "numpy" in sys.modules:
        sys.modules["numpy"].random.seed()


def _place(descriptors: Sequence[int], numbers: Sequence[int]) -> None:
    """Give ``descriptors`` these ``numbers``, and close all others."""
    high = [fcntl.fcntl(each, fcntl.F_DUPFD, _ABOVE) for each in descriptors]
    os.closerange(0, _ABOVE)
    for each, number in zip(high, numbers, strict=True):
        os.dup2(each, number, inheritable=True)
    os.closerange(_ABOVE, max(high) + 1)


def _stream(number: int, like: Any) -> io.TextIOWrapper:
    mode = "r" if number == 0 else "w"
    is_raw = like.write_through
    binary: Any = open(number, f"{mode}b", 0 if is_raw and number else -1, closefd=False)  # noqa: SIM115
    getattr(binary, "raw", binary).name = f"<{('stdin', 'stdout', 'stderr')[number]}>"
    stream = io.TextIOWrapper(
        binary,
        like.encoding,
        like.errors,
        newline="\n",
        line_buffering=number == 2 or os.isatty(number),
        write_through=is_raw,
    )
    stream.mode = mode  # type: ignore[misc]
    return stream


def run(command: Sequence[str], path: Sequence[str], ending: _Ending) -> None:
    arguments = list(command[1:])
    is_safe = arguments[0] == "-P"
    how, what, *rest = arguments[is_safe:]
    main = ModuleType("__main__")
    main.__dict__.update(__builtins__=builtins, __loader__=BuiltinImporter, __annotations__={})
    sys.modules["__main__"] = main
    sys.argv = [how, *rest]
    sys.path[:] = path if is_safe else [os.getcwd() if how == "-m" else "", *path]
    try:
        if how == "-m":
            runpy._run_module_as_main(what)  # type: ignore[attr-defined]
        else:
            exec(compile(what, "<string>", "exec"), main.__dict__)
        ending.status = 0
    except SystemExit as end:
        if end.code is None or isinstance(end.code, int):
            ending.status = (end.code or 0) & 0xFF
        raise


def import_for_watched_programs() -> None:
    import rl_tui.programs.watched.child.agent
    import rl_tui.programs.watched.child.main


def import_for_ours() -> None:
    """Import all but the compiler cache, whose folder depends on the environment."""
    import gymnasium.envs.classic_control
    import gymnasium.envs.toy_text
    import numba
    import textual.drivers.linux_driver

    import rl_tui.agents.compiling.loops
    import rl_tui.agents.exact.solve
    import rl_tui.commands.main
    import rl_tui.live.player
    import rl_tui.screen.app.app
    import rl_tui.screen.catalogue.catalogue
    import rl_tui.screen.catalogue.lessons
    import rl_tui.screen.playground.playground
    import rl_tui.screen.terminal.driver
    import rl_tui.studies.sweeps.document
    import rl_tui.worlds.gym.section
    import rl_tui.worlds.gym.toy_text

    assert "rl_tui.agents.compiling.machine_cache" not in sys.modules
    numba.njit(lambda number: number + 1)(1.0)  # gets the compiler ready


IMPORTS: Final = {"ours": import_for_ours, "watched": import_for_watched_programs}
"""By kind of program: its import function."""


def begin(door: int, kind: str) -> None:
    ending, path = _Ending(), [each for each in sys.path if each]
    atexit.register(ending.leave)  # callbacks run in reverse order
    IMPORTS[kind]()
    if len(os.listdir("/proc/self/task")) > 1:
        return  # threads do not survive a fork, but their locks do
    gc.collect()
    gc.freeze()  # so that garbage collection copies no memory
    with socket.socket(fileno=door) as listening:
        listening.send(b"ready")
        asked = serve(listening)
    if asked is not None:
        prepare(*asked)
        run(asked[0]["command"], path, ending)


if __name__ == "__main__":
    begin(int(sys.argv[1]), sys.argv[2])
