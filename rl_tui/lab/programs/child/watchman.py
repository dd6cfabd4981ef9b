"""What is told of a program that takes no step for a while, or ends without a word."""

from __future__ import annotations

import os
import sys
import threading
import warnings
from time import sleep  # the script may put another one in its place
from typing import Any, Final

from rl_tui.lab.programs.child.channel import Channel
from rl_tui.lab.programs.child.faults import users_place
from rl_tui.lab.programs.child.gate import Gate
from rl_tui.lab.programs.child.recorder import Recorder
from rl_tui.lab.programs.messages import MessageKind

_LOOK: Final = 0.1  # seconds
_SILENT: Final = 10  # looks without a step, after which it is told where the program stands
_FORK: Final = ".*use of fork.. may lead to deadlocks"


class Watchman:
    """A thread beside the program. It writes the steps that the program leaves unwritten.

    Once no step was taken for a second it tells the line where the program stands, each time that is another
    one. It reads nothing of the table: that is the program's own thread's to do.
    """

    def __init__(self, channel: Channel, gate: Gate, recorder: Recorder) -> None:
        self._channel, self._gate, self._recorder = channel, gate, recorder
        self._program = threading.get_ident()

    def begin(self) -> None:
        """Begin to watch the program of the thread that calls this."""
        warnings.filterwarnings("ignore", message=_FORK, category=DeprecationWarning)  # the thread is ours
        threading.Thread(target=self._watch, name="rl-tui", daemon=True).start()

    def _watch(self) -> None:
        count, silent, last_place = -1, 0, None
        while True:
            sleep(_LOOK)
            is_idle = self._recorder.count == count and not self._gate.is_waiting
            count, silent = self._recorder.count, silent + 1 if is_idle else 0
            if self._channel.is_late:
                self._channel.flush(but_last=silent < _SILENT)
            if not silent:
                last_place = None
            if silent and silent % _SILENT == 0:
                place = users_place(sys._current_frames().get(self._program))
                if place is not None and place != last_place:
                    last_place = place
                    self._channel.message(MessageKind.STANDS, file=place[0], line=place[1])


def flush_at_exit(recorder: Recorder) -> None:
    """Let ``os._exit`` tell the last steps before it ends the process."""
    leave, process = os._exit, os.getpid()

    def tell_and_leave(status: int) -> Any:
        try:
            if os.getpid() == process:
                recorder.tell_rest()
        finally:
            leave(status)

    os._exit = tell_and_leave
