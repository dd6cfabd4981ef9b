"""The link to the terminal: one frame at a time, if the terminal reports arrival.

After a frame the terminal is asked for its cursor position. The answer means that everything before is drawn.
The cursor is in the second line, because in the first the answer may also be shift+F3. Its column identifies
the frame.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from math import inf
from time import monotonic
from typing import Final, NamedTuple

ANSWER_LINE: Final = 1  # counted from 0
_COLUMNS: Final = 60
_SLOWEST: Final = 4_000.0  # bytes/s: on a slower link the terminal counts as silent
_LEAST_WAIT, _MOST_WAIT = 1.0, 5.0  # seconds
_SILENT_FRAMES: Final = 4  # frames without an answer, and the seconds since the first:
_SILENT_SECONDS: Final = 5.0
_ASK_AGAIN: Final = 1.0  # seconds between two questions to a silent terminal
_MEMORY: Final = 0.7  # weight of the past in the running mean
_LONGEST_FRAME: Final = 0.2  # seconds on its way
_LEAST_ROOM: Final = 1_000.0  # bytes
_SLOW: Final = 50_000.0  # bytes/s
_TELLING: Final = 500  # bytes of a frame that is large enough to measure the link


class _Frame(NamedTuple):
    column: int
    size: int
    sent: float


class Link:
    """Decides when the next frame may be sent.

    A terminal that has never answered gets frames without any wait.
    """

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self._under_way: deque[_Frame] = deque()
        self._number = 0
        self._first_asked: float | None = None
        self._unanswered = 0
        self._has_answered = False
        self._hurries = False
        self._trip = inf
        self._seconds_a_byte = 0.0

    @property
    def is_idle(self) -> bool:
        """True if no answer is expected."""
        return not self._under_way or self.is_silent

    @property
    def wait(self) -> float:
        """The seconds to wait without an answer."""
        if self.is_idle:
            return 0.0
        size = sum(frame.size for frame in self._under_way)
        patience = _LEAST_WAIT if self._hurries else min(_MOST_WAIT, _LEAST_WAIT + size / _SLOWEST)
        return max(0.0, self._under_way[-1].sent + patience - self._clock())

    @property
    def is_silent(self) -> bool:
        """True if the terminal seems never to answer."""
        return (
            not self._has_answered
            and self._unanswered >= _SILENT_FRAMES
            and self._first_asked is not None
            and self._clock() - self._first_asked >= _SILENT_SECONDS
        )

    @property
    def room(self) -> float:
        """The next frame's most bytes, so that keys do not wait long."""
        if not self._seconds_a_byte:
            return inf
        return max(_LEAST_ROOM, _LONGEST_FRAME / self._seconds_a_byte)

    @property
    def is_slow(self) -> bool:
        """True if a full screen takes noticeable time."""
        return self._seconds_a_byte > 1.0 / _SLOW

    def hurry(self) -> None:
        """Shorten the wait after a key press."""
        self._hurries = True

    def send(self, size: int, width: int) -> int | None:
        """Record a frame of ``size`` bytes to ``width`` columns.

        Returns the column (from 0) in which to ask for the cursor, or None.
        """
        now = self._clock()
        self._hurries = False
        if self.is_silent and now - self._under_way[-1].sent < _ASK_AGAIN:
            return None
        columns = min(width, _COLUMNS)
        self._number = (self._number + 1) % columns
        if self._first_asked is None:
            self._first_asked = now
        self._under_way.append(_Frame(self._number, size, now))
        if len(self._under_way) >= columns:
            self._under_way.popleft()  # its column is needed again
        self._unanswered += 1
        return self._number

    def answer(self, column: int, line: int) -> bool:
        """Take a cursor position (from 0), returning False if unasked."""
        if line != ANSWER_LINE or column not in [frame.column for frame in self._under_way]:
            return False
        size = 0
        while True:
            frame = self._under_way.popleft()
            size += frame.size
            if frame.column == column:
                break
        self._has_answered = True
        self._unanswered = 0
        self._measure(size, self._clock() - frame.sent)
        return True

    def restart(self) -> None:
        """Start again, maybe with another terminal."""
        self._under_way.clear()
        self._first_asked, self._unanswered = None, 0

    def _measure(self, size: int, took: float) -> None:
        self._trip = min(self._trip, took)
        if size >= _TELLING:
            each = max(0.0, took - self._trip) / size
            self._seconds_a_byte = _MEMORY * self._seconds_a_byte + (1.0 - _MEMORY) * each
