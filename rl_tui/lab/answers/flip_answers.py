"""The flips of the worlds of a playground: each worked out once, when it is asked for."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.kiosk import in_kiosk
from rl_tui.lab.answers.flip_answer import (
    HELD_UP,
    NOT_ASKED,
    PENDING,
    FlipAnswer,
    FlipState,
    of_json,
    refused,
)
from rl_tui.lab.run.exact_answers import NO_TABLE
from rl_tui.lab.workers.answering_process import AnsweringProcess

if TYPE_CHECKING:
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

WORKER: Final = "rl_tui.lab.answers.flip_worker"
"""What runs in its process: fractions of thousands of digits would hold the interpreter for seconds."""
KEPT: Final = 4
"""Worlds of which the flips are kept: as many as there are lanes."""


class FlipAnswers:
    """Has flips worked out in a process of their own; not at the lowest priority, since it ends soon.

    ``on_news`` is called, from any thread, when an answer has come. With ``automatic`` off :meth:`begin`
    works them out itself, so that what is known does not depend on the time.
    """

    def __init__(self, on_news: Callable[[], None], *, automatic: bool) -> None:
        self._on_news = on_news
        self._automatic = automatic
        self._lock = threading.Lock()  # guards the process and whether there may be one
        self._process: _FlipProcess | None = None
        self._is_closed = False
        self._answers: list[tuple[TabularMDP, FlipAnswer]] = []

    def begin(self, mdp: TabularMDP | None) -> None:
        """Have the flips of ``mdp`` worked out, in place of those of any other world; once."""
        if mdp is None or self.of(mdp).state is not FlipState.NOT_ASKED:
            return
        known = at_once(mdp)
        if known is not None or not self._automatic:
            from rl_tui.lab.answers.flip_worker import worked_out

            self._keep(mdp, known or worked_out(mdp))
            return
        self._end()
        try:
            with self._lock:
                if not self._is_closed:
                    self._process = _FlipProcess(mdp, self._on_news)
        except OSError as error:
            self._keep(mdp, refused(f"no process can be started: {error}"))

    def of(self, mdp: TabularMDP | None) -> FlipAnswer:
        """Return what is known of the flips of ``mdp`` by now."""
        if mdp is None:
            return refused(NO_TABLE)
        process = self._process
        if process is not None and process.mdp is mdp:
            return process.answer
        return next((answer for world, answer in self._answers if world is mdp), NOT_ASKED)

    def close(self) -> None:
        """End what is being worked out, from any thread, and begin nothing any more."""
        with self._lock:
            self._is_closed = True
            if self._process is not None:
                self._process.end()

    def _end(self) -> None:
        """Keep what the process has found, if it has come to its end, and end it if not."""
        with self._lock:
            process, self._process = self._process, None
        if process is not None:
            process.end()
            if process.answer.state is not FlipState.PENDING:
                self._keep(process.mdp, process.answer)

    def _keep(self, mdp: TabularMDP, answer: FlipAnswer) -> None:
        # of worlds without flips, which may be large, the last one alone is kept
        known = [each for each in self._answers if each[1].state is FlipState.KNOWN]
        self._answers = [*known, (mdp, answer)][-KEPT:]


def at_once(mdp: TabularMDP) -> FlipAnswer | None:
    """Return the answer where there is nothing to work out, else None."""
    from rl_tui.agents.exact.flips.flips import why_refused

    if mdp.terminated.all():
        return FlipAnswer(FlipState.KNOWN)
    reason = "flips are not worked out in a kiosk" if in_kiosk() else why_refused(mdp)
    return refused(reason) if reason else None


class _FlipProcess(AnsweringProcess):
    """Works out the flips of ``mdp``."""

    def __init__(self, mdp: TabularMDP, on_news: Callable[[], None]) -> None:
        self.mdp = mdp
        self._found = PENDING
        super().__init__(WORKER, mdp, self._take_in, self._has_ended, on_news, "flips")

    @property
    def answer(self) -> FlipAnswer:
        """What is known by now."""
        return HELD_UP if self._found is PENDING and self.is_held_up else self._found

    def _take_in(self, document: Any) -> None:
        self._found = of_json(document)

    def _has_ended(self) -> None:
        if self._found is PENDING:
            self._found = refused("working them out took too long, or its process was ended")
