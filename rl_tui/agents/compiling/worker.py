"""A process that compiles for another one, and knows nothing but the loops of the catalogue.

On stdin it reads which to compile, each a line of JSON, and answers each with a line on stdout. It ends with
its stdin, and imports nothing of a user's.
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
"""How much lower its priority is while somebody waits."""


def main(*, alone: bool) -> None:
    """Compile what stdin asks for until that ends, be it in the middle of compiling.

    With ``alone`` on it does not wait while another process compiles for the same cache.
    """
    with suppress(AttributeError, OSError):
        os.nice(NICENESS)
    asked = SimpleQueue[str]()
    threading.Thread(target=_read, args=(sys.stdin, asked), daemon=True).start()
    from rl_tui.agents.compiling.loops import compile_alone, compile_in_turn

    # What another process keeps meanwhile, the one that asks reads by itself
    try:
        work(iter(asked.get, ""), sys.stdout, compile_alone if alone else compile_in_turn)
    finally:
        os._exit(1)  # the other thread may hold stdin, which Python's own farewell would want


def _read(stdin: TextIO, asked: SimpleQueue[str]) -> None:
    for line in stdin:
        asked.put(line)
    os._exit(0)


def work(lines: Iterable[str], stdout: TextIO, come_by: Callable[[Loop], CodeOrigin]) -> None:
    """Have ``come_by`` called with the loop of each of ``lines``, and write its outcome to ``stdout``."""
    from rl_tui.agents.kernels.machine_code import Loop

    for line in lines:
        print(come_by(Loop(*json.loads(line))), file=stdout, flush=True)
