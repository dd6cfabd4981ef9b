"""A watched program as a process, seen from the side that watches."""

from __future__ import annotations

import json
import mmap
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from select import select
from typing import Any, Final

from rl_tui.lab.programs.messages import HEADER, LARGEST_FRAME, NO_LIMIT

_CHUNK: Final = 1 << 20


@dataclass(frozen=True, slots=True)
class ProgramRequest:
    """What to run: a script, or an agent without a loop.

    ``agent`` is the class or function in ``path`` that is an agent (empty: the only one), None where ``path``
    is a script with a loop of its own. An agent learns in ``scenario`` for ``episodes``. ``hyperparameters``
    are given to its constructor by name. ``steps`` ends the program after so many.
    """

    path: Path
    arguments: tuple[str, ...] = ()
    seed: int = 0
    steps: int | None = None
    table: str | None = None
    agent: str | None = None
    scenario: str = ""
    episodes: int | None = None
    hyperparameters: Mapping[str, float] | None = None


class ProgramProcess:
    """The process of ``request``, in a session of its own, which ends with :meth:`end`.

    It may take ``allowed`` steps at first. Raises OSError where no process can be started.
    """

    def __init__(self, request: ProgramRequest, allowed: int = NO_LIMIT) -> None:
        with tempfile.TemporaryFile() as shared:
            shared.truncate(mmap.PAGESIZE)
            self._shared = mmap.mmap(shared.fileno(), mmap.PAGESIZE)
            self._allowed = memoryview(self._shared).cast("q")
            self._allowed[0] = allowed
            reading, told = os.pipe()
            asked, self._asking = os.pipe()
            said = {
                "path": str(request.path),
                "arguments": list(request.arguments),
                "seed": request.seed,
                "steps": request.steps,
                "table": request.table,
                "agent": request.agent,
                "scenario": request.scenario,
                "episodes": request.episodes,
                "hyperparameters": dict(request.hyperparameters or {}),
                "told": told,
                "asked": asked,
                "shared": shared.fileno(),
            }
            script = (
                f"import sys; sys.path[:] = {[each for each in sys.path if each]!r}\n"
                f"from rl_tui.lab.programs.child.main import main; main({said!r})"
            )
            try:
                self._process = subprocess.Popen(
                    [sys.executable, "-c", script],
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                    env=os.environ | {"PYTHONHASHSEED": "0", "MPLBACKEND": "Agg", "SDL_VIDEODRIVER": "dummy"},
                    pass_fds=(told, asked, shared.fileno()),
                    start_new_session=True,
                )
            finally:
                os.close(told)
                os.close(asked)
        self._reading = reading
        self._bytes = bytearray()
        self.closed = False
        """Whether its pipe is closed: nothing more will come."""

    def allow(self, steps: int) -> None:
        """Let it take steps until it has taken ``steps`` in all; 0 holds it at its next step."""
        self._allowed[0] = steps
        self.ask({})

    def ask(self, what: Mapping[str, Any]) -> None:
        """Tell it something, which it hears when it waits."""
        with suppress(OSError):
            os.write(self._asking, json.dumps(what).encode() + b"\n")

    def frames(self, seconds: float | None = 0.0) -> Iterator[tuple[bytes, bytes]]:
        """Yield what has come, waiting for at most ``seconds`` (None: for as long as it takes)."""
        if not self.closed and select([self._reading], [], [], seconds)[0]:
            chunk = os.read(self._reading, _CHUNK)
            self.closed = not chunk
            self._bytes += chunk
        while len(self._bytes) >= HEADER.size:
            letter, length = HEADER.unpack_from(self._bytes)
            if length > LARGEST_FRAME:
                self.closed = True
                return
            if len(self._bytes) < HEADER.size + length:
                return
            payload = bytes(self._bytes[HEADER.size : HEADER.size + length])
            del self._bytes[: HEADER.size + length]
            yield letter, payload

    def end(self) -> None:
        """End it and all that it started."""
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        for descriptor in (self._reading, self._asking):
            with suppress(OSError):
                os.close(descriptor)
        self.closed = True

    @property
    def exit_status(self) -> int | None:
        """How it ended, None while it has not."""
        return self._process.poll()
