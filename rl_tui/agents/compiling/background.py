"""Compiling in the background while runs continue interpreted."""

from __future__ import annotations

import json
import os
import sys
import threading
import time
from collections.abc import Iterable
from contextlib import suppress
from queue import Empty, SimpleQueue
from typing import IO, Final

from rl_tui.agents.compiling import worker
from rl_tui.agents.compiling.base_folder import base_folder
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS, SHARED, Loop
from rl_tui.common.child_process import python_process
from rl_tui.common.findings import one_line
from rl_tui.common.packages import STAYS_INTERPRETED, missing_package

# The process that compiles


IDLE_NICENESS: Final = 19
"""Niceness of a worker that is no longer needed."""
GONE: Final = ""
"""Answer of a worker that has ended."""


class WorkerProcess:
    """A process that compiles into the cache, and ends with this process in any case.

    If `alone`, it does not wait for others.

    Raises:
        OSError: The process cannot be started.
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
        """True once the worker is no longer needed."""

    def _read(self, stdout: IO[bytes]) -> None:
        with stdout:
            for line in stdout:
                self._answers.put(line.decode().strip())
        self._answers.put(GONE)

    def ask(self, loop: Loop) -> None:
        """Request `loop`. Raises OSError if the worker has ended."""
        try:
            self._stdin.write(json.dumps(loop).encode() + b"\n")
        except ValueError as error:  # closed by end()
            raise BrokenPipeError(str(error)) from error

    def answer(self, seconds: float) -> str | None:
        """Return the next answer, GONE after the worker's end, or None after `seconds`."""
        try:
            return self._answers.get(timeout=seconds)
        except Empty:
            return None

    def let_others_go_first(self) -> None:
        """Give the worker the lowest priority, permanently."""
        self.is_idle = True
        if sys.platform == "win32":
            return
        with suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, self._process.pid, IDLE_NICENESS)

    def end(self) -> None:
        """End the worker, even while it compiles."""
        self._process.kill()
        with suppress(OSError):
            self._stdin.close()
        self._process.wait()


# The thread that asks for it


LONGEST_READ: Final = 2.0
"""Longest time in seconds that other work may pause while machine code is read."""
_SHORT: Final = 0.1
_LONGEST_REASON: Final = 200


class BackgroundCompiler:
    """A thread that gets machine code and ends when there is nothing to do.

    Code in the cache is read. Other code is compiled by one worker process, or more slowly in this process if
    that is impossible or the cache cannot store it.
    """

    def __init__(self) -> None:
        self.failed: dict[Loop, BaseException] = {}
        """Loops without machine code, and the reason. They stay interpreted and are not tried again."""
        self._loading_since: float | None = None
        self._lock = threading.Lock()  # guards everything below
        self._wanted: list[Loop] = []
        self._thread: threading.Thread | None = None
        self._worker: WorkerProcess | None = None
        self._asked: Loop | None = None
        self._worker_helps = True

    def want(self, loops: Iterable[Loop]) -> None:
        """Request these loops instead of earlier requests. Compiling in progress is finished.

        This returns immediately, unless no thread can start. Without requests, the worker gets the lowest
        priority and ends after its work.
        """
        with self._lock:
            self._wanted = [loop for loop in loops if self._is_missing(loop)]
            if self._worker is not None:
                if not self._wanted:
                    self._worker.let_others_go_first()
                elif self._worker.is_idle and self._asked not in self._wanted:
                    self._worker.end()  # its priority stays low, and a run waits now
            if not self._wanted or self._thread is not None:
                return
            self._thread = threading.Thread(target=self._work, name="background compiler", daemon=True)
            try:
                self._thread.start()
                return
            except RuntimeError:  # there may be only so many threads
                self._thread = None
                self._worker_helps = False  # a worker needs a thread too
        self._work()

    @property
    def is_busy(self) -> bool:
        """True while something is compiled or read."""
        return self._thread is not None

    @property
    def is_loading(self) -> bool:
        """True while machine code is read, at most for ``LONGEST_READ`` seconds."""
        since = self._loading_since
        return since is not None and time.monotonic() - since < LONGEST_READ

    def finish(self, seconds: float) -> None:
        """Wait up to `seconds` for compiling in progress. Nothing new is started."""
        with self._lock:
            self._wanted = []
            thread = self._thread
        end = time.monotonic() + seconds
        while thread is not None and thread.is_alive() and time.monotonic() < end:
            thread.join(_SHORT)

    def why_not(self, loops: Iterable[Loop]) -> str:
        """Return why none of `loops` can get machine code, or ""."""
        errors = [None if loop in COMPILED_LOOPS else self.failed.get(loop) for loop in loops]
        error = errors[0] if errors else None
        if error is None or None in errors:
            return ""
        reason = missing_package(error) or one_line(f"{type(error).__name__}: {error}", _LONGEST_REASON)
        return f"{STAYS_INTERPRETED}: {reason}"

    def get(self, loop: Loop) -> bool:
        """Get `loop` in this thread, from the cache or compiled. Return False on failure."""
        from rl_tui.agents.compiling.loops import compile_here

        try:
            compile_here(loop)
        except Exception as error:  # a broken installation may raise anything
            self.failed[loop] = error
        return loop in COMPILED_LOOPS

    def read(self, loop: Loop) -> bool:
        """Read `loop` from the cache, or return False."""
        from rl_tui.agents.compiling.loops import load

        self._loading_since = time.monotonic()
        try:
            return load(loop)
        except Exception as error:  # as above
            self.failed[loop] = error
            return False
        finally:
            self._loading_since = None

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
        worker, self._worker = self._worker, None
        if worker is not None:
            worker.end()

    def _work(self) -> None:
        loop: Loop | None = None
        try:
            while (loop := self._next()) is not None:
                self._get(loop)
        except BaseException as error:  # a broken installation may even raise SystemExit
            with self._lock:
                self.failed.update(dict.fromkeys((loop, *self._wanted) if loop else self._wanted, error))
                self._wanted, self._thread = [], None

    def _get(self, loop: Loop) -> None:
        # Imported late, because it imports all algorithms
        from rl_tui.agents.compiling.cache_folder import takes_code, was_compiled

        if was_compiled(loop) and self.read(loop):
            return
        if self._worker_helps and takes_code() and self._get_from_worker(loop):
            return
        if self._is_wanted(loop):
            self.get(loop)

    def _get_from_worker(self, loop: Loop) -> bool:
        from rl_tui.agents.compiling.cache_folder import was_compiled
        from rl_tui.agents.compiling.loops import LOOKED_FOR_EVERY, CodeOrigin

        # The worker, or another process meanwhile, stores these two one after the other
        not_noted = [each for each in (SHARED, loop) if not was_compiled(each)]
        is_new = loop in not_noted
        try:
            with self._lock:
                self._worker, self._asked = self._worker or WorkerProcess(), loop
                worker = self._worker
            worker.ask(loop)
            while (answer := worker.answer(LOOKED_FOR_EVERY)) is None:
                for each in filter(was_compiled, not_noted.copy()):
                    not_noted.remove(each)
                    if self._is_wanted(loop):
                        self.read(each)
                is_kept = is_new and loop not in not_noted
                if loop in COMPILED_LOOPS or (is_kept and not self._is_wanted(loop)):
                    break
        except OSError:
            answer = GONE
        if answer in (None, GONE):  # if another process was faster, there is nothing to wait for
            with self._lock:
                self._end_worker()
        if answer == CodeOrigin.NOT_KEPT:
            self._worker_helps = False
        if answer in (CodeOrigin.FOUND, CodeOrigin.COMPILED) and self._is_wanted(loop):
            self.read(loop)
        return loop in COMPILED_LOOPS


BACKGROUND: BackgroundCompiler = BackgroundCompiler()
"""The compiler of this process."""
