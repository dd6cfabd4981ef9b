"""Conditions that many seeds decide, worked out beside the run on screen: at most one request at a time."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.errors import UserError
from rl_tui.lab.lessons.judging.panel_request import KnownPanels, PanelRequest, same_panel
from rl_tui.lab.lessons.judging.verdicts import ConditionVerdict
from rl_tui.lab.workers.answering_process import AnsweringProcess
from rl_tui.worlds.gym.modules import ALLOWED

if TYPE_CHECKING:
    from rl_tui.lab.lessons.judging.panel_request import SeedValues
    from rl_tui.lab.lessons.schema import Condition
    from rl_tui.lab.run.recipe import Recipe

WORKER: Final = "rl_tui.lab.lessons.judging.panel_worker"
"""What runs in the process."""


class LivePanels:
    """Has them worked out in a process of its own, and remembers what came of it, be it of some seeds only.

    ``on_news`` is called, from any thread, when there is more to tell. With ``automatic`` off :meth:`of`
    works them out itself, so that what is known does not depend on the time; a process takes longer to begin.
    """

    def __init__(self, on_news: Callable[[], None], *, automatic: bool) -> None:
        self._on_news = on_news
        self._automatic = automatic
        self._lock = threading.Lock()  # guards the process and whether there may be one
        self._process: _PanelProcess | None = None
        self._is_closed = False
        self._known = KnownPanels()

    def of(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> Sequence[ConditionVerdict]:
        """Return what is known by now of ``conditions`` for runs of ``recipe``, and see to the rest."""
        found = self._known.of(recipe, conditions)
        if found is not None:
            return found
        if not self._automatic:
            return self._worked_out_here(recipe, conditions)
        process = self._process
        if process is None or not process.is_about(recipe, conditions):
            process = self._begin(recipe, conditions)
        if process is None:
            return [ConditionVerdict(None, "no process can be started to work it out")] * len(conditions)
        if process.verdicts is not None:
            self._known.keep(recipe, conditions, process.verdicts)
            return process.verdicts
        return [ConditionVerdict(None, process.failed or self.waits)] * len(conditions)

    @property
    def waits(self) -> str:
        """How many seeds are done of those under way, and how long the rest takes; empty where none are."""
        process = self._process
        if process is None or process.verdicts is not None or process.failed:
            return ""
        done, wanted = process.progress
        said = f"{done} of {wanted} seeds" if wanted else f"{len(process.seeds)} seeds so far"
        return " · ".join(filter(None, (f"judging: {said}", process.how_long)))

    def end(self) -> None:
        """End what is being worked out; what is known is remembered, so that it may go on from there."""
        with self._lock:
            process, self._process = self._process, None
        if process is not None:
            process.end()
            if process.verdicts is None:
                self._known.keep_seeds(*process.panel, tuple(process.seeds))

    def close(self) -> None:
        """End it, from any thread, and begin nothing any more."""
        with self._lock:
            self._is_closed = True
            if self._process is not None:
                self._process.end()

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

    def _begin(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> _PanelProcess | None:
        self.end()
        seeds = self._known.seeds_of(recipe, conditions)
        try:
            with self._lock:
                if not self._is_closed:
                    self._process = _PanelProcess(recipe, conditions, seeds, self._on_news)
        except OSError:
            return None
        return self._process


class _PanelProcess(AnsweringProcess):
    """Works out ``conditions`` for runs of ``recipe``; what is known by now stands in its attributes.

    ``seeds`` is what came of the first ones before.
    """

    def __init__(
        self,
        recipe: Recipe,
        conditions: tuple[Condition, ...],
        seeds: tuple[SeedValues, ...],
        on_news: Callable[[], None],
    ) -> None:
        self.verdicts: tuple[ConditionVerdict, ...] | None = None
        """What came of it, None before its end."""
        self.failed = ""
        """Why nothing came of it; empty unless it has failed."""
        self.progress = (0, 0)
        """How many seeds of how many are done; none of none before the first."""
        self.seeds = list(seeds)
        """What came of the seeds that are done."""
        self._known = len(seeds)
        self.panel = recipe, conditions
        """What is worked out."""
        request = PanelRequest(recipe, conditions, frozenset(ALLOWED), seeds)
        super().__init__(WORKER, request, self._take_in, self._has_ended, on_news, "seeds of a task")

    def is_about(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> bool:
        """Return whether this is what it works out."""
        return same_panel(*self.panel, recipe, conditions)

    def _take_in(self, document: Any) -> None:
        if "done" in document:
            self.progress = document["done"], document["wanted"]
            self.pace.begun = self._known / document["wanted"]
            self.seeds.append(document["values"])
            self.pace.note(document["done"] / document["wanted"])
        elif "failed" in document:
            self.failed = str(document["failed"])
        else:
            self.verdicts = tuple(
                ConditionVerdict(holds, str(found)) for holds, found in document["verdicts"]
            )

    def _has_ended(self) -> None:
        if self.verdicts is None and not self.failed:
            self.failed = "its process ended by itself"
