"""A worker process that compiles loops for another process.

It reads requests from stdin as lines of JSON, and answers each with a line on stdout. It ends with its stdin
and imports no user code.
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
    """Compile requests from stdin until it closes, which also interrupts compiling.

    Args:
        alone: True to compile without waiting for other processes.
    """
    with suppress(AttributeError, OSError):
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
    """Call `come_by` with the loop in each of `lines`, and write its result to `stdout`."""
    from rl_tui.agents.kernels.machine_code import Loop

    for line in lines:
        print(come_by(Loop(*json.loads(line))), file=stdout, flush=True)
