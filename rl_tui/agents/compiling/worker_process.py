"""The worker process, as seen by the process that has it compile."""

from __future__ import annotations

import json
import os
import threading
from contextlib import suppress
from queue import Empty, SimpleQueue
from typing import IO, Final

from rl_tui.agents.compiling import worker
from rl_tui.agents.compiling.base_folder import base_folder
from rl_tui.agents.kernels.machine_code import Loop
from rl_tui.common.child_process import python_process

IDLE_NICENESS: Final = 19
"""How much lower its priority is once nobody waits."""
GONE: Final = ""
"""In place of an answer, from a worker that has ended."""


class WorkerProcess:
    """A process that compiles into the cache, and ends with this one, however that ends.

    With ``alone`` on it does not wait while another process compiles.

    Raises OSError where no process can be started.
    """

    def __init__(self, *, alone: bool = False) -> None:
        self._process = python_process(
            worker.__name__,
            {"alone": alone},
            os.environ | {"RL_TUI_CACHE_DIR": str(base_folder().absolute())},
            folder=os.path.abspath(os.sep),
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._stdin, stdout = self._process.stdin, self._process.stdout
        self._answers = SimpleQueue[str]()
        reader = threading.Thread(target=self._read, args=(stdout,), name="compiler's answers", daemon=True)
        try:
            reader.start()
        except RuntimeError as error:  # there may be only so many threads
            stdout.close()
            self.end()
            raise OSError(str(error)) from error
        self.is_idle = False
        """Whether it has been told that nobody waits for it."""

    def _read(self, stdout: IO[bytes]) -> None:
        with stdout:
            for line in stdout:
                self._answers.put(line.decode().strip())
        self._answers.put(GONE)

    def ask(self, loop: Loop) -> None:
        """Ask for ``loop``. Raises OSError where the worker has ended."""
        try:
            self._stdin.write(json.dumps(loop).encode() + b"\n")
        except ValueError as error:  # by our hand
            raise BrokenPipeError(str(error)) from error

    def answer(self, seconds: float) -> str | None:
        """Return its next answer, GONE where it has ended; None if there is none within so many seconds."""
        try:
            return self._answers.get(timeout=seconds)
        except Empty:
            return None

    def let_others_go_first(self) -> None:
        """Lower its priority as far as it goes: nobody waits for it any more. Nothing raises it again."""
        self.is_idle = True
        with suppress(AttributeError, OSError):
            os.setpriority(os.PRIO_PROCESS, self._process.pid, IDLE_NICENESS)

    def end(self) -> None:
        """End it, be it in the middle of compiling."""
        self._process.kill()
        with suppress(OSError):
            self._stdin.close()
        self._process.wait()
