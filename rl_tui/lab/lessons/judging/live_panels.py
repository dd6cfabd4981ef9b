"""Conditions that many seeds decide, worked out beside the run on screen: at most one request at a time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Final

from rl_tui.common.errors import UserError
from rl_tui.lab.lessons.judging.panel_request import KnownPanels, PanelProgress, PanelRequest, same_panel
from rl_tui.lab.lessons.judging.verdicts import ConditionVerdict
from rl_tui.lab.workers.answering_process import AnsweringProcess, Background

if TYPE_CHECKING:
    from rl_tui.lab.lessons.schema import Condition
    from rl_tui.lab.run.recipe import Recipe

    _Process = AnsweringProcess[PanelRequest, PanelProgress]

WORK: Final = "rl_tui.lab.lessons.judging.seed_panel:work"
"""What runs in the process."""


class LivePanels:
    """Has them worked out in a process of its own, and remembers what came of it, be it of some seeds only.

    ``on_news`` is called, from any thread, when there is more to tell. With ``automatic`` off :meth:`of`
    works them out itself, so that what is known does not depend on the time; a process takes longer to begin.
    """

    def __init__(self, on_news: Callable[[], None], *, automatic: bool) -> None:
        self._automatic = automatic
        self._background = Background[PanelRequest, PanelProgress](WORK, on_news)
        self._known = KnownPanels()

    def of(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> Sequence[ConditionVerdict]:
        """Return what is known by now of ``conditions`` for runs of ``recipe``, and see to the rest."""
        found = self._known.of(recipe, conditions)
        if found is not None:
            return found
        if not self._automatic:
            return self._worked_out_here(recipe, conditions)
        process = self._background.process
        if process is None or not same_panel(*_panel(process), recipe, conditions):
            process = self._begin(recipe, conditions)
        if process is None:
            return [ConditionVerdict(None, "no process can be started to work it out")] * len(conditions)
        verdicts = process.known.verdicts
        if verdicts is not None:
            self._known.keep(recipe, conditions, verdicts)
            return verdicts
        return [ConditionVerdict(None, process.failed or self.waits)] * len(conditions)

    @property
    def waits(self) -> str:
        """How many seeds are done of those under way, and how long the rest takes; empty where none are."""
        process = self._background.process
        if process is None or process.known.verdicts is not None or process.failed:
            return ""
        done, wanted = len(process.known.seeds), process.known.wanted
        said = f"{done} of {wanted} seeds" if wanted else f"{done} seeds so far"
        return " · ".join(filter(None, (f"judging: {said}", process.how_long)))

    def end(self) -> None:
        """End what is being worked out; what is known is remembered, so that it may go on from there."""
        process = self._background.process
        if process is not None and process.known.verdicts is None:
            self._known.keep_seeds(*_panel(process), process.known.seeds)
        self._background.end()

    def close(self) -> None:
        """End it, from any thread, and begin nothing any more."""
        self._background.close()

    def _worked_out_here(
        self, recipe: Recipe, conditions: tuple[Condition, ...]
    ) -> Sequence[ConditionVerdict]:
        from rl_tui.lab.lessons.judging.seed_panel import worked_out

        try:
            found = worked_out(recipe, conditions)
        except UserError as reason:
            return [ConditionVerdict(None, str(reason))] * len(conditions)
        self._known.keep(recipe, conditions, found)
        return found

    def _begin(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> _Process | None:
        self.end()
        seeds = self._known.seeds_of(recipe, conditions)
        try:
            return self._background.begin(PanelRequest(recipe, conditions, seeds), PanelProgress(seeds))
        except OSError:
            return None


def _panel(process: _Process) -> tuple[Recipe, tuple[Condition, ...]]:
    return process.request.recipe, process.request.conditions
