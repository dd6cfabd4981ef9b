"""The pipe to the watching side: steps and changes in batches, all else as messages between them."""

from __future__ import annotations

import json
import os
import struct
from collections.abc import Callable
from threading import RLock
from time import monotonic
from typing import Any, Final, NoReturn

import numpy as np
import numpy.typing as npt

from rl_tui.lab.programs.messages import CHANGE_WIDTH, HEADER, MESSAGE, STEP_WIDTH, STEPS, TABLE

_BETWEEN_BATCHES: Final = 1 / 30  # seconds
_MOST_NUMBERS: Final = 1_000_000  # of changes that wait to be written


class Channel:
    """Writes into the pipe ``reports``. ``steps`` and ``changes`` are what :meth:`flush` writes next.

    A program adds to both lists and never takes from them, so that another thread may write what stands in
    them. Where nobody reads any more the process ends at once. In a forked process nothing is written.
    """

    def __init__(self, reports: int) -> None:
        self._reports, self._process = reports, os.getpid()
        self.leave: Callable[[int], NoReturn] = os._exit
        """Ends the process at once; a script finds another one in its place."""
        self._due, self._written = 0.0, 0
        self._writing = RLock()
        os.register_at_fork(after_in_child=self._unlock)
        self.steps: list[float] = []
        self.changes: list[float] = []

    def message(self, kind: str, **more: Any) -> None:
        """Write a message, after all steps so far."""
        with self._writing:
            self.flush()
            self._write(MESSAGE, json.dumps({"kind": kind, **more}).encode())

    def table(self, values: npt.NDArray[np.float64]) -> None:
        """Write the content of a table, [S·A], whose message went before it."""
        with self._writing:
            self._write(TABLE, np.ascontiguousarray(values, np.float64).tobytes())

    @property
    def is_due(self) -> bool:
        """Whether a batch is to be written: some thirty times a second, or when there is much."""
        return monotonic() >= self._due or len(self.changes) > _MOST_NUMBERS

    @property
    def is_late(self) -> bool:
        """Whether something waits to be written for longer than a program that goes on lets it."""
        return bool(self.steps or self.changes) and monotonic() >= self._due + _BETWEEN_BATCHES

    def flush(self, *, but_last: bool = False) -> None:
        """Write the steps and changes so far, but those of the last step where that may still change more."""
        with self._writing:
            changes = len(self.changes)  # counted first: a change may not go before its step
            steps = len(self.steps)
            if but_last:
                steps = max(steps - STEP_WIDTH, 0)
                end = self._written + steps // STEP_WIDTH
                while changes and self.changes[changes - CHANGE_WIDTH] >= end:
                    changes -= CHANGE_WIDTH
            if steps or changes:
                numbers = (steps // STEP_WIDTH, *self.steps[:steps], *self.changes[:changes])
                payload = struct.pack(f"{len(numbers)}d", *numbers)
                del self.steps[:steps]
                del self.changes[:changes]
                self._written += steps // STEP_WIDTH
                self._write(STEPS, payload)
            self._due = monotonic() + _BETWEEN_BATCHES

    def from_a_fork(self, kind: str, **more: Any) -> None:
        """Write a message from a forked process; it is short enough to come in one piece."""
        payload = json.dumps({"kind": kind, **more}).encode()
        os.write(self._reports, HEADER.pack(MESSAGE, len(payload)) + payload)

    def _unlock(self) -> None:
        """Let a forked process have a lock of its own: whoever held it is not there."""
        self._writing = RLock()

    def _write(self, letter: bytes, payload: bytes) -> None:
        if os.getpid() != self._process:
            return
        left = memoryview(HEADER.pack(letter, len(payload)) + payload)
        try:
            while left:
                left = left[os.write(self._reports, left) :]
        except OSError:
            self.leave(0)
