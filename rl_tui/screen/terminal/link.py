"""The way to the terminal: one frame is on it at a time, as far as the terminal tells when it has arrived.

After a frame the terminal is asked where its cursor is. It answers in order, so that the answer means that
everything before has been drawn, whatever buffers lie between. The cursor is put into the second line for it
(in the first, ``ESC[1;2R`` would also be a key: shift+F3), and into a column that tells which frame is meant.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from math import inf
from time import monotonic
from typing import Final, NamedTuple

ANSWER_LINE: Final = 1  # counted from 0
_COLUMNS: Final = 60
_SLOWEST: Final = 4_000.0  # bytes/s: a slower link than this is taken for a terminal that does not answer
_LEAST_WAIT, _MOST_WAIT = 1.0, 5.0  # seconds
_SILENT_FRAMES: Final = 4  # not one of so many was answered, since so many seconds:
_SILENT_SECONDS: Final = 5.0
_ASK_AGAIN: Final = 1.0  # seconds between two questions to a silent terminal
_MEMORY: Final = 0.7  # weight of the past in the running mean
_LONGEST_FRAME: Final = 0.2  # seconds on its way
_LEAST_ROOM: Final = 1_000.0  # bytes
_SLOW: Final = 50_000.0  # bytes/s
_TELLING: Final = 500  # bytes of a frame from which on its time tells something of the link


class _Frame(NamedTuple):
    column: int
    size: int
    sent: float


class Link:
    """Tells when the next frame may be sent. ``clock`` tells seconds.

    A terminal that answers late is waited for, though not for ever; one that has never answered is soon sent
    frame after frame, as fast as they are drawn, until an answer comes after all.
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
        """Whether no answer is to be expected."""
        return not self._under_way or self.is_silent

    @property
    def wait(self) -> float:
        """Seconds after which a frame may be sent, if no answer comes before."""
        if self.is_idle:
            return 0.0
        size = sum(frame.size for frame in self._under_way)
        patience = _LEAST_WAIT if self._hurries else min(_MOST_WAIT, _LEAST_WAIT + size / _SLOWEST)
        return max(0.0, self._under_way[-1].sent + patience - self._clock())

    @property
    def is_silent(self) -> bool:
        """Whether this is taken for a terminal that never answers."""
        return (
            not self._has_answered
            and self._unanswered >= _SILENT_FRAMES
            and self._first_asked is not None
            and self._clock() - self._first_asked >= _SILENT_SECONDS
        )

    @property
    def room(self) -> float:
        """How many bytes the next frame should have at most: a key may be pressed while it is on its way."""
        if not self._seconds_a_byte:
            return inf
        return max(_LEAST_ROOM, _LONGEST_FRAME / self._seconds_a_byte)

    @property
    def is_slow(self) -> bool:
        """Whether a screen full of text takes so long that the wait is noticed."""
        return self._seconds_a_byte > 1.0 / _SLOW

    def hurry(self) -> None:
        """Do not wait for long with the next frame: a key was pressed."""
        self._hurries = True

    def send(self, size: int, width: int) -> int | None:
        """Note that a frame of ``size`` bytes is sent to a terminal of ``width`` columns.

        Returns the column, counted from 0, in which the cursor shall be asked for; None for not to ask.
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
        """Take the place of a cursor, counted from 0; False if no frame was asked about with it."""
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
        """Begin anew: what was under way may be lost, and this may be another terminal now."""
        self._under_way.clear()
        self._first_asked, self._unanswered = None, 0

    def _measure(self, size: int, took: float) -> None:
        self._trip = min(self._trip, took)
        if size >= _TELLING:
            each = max(0.0, took - self._trip) / size
            self._seconds_a_byte = _MEMORY * self._seconds_a_byte + (1.0 - _MEMORY) * each
