"""Verdicts on a program while it runs."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Final

from rl_tui.common.findings import one_line
from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.evidence.verdict import ProgramVerdict
from rl_tui.programs.watched.program_log import ProgramLog

EVERY: Final = 1.0
NOT_EXAMINED: Final = "your program could not be examined, because of a bug in rl-tui"
_LONGEST: Final = 300
_REST: Final = 4.0
"""The pause after a verdict is at least this many times its duration."""


class Verdicts:
    """The newest verdict on a program. `on_news` is called from another thread.

    Without `automatic`, verdicts come on request and do not depend on timing.
    """

    def __init__(self, on_news: Callable[[], None], *, automatic: bool) -> None:
        self.newest = ProgramVerdict()
        self._on_news = on_news
        self._automatic = automatic
        self._judged: tuple[int, ...] = ()  # amount of evidence at the last verdict
        self._next = 0.0  # earliest time of the next verdict
        self._thread: threading.Thread | None = None

    def look(self, log: ProgramLog, *, is_still: bool) -> None:
        """Start a verdict when one is due, or at once if the program `is_still`."""
        known = (
            log.recording.count,
            len(log.recording.changes.step),
            len(log.numbers),
            sum(log.lines.values()),
        )
        if known == self._judged or (self._thread is not None and self._thread.is_alive()):
            return
        if not self._automatic:
            if is_still:
                self.newest, self._judged = _judged(log), known
        elif is_still or time.monotonic() >= self._next:
            self._judged = known
            arguments = (log.frozen(),)
            self._thread = threading.Thread(target=self._work, args=arguments, name="diagnosis", daemon=True)
            try:
                self._thread.start()
            except RuntimeError:  # the program may have used up all threads
                self._thread, self._judged, self._next = None, (), time.monotonic() + EVERY

    def _work(self, log: ProgramLog) -> None:
        begun = time.monotonic()
        self.newest = _judged(log)
        now = time.monotonic()
        self._next = now + max(EVERY, _REST * (now - begun))
        self._on_news()


def _judged(log: ProgramLog) -> ProgramVerdict:
    """Return the verdict. An error in the diagnosis must not end the program on screen."""
    try:
        return verdict_of(log)
    except Exception as error:
        return ProgramVerdict(notes=(one_line(f"{NOT_EXAMINED}: {type(error).__name__}: {error}", _LONGEST),))
