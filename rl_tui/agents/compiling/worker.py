"""A process that compiles for another one: ``python -m rl_tui.agents.compiling.worker``.

On stdin it reads which loops to compile, each a line of JSON, and answers each with a line on stdout. It
knows the loops of the catalogue and imports nothing of a user's. It ends with its stdin.
"""

from __future__ import annotations

import json
import os
import sys
import threading
from collections.abc import Iterable
from contextlib import suppress
from queue import SimpleQueue
from typing import Final, TextIO

COMPILED: Final = "compiled"
"""The answer once machine code is in the cache."""
NICENESS: Final = 5
"""How much lower its priority is while somebody waits."""


def main() -> None:
    """Compile what stdin asks for until that ends, be it in the middle of compiling."""
    with suppress(AttributeError, OSError):
        os.nice(NICENESS)
    asked = SimpleQueue[str]()
    threading.Thread(target=_read, args=(sys.stdin, asked), daemon=True).start()
    work(iter(asked.get, ""), sys.stdout)


def _read(stdin: TextIO, asked: SimpleQueue[str]) -> None:
    for line in stdin:
        asked.put(line)
    os._exit(0)


def work(lines: Iterable[str], stdout: TextIO) -> None:
    """Compile the loop of each of ``lines`` and answer it on ``stdout``."""
    for line in lines:
        from rl_tui.agents.compiling.loops import compile_here
        from rl_tui.agents.kernels.machine_code import Loop

        compile_here(Loop(*json.loads(line)))
        print(COMPILED, file=stdout, flush=True)


if __name__ == "__main__":
    main()
