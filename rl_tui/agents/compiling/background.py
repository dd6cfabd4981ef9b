"""Machine code for this process while its runs go on interpreted."""

from __future__ import annotations

import threading
from collections.abc import Iterable

from rl_tui.agents.compiling.worker_process import GONE, WorkerProcess
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS, SHARED, Loop


class BackgroundCompiler:
    """Comes by machine code in a thread of its own, which lives as long as there is something to do.

    What is in the cache is read from there. What is not is compiled by a worker process, one for all loops.
    Where there can be none, or it fails, this process compiles, and is slower meanwhile; so it does where the
    cache keeps nothing, since nothing would come of a worker's work.
    """

    def __init__(self) -> None:
        self.failed: dict[Loop, Exception] = {}
        """What there is no machine code for, and why: it stays interpreted, and is not tried again."""
        self.is_loading = False
        """Whether it reads machine code now: for half a second, if nothing else wants the interpreter."""
        self._lock = threading.Lock()  # guards everything below
        self._wanted: list[Loop] = []
        self._thread: threading.Thread | None = None
        self._worker: WorkerProcess | None = None
        self._asked: Loop | None = None
        self._worker_helps = True

    def want(self, loops: Iterable[Loop]) -> None:
        """Come by these loops, in place of what was wanted until now; what is being compiled is finished.

        This does not wait for any, but where there can be no thread. Where nothing is wanted any more, the
        worker lets everybody else go first, and is ended once it is done.
        """
        with self._lock:
            self._wanted = [loop for loop in loops if self._is_missing(loop)]
            if self._worker is not None:
                if not self._wanted:
                    self._worker.let_others_go_first()
                elif self._worker.is_idle and self._asked not in self._wanted:
                    self._worker.end()  # nothing raises its priority again, and somebody waits now
            if not self._wanted or self._thread is not None:
                return
            thread = threading.Thread(target=self._work, name="background compiler", daemon=True)
            try:
                thread.start()
                self._thread = thread
                return
            except RuntimeError:  # there may be only so many threads
                self._worker_helps = False  # it takes one too
        self._work()

    @property
    def is_busy(self) -> bool:
        """Whether something is being compiled or read."""
        return self._thread is not None

    def finish(self) -> None:
        """Wait until what is being compiled is in the cache, for others: here nothing is wanted any more."""
        self.want(())
        thread = self._thread
        if thread is not None:
            thread.join()

    def _is_missing(self, loop: Loop) -> bool:
        return loop not in COMPILED_LOOPS and loop not in self.failed

    def _is_wanted(self, loop: Loop) -> bool:
        with self._lock:
            return loop in self._wanted

    def _next(self) -> Loop | None:
        with self._lock:
            self._wanted = [loop for loop in self._wanted if self._is_missing(loop)]
            if self._wanted:
                return self._wanted[0]
            self._end_worker()
            self._thread = None
            return None

    def _end_worker(self) -> None:
        if self._worker is not None:
            self._worker.end()
            self._worker = None

    def _work(self) -> None:
        while (loop := self._next()) is not None:
            try:
                self._come_by(loop)
            except Exception as error:  # whatever a broken installation may raise
                self.failed[loop] = error

    def _come_by(self, loop: Loop) -> None:
        # Imports all that learns: not before something is wanted
        from rl_tui.agents.compiling.cache_folder import takes_code, was_compiled
        from rl_tui.agents.compiling.loops import compile_here

        if was_compiled(loop) and self._load(loop):
            return
        if self._worker_helps and takes_code() and self._is_compiled_elsewhere(loop):
            return
        if self._is_wanted(loop):
            compile_here(loop)

    def _load(self, loop: Loop) -> bool:
        """Read ``loop`` from the cache; False where that does not have it."""
        from rl_tui.agents.compiling.loops import load

        self.is_loading = True
        try:
            return load(loop)
        finally:
            self.is_loading = False

    def _is_compiled_elsewhere(self, loop: Loop) -> bool:
        """Have the worker compile ``loop``, and read what it has kept; False where that fails."""
        from rl_tui.agents.compiling.cache_folder import was_compiled
        from rl_tui.agents.compiling.loops import LOOKED_FOR_EVERY, CodeOrigin

        # Our worker keeps one before the other, and another process either, while ours waits for its turn
        hoped_for = [each for each in (SHARED, loop) if not was_compiled(each)]
        try:
            with self._lock:
                self._worker, self._asked = self._worker or WorkerProcess(), loop
                worker = self._worker
            worker.ask(loop)
            while (answer := worker.answer(LOOKED_FOR_EVERY)) is None:
                for each in filter(was_compiled, hoped_for.copy()):
                    hoped_for.remove(each)
                    if self._is_wanted(loop):
                        self._load(each)
                if loop in COMPILED_LOOPS:
                    break
        except OSError:
            answer = GONE
        if answer in (None, GONE):  # if another process was first, there is nothing to wait for any more
            with self._lock:
                self._end_worker()
        if answer == CodeOrigin.NOT_KEPT:
            self._worker_helps = False
        if answer in (CodeOrigin.FOUND, CodeOrigin.COMPILED) and self._is_wanted(loop):
            self._load(loop)
        return loop in COMPILED_LOOPS


BACKGROUND: BackgroundCompiler = BackgroundCompiler()
"""The one of this process."""
