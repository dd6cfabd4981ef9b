"""The one writer of a store, by name: which process on which machine, and since when."""

from __future__ import annotations

import json
import os
import socket
import time
from pathlib import Path
from typing import Any, Final

from rl_tui.common.errors import UserError
from rl_tui.common.file_lock import FileLock
from rl_tui.common.findings import one_line
from rl_tui.common.text_file import UnreadableError, read_text

_LONGEST_NOTE: Final = 10_000
_ELSEWHERE: Final = "let each machine write a store of its own (--shard), then rl-tui sweep merge"


class WriterLock:
    """The right to write the store at ``path``, until it is released or the process ends.

    The system knows on one machine whether its holder lives, so a lock left behind there is taken over. On a
    drive that several machines share nobody knows: another machine's lock stands until its file is removed.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._note = path.with_name(f".{path.name}.writer")
        self._lock = FileLock(path)

    def acquire(self) -> None:
        """Take it. Raises UserError, naming the holder, where somebody else has it, and OSError."""
        if not self._lock.acquire():
            raise UserError(f"{self._path} is being written by {_in_words(self._holder())}; one at a time")
        holder = self._holder()
        if holder and holder.get("host") != socket.gethostname():
            self._lock.release()
            raise UserError(
                f"{self._path} is being written by {_in_words(holder)}, on another machine; {_ELSEWHERE}. If "
                f"that one was killed, remove {self._note}"
            )
        said = {
            "pid": os.getpid(),
            "host": socket.gethostname(),
            "since": time.strftime("%Y-%m-%d %H:%M:%S %z"),
        }
        self._note.unlink(missing_ok=True)  # whatever was put there in its place
        self._note.write_text(json.dumps(said), encoding="utf-8")

    def release(self) -> None:
        """Give it back."""
        self._note.unlink(missing_ok=True)
        self._lock.release()

    def _holder(self) -> dict[str, Any]:
        try:
            said = json.loads(read_text(self._note, "a note of the writer", _LONGEST_NOTE))
        except (UnreadableError, ValueError, RecursionError):
            return {}
        return said if isinstance(said, dict) else {}


def _in_words(holder: dict[str, Any]) -> str:
    if not holder:
        return "another process"
    said = f"process {holder.get('pid')} on {holder.get('host')} since {holder.get('since')}"
    return one_line(said, 120)
