"""The pipe to the watching side: steps and changes in batches, all else as messages between them."""

from __future__ import annotations

import json
import os
import struct
from time import monotonic
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from rl_tui.lab.programs.messages import HEADER, MESSAGE, STEP_WIDTH, STEPS, TABLE

_BETWEEN_BATCHES: Final = 1 / 30  # seconds
_MOST_NUMBERS: Final = 1_000_000  # of changes that wait to be written


class Channel:
    """Writes into the pipe ``reports``. ``steps`` and ``changes`` are what :meth:`flush` writes next.

    Where nobody reads any more the process ends at once. In a forked process nothing is written.
    """

    def __init__(self, reports: int) -> None:
        self._reports, self._process = reports, os.getpid()
        self._due = 0.0
        self.steps: list[float] = []
        self.changes: list[float] = []

    def message(self, kind: str, **more: Any) -> None:
        """Write a message, after all steps so far."""
        self.flush()
        self._write(MESSAGE, json.dumps({"kind": kind, **more}).encode())

    def table(self, values: npt.NDArray[np.float64]) -> None:
        """Write the content of a table, [S·A], whose message went before it."""
        self._write(TABLE, np.ascontiguousarray(values, np.float64).tobytes())

    @property
    def is_due(self) -> bool:
        """Whether a batch is to be written: some thirty times a second, or when there is much."""
        return monotonic() >= self._due or len(self.changes) > _MOST_NUMBERS

    def flush(self) -> None:
        """Write the steps and changes so far."""
        if self.steps or self.changes:
            numbers = (len(self.steps) // STEP_WIDTH, *self.steps, *self.changes)
            payload = struct.pack(f"{len(numbers)}d", *numbers)
            self.steps.clear()
            self.changes.clear()
            self._write(STEPS, payload)
        self._due = monotonic() + _BETWEEN_BATCHES

    def from_a_fork(self, kind: str, **more: Any) -> None:
        """Write a message from a forked process; it is short enough to come in one piece."""
        payload = json.dumps({"kind": kind, **more}).encode()
        os.write(self._reports, HEADER.pack(MESSAGE, len(payload)) + payload)

    def _write(self, letter: bytes, payload: bytes) -> None:
        if os.getpid() != self._process:
            return
        left = memoryview(HEADER.pack(letter, len(payload)) + payload)
        try:
            while left:
                left = left[os.write(self._reports, left) :]
        except OSError:
            os._exit(0)
