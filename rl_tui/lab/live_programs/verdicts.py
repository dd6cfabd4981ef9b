"""What the detective says of a program while it runs, worked out beside it."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from copy import copy
from typing import Final

from rl_tui.lab.detective.detective import verdict_of
from rl_tui.lab.detective.verdict import ProgramVerdict
from rl_tui.lab.programs.program_log import ProgramLog

EVERY: Final = 1.0
"""Seconds between two verdicts on a program that runs."""
_REST: Final = 4.0
"""So many times as long as the last verdict took, nothing is worked out."""


class Verdicts:
    """The newest verdict on a program; ``on_news`` is called from another thread when there is one.

    With ``automatic`` off it is worked out when it is asked for, so that it does not depend on the time.
    """

    def __init__(self, on_news: Callable[[], None], *, automatic: bool) -> None:
        self.newest = ProgramVerdict()
        """The newest verdict."""
        self._on_news = on_news
        self._automatic = automatic
        self._judged = -1  # the step up to which it was judged
        self._next = 0.0  # when the next one may begin
        self._thread: threading.Thread | None = None
        self._generation = 0

    def forget(self) -> None:
        """Begin anew: it is another run of the program."""
        self.newest, self._judged, self._next = ProgramVerdict(), -1, 0.0
        self._generation += 1

    def look(self, log: ProgramLog, *, is_still: bool) -> None:
        """See to it that there is a verdict on what ``log`` holds: soon, or at once where it ``is_still``."""
        count = log.recording.count
        if count == self._judged or (self._thread is not None and self._thread.is_alive()):
            return
        if not self._automatic:
            if is_still:
                self.newest, self._judged = verdict_of(log), count
        elif is_still or time.monotonic() >= self._next:
            self._judged = count
            arguments = (_frozen(log), self._generation)
            self._thread = threading.Thread(
                target=self._work, args=arguments, name="the detective", daemon=True
            )
            self._thread.start()

    def _work(self, log: ProgramLog, generation: int) -> None:
        begun = time.monotonic()
        verdict = verdict_of(log)
        taken = time.monotonic() - begun
        if generation == self._generation:
            self.newest = verdict
            self._next = begun + taken + max(EVERY, _REST * taken)
            self._on_news()


def _frozen(log: ProgramLog) -> ProgramLog:
    """Return ``log`` as it is now: arrays are never written to, lists grow."""
    result, result_recording = copy(log), copy(log.recording)
    for name, value in vars(result_recording).items():
        if isinstance(value, list):
            setattr(result_recording, name, list(value))
    result.recording = result_recording
    result.numbers, result.lines = dict(log.numbers), dict(log.lines)
    result.notes = list(log.notes)
    return result
