"""The worker process, as seen by the process that has it compile."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import IO, Final

import rl_tui
from rl_tui.agents.compiling import worker
from rl_tui.agents.kernels.machine_code import Loop

IDLE_NICENESS: Final = 19
"""How much lower its priority is once nobody waits."""
GONE: Final = ""
"""In place of an answer, from a worker that has ended."""


class WorkerProcess:
    """A process that compiles into the cache.

    It has a session of its own and no terminal, so that no key and no hang-up reaches it, and ends with this
    process, however that ends. Raises OSError where no process can be started.
    """

    def __init__(self) -> None:
        home = str(Path(rl_tui.__file__).parents[1])
        paths = [path for path in (os.environ.get("PYTHONPATH"), home) if path]
        self._process = subprocess.Popen(
            # -P: the folder it is started in is not looked into for modules
            [sys.executable, "-P", "-m", worker.__name__],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
            text=True,
            start_new_session=True,
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._stdin, stdout = self._process.stdin, self._process.stdout
        self._answers = SimpleQueue[str]()
        threading.Thread(target=self._read, args=(stdout,), name="compiler's answers", daemon=True).start()

    def _read(self, stdout: IO[str]) -> None:
        for line in stdout:
            self._answers.put(line.strip())
        self._answers.put(GONE)

    def ask(self, loop: Loop) -> None:
        """Ask for ``loop``. Raises OSError where the worker has ended."""
        self._stdin.write(json.dumps(loop) + "\n")
        self._stdin.flush()

    def answer(self, seconds: float) -> str | None:
        """Return its next answer, GONE where it has ended; None if there is none within so many seconds."""
        try:
            return self._answers.get(timeout=seconds)
        except Empty:
            return None

    def let_others_go_first(self) -> None:
        """Lower its priority as far as it goes: nobody waits for it any more. Nothing raises it again."""
        with suppress(AttributeError, OSError):
            os.setpriority(os.PRIO_PROCESS, self._process.pid, IDLE_NICENESS)

    def end(self) -> None:
        """End it, be it in the middle of compiling."""
        self._process.kill()
        with suppress(OSError):
            self._stdin.close()
        self._process.wait()
