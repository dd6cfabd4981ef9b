"""Machine code for runs that are short, but many: it is had once they have taken long enough in all."""

from __future__ import annotations

import threading
from collections import defaultdict
from typing import Final

from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.agents.compiling.cache_folder import was_compiled
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS, Loop

# To rent until it costs as much as to buy is never worse than twice the best that can be done
WORTH_READING: Final = 0.3
WORTH_COMPILING: Final = 2.0


class MachineCodeDemand:
    """Adds up for how long each loop ran interpreted, whichever run it was, and gets machine code in time.

    What is in the cache is read by the thread that asks; what is not is compiled beside the runs. Safe to be
    called from several threads.
    """

    def __init__(self) -> None:
        self._seconds: defaultdict[Loop, float] = defaultdict(float)
        self._compiled = list[Loop]()
        self._read = set[Loop]()
        self._lock = threading.Lock()

    def ran(self, loop: Loop, seconds: float) -> None:
        """Note that ``loop`` ran interpreted for so many ``seconds``, and get its machine code if due."""
        if loop in COMPILED_LOOPS or loop in BACKGROUND.failed:
            return
        with self._lock:
            self._seconds[loop] += seconds
            if self._seconds[loop] >= WORTH_READING and loop not in self._read and was_compiled(loop):
                self._read.add(loop)
                if BACKGROUND.read(loop):
                    return
            if self._seconds[loop] >= WORTH_COMPILING and loop not in self._compiled:
                self._compiled.append(loop)
                BACKGROUND.want(self._compiled)


DEMAND: Final = MachineCodeDemand()
"""The one of this process."""
