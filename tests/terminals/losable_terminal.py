"""A terminal that can vanish, or stop reading."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

from pseudo_terminal import DEADLINE, PseudoTerminal

from rl_tui.live.sessions.session import sessions_in

_LOOK_AGAIN: Final = 0.02  # seconds
_RUN = "; os.execvp(sys.argv[1], sys.argv[1:])"
# It is the controlling terminal of its program, as in a window: closing it sends a signal
CONTROLLING: Final = (
    sys.executable,
    "-c",
    f"import fcntl, os, sys, termios; fcntl.ioctl(0, termios.TIOCSCTTY, 0){_RUN}",
)
DEAF: Final = (
    sys.executable,
    "-c",
    f"import os, signal, sys; signal.signal(signal.SIGHUP, signal.SIG_IGN){_RUN}",
)


class LosableTerminal(PseudoTerminal):
    def vanish(self) -> None:
        """Close the far end, like a closed window or a broken link."""
        nothing = os.open(os.devnull, os.O_RDWR)
        os.dup2(nothing, self._ours)
        os.close(nothing)

    def stall(self) -> None:
        """Fill the way to the far end until something is read there."""
        # opened again, because non-blocking mode would apply to the program too
        end = os.open(os.ttyname(self.theirs), os.O_WRONLY | os.O_NOCTTY | os.O_NONBLOCK)
        try:
            while True:
                os.write(end, b"\0" * 256)  # terminals ignore it
        except BlockingIOError:
            return
        finally:
            os.close(end)

    def wait_reading(self, condition: Callable[[], bool], what: str) -> None:
        def holds() -> bool:
            for _ in self.reading(_LOOK_AGAIN):
                pass
            return condition()

        wait_until(holds, what)

    def wait_for_exit(self) -> int:
        return self.process.wait(DEADLINE)


def wait_until(condition: Callable[[], bool], what: str) -> None:
    deadline = time.perf_counter() + DEADLINE
    while not condition():
        assert time.perf_counter() < deadline, what
        time.sleep(_LOOK_AGAIN)


def is_gone(number: int) -> bool:
    """The process has ended, even if its parent has not waited for it."""
    try:
        return Path(f"/proc/{number}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0] == "Z"
    except (FileNotFoundError, ProcessLookupError):
        return True


def kept_step(folder: Path) -> int:
    sessions, _ = sessions_in(folder)
    return sessions[0].step if sessions else 0
