"""Of the processes that share a cache one compiles at a time."""

from __future__ import annotations

from types import TracebackType

from rl_tui.agents.compiling.cache_folder import cache_folder, takes_code
from rl_tui.common.file_lock import FileLock


class CompilerLock(FileLock):
    """What the one holds that compiles; it is released at the end of a ``with``, if it was acquired."""

    def __init__(self) -> None:
        super().__init__(cache_folder() / "compiling")

    def acquire(self) -> bool:
        """Take the lock; False while another process has it.

        Where nothing can be kept, no process waits for another one: there everybody gets one.
        """
        try:
            return not takes_code() or super().acquire()
        except OSError:
            return True

    def __enter__(self) -> CompilerLock:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.release()
