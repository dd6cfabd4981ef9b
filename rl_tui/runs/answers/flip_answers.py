"""The flip points of a playground's worlds, each computed once."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from rl_tui.common.kiosk import in_kiosk
from rl_tui.runs.answers.flip_answer import (
    HELD_UP,
    NOT_ASKED,
    PENDING,
    FlipAnswer,
    FlipState,
    refused,
    worked_out,
)
from rl_tui.runs.background.background import AnsweringProcess, Background
from rl_tui.runs.exact_answers import NO_TABLE

if TYPE_CHECKING:
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

WORK: Final = "rl_tui.runs.answers.flip_answer:work"
"""Runs in a process of its own: fractions of thousands of digits would block the interpreter for seconds."""
TOO_LONG: Final = "the computation took too long, or its process was killed"
KEPT: Final = 4
"""Number of worlds whose flip points are remembered: one for each run."""


class FlipAnswers:
    """Computes flip points in a separate process, or within `begin` if not `automatic`.

    `on_news` is called from any thread.
    """

    def __init__(self, on_news: Callable[[], None], *, automatic: bool) -> None:
        self._automatic = automatic
        self._background = Background["TabularMDP", FlipAnswer](WORK, on_news)
        self._answers: list[tuple[TabularMDP, FlipAnswer]] = []

    def begin(self, mdp: TabularMDP | None) -> None:
        """Compute the flip points of `mdp`, once, instead of any others."""
        if mdp is None or self.of(mdp).state is not FlipState.NOT_ASKED:
            return
        known = at_once(mdp)
        if known is not None or not self._automatic:
            self._keep(mdp, known or worked_out(mdp))
            return
        before = self._background.process
        if before is not None and (found := _answer_of(before)).state is not FlipState.PENDING:
            self._keep(before.request, found)
        try:
            self._background.begin(mdp, PENDING)
        except OSError as error:
            self._keep(mdp, refused(f"cannot start a process: {error}"))

    def of(self, mdp: TabularMDP | None) -> FlipAnswer:
        """Return the known flip points of `mdp`."""
        if mdp is None:
            return refused(NO_TABLE)
        process = self._background.process
        if process is not None and process.request is mdp:
            return _answer_of(process)
        return next((answer for world, answer in self._answers if world is mdp), NOT_ASKED)

    def close(self) -> None:
        """Stop the computation and refuse new ones. Safe from any thread."""
        self._background.close()

    def _keep(self, mdp: TabularMDP, answer: FlipAnswer) -> None:
        # answers without flip points refer to large worlds: remember only the newest of them
        known = [each for each in self._answers if each[1].state is FlipState.KNOWN]
        self._answers = [*known, (mdp, answer)][-KEPT:]


def at_once(mdp: TabularMDP) -> FlipAnswer | None:
    """Return the answer if it needs no computation, else None."""
    from rl_tui.agents.exact.flips import why_refused

    if mdp.terminated.all():
        return FlipAnswer(FlipState.KNOWN)
    reason = "flip points are not computed in a kiosk" if in_kiosk() else why_refused(mdp)
    return refused(reason) if reason else None


def _answer_of(process: AnsweringProcess[TabularMDP, FlipAnswer]) -> FlipAnswer:
    if process.known is not PENDING:
        return process.known
    if process.failed:
        return refused(process.why_failed(TOO_LONG))
    return HELD_UP if process.is_held_up else PENDING
