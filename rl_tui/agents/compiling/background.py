"""Machine code for this process while its runs go on interpreted."""

from __future__ import annotations

import threading
from collections.abc import Iterable
from contextlib import suppress

from rl_tui.agents.compiling.worker import COMPILED
from rl_tui.agents.compiling.worker_process import GONE, WorkerProcess
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS, Loop


class BackgroundCompiler:
    """Comes by machine code in a thread of its own, which lives as long as there is something to do.

    What is in the cache is read from there. What is not is compiled by a worker process, one for all loops.
    Where there can be none, or it fails, this process compiles, and is slower meanwhile; so it does where the
    cache cannot be written, since nothing would come of a worker's work.
    """

    def __init__(self) -> None:
        self.failure: Exception | None = None
        """What kept this process from having some loop as machine code; it then runs interpreted."""
        self._lock = threading.Lock()  # guards everything below
        self._wanted: list[Loop] = []
        self._thread: threading.Thread | None = None
        self._worker: WorkerProcess | None = None

    def want(self, loops: Iterable[Loop]) -> None:
        """Come by these loops, in place of what was wanted until now; what is compiled already is finished.

        This does not wait for any, but where there can be no thread. Where nothing is wanted any more, the
        worker lets everybody else go first.
        """
        with self._lock:
            self._wanted = [loop for loop in loops if loop not in COMPILED_LOOPS]
            if self._wanted and self._thread is None:
                thread = threading.Thread(target=self._work, name="background compiler", daemon=True)
                with suppress(RuntimeError):  # there may be only so many threads
                    thread.start()
                    self._thread = thread
            if not self._wanted and self._worker is not None:
                self._worker.let_others_go_first()
        if self._thread is None:
            self._work()

    def _next(self) -> Loop | None:
        with self._lock:
            self._wanted = [loop for loop in self._wanted if loop not in COMPILED_LOOPS]
            if not self._wanted:
                self._thread = None
                if self._worker is not None:
                    self._worker.end()
                    self._worker = None
                return None
            return self._wanted[0]

    def _work(self) -> None:
        while (loop := self._next()) is not None:
            try:
                self._come_by(loop)
            except Exception as error:  # whatever a broken installation may raise
                with self._lock:
                    self.failure = error
                    self._wanted = []

    def _come_by(self, loop: Loop) -> None:
        # Imports all that learns: not before something is wanted
        from rl_tui.agents.compiling.loops import compile_here, load
        from rl_tui.agents.kernels.cache_folder import takes_code, was_compiled

        if (was_compiled(loop) or not takes_code()) and load(loop):
            return
        if not (takes_code() and self._is_compiled_elsewhere(loop)):
            compile_here(loop)

    def _is_compiled_elsewhere(self, loop: Loop) -> bool:
        """Have the worker compile ``loop`` and read what it has kept; False where it fails."""
        from rl_tui.agents.compiling.loops import LOOKED_FOR_EVERY, load
        from rl_tui.agents.kernels.cache_folder import was_compiled

        try:
            with self._lock:
                self._worker = worker = self._worker or WorkerProcess()
            worker.ask(loop)
            was_noted = was_compiled(loop)
            while True:
                answer = worker.answer(LOOKED_FOR_EVERY)
                if answer == GONE:
                    raise ChildProcessError
                if answer == COMPILED:
                    return load(loop)
                # Another process may have compiled it while ours waits for its turn
                if not was_noted and was_compiled(loop):
                    was_noted = True
                    if load(loop):
                        return True
        except OSError:
            with self._lock:
                if self._worker is not None:
                    self._worker.end()
                self._worker = None
            return False


BACKGROUND: BackgroundCompiler = BackgroundCompiler()
"""The one of this process."""
