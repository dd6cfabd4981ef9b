"""A worker process that compiles loops for another process, without user code.

It answers each line of JSON on stdin with a line on stdout, and ends with its stdin.
"""

from __future__ import annotations

import json
import os
import sys
import threading
from collections.abc import Callable, Iterable
from contextlib import suppress
from queue import SimpleQueue
from typing import TYPE_CHECKING, Final, TextIO

if TYPE_CHECKING:
    from rl_tui.agents.compiling.loops import CodeOrigin
    from rl_tui.agents.kernels.machine_code import Loop

NICENESS: Final = 5
"""Niceness of the worker while its result is needed."""


def main(*, alone: bool) -> None:
    """Compile requests until stdin closes, which also interrupts compiling.

    A worker that is `alone` does not wait for other processes.
    """
    if sys.platform != "win32":
        with suppress(OSError):
            os.nice(NICENESS)
    asked = SimpleQueue[str]()
    threading.Thread(target=_read, args=(sys.stdin, asked), daemon=True).start()
    from rl_tui.agents.compiling.loops import compile_alone, compile_in_turn

    # The asking process itself reads what others store meanwhile
    try:
        work(iter(asked.get, ""), sys.stdout, compile_alone if alone else compile_in_turn)
    finally:
        os._exit(1)  # the other thread may hold stdin, which Python's shutdown needs


def _read(stdin: TextIO, asked: SimpleQueue[str]) -> None:
    for line in stdin:
        asked.put(line)
    os._exit(0)


def work(lines: Iterable[str], stdout: TextIO, come_by: Callable[[Loop], CodeOrigin]) -> None:
    """Write the result of `come_by` for each line to `stdout`."""
    from rl_tui.agents.kernels.machine_code import Loop

    for line in lines:
        print(come_by(Loop(*json.loads(line))), file=stdout, flush=True)
