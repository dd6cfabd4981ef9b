"""Runs side by side that advance to the same step."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from rl_tui.agents.compatibility import check_compatible
from rl_tui.common.errors import UserError
from rl_tui.lab.live.record import Record
from rl_tui.lab.live.snapshot import LaneView
from rl_tui.lab.live.viewport import is_large
from rl_tui.lab.run.recipe import (
    Beginning,
    Change,
    JournalEntry,
    Recipe,
    SetParameter,
    SwitchAlgorithm,
    TakeAction,
    begin,
)
from rl_tui.lab.run.run import UNLIMITED, Run
from rl_tui.lab.timeline.branches import Branch
from rl_tui.lab.timeline.branching_run import BranchingRun
from rl_tui.lab.timeline.run_names import run_names
from rl_tui.lab.timeline.run_record import RunRecord
from rl_tui.worlds.world import World

MOST: Final = 4
Difference = SetParameter | SwitchAlgorithm


class RunGroup:
    """One to four lanes of one scenario and seed; ``shown`` is the number of the one in force.

    That one leads: the others follow to ``step``, where it stands, unless they are over before. Each of
    ``records`` begins at the seed: go to where it stood. ``clock`` gives seconds.
    """

    def __init__(
        self, records: Sequence[RunRecord], world: World, *, clock: Callable[[], float] = time.perf_counter
    ) -> None:
        self.shown = 0
        self.step = 0
        self._resumes = False
        self._world = world
        self._clock = clock
        self._lanes = [self._new_lane(record) for record in records]

    @property
    def current(self) -> BranchingRun:
        """The one in force."""
        return self._lanes[self.shown]

    @property
    def records(self) -> tuple[RunRecord, ...]:
        """What is needed to come back to here."""
        return tuple(lane.record for lane in self._lanes)

    @property
    def cold_runs(self) -> Iterator[Run]:
        """The runs whose loop is not loaded yet."""
        return (lane.run for lane in self._lanes if not lane.run.learner.is_warm)

    @property
    def travel(self) -> bool:
        """Whether any is on the way to another moment, or has to catch up."""
        return self.current.travels or any(self._is_elsewhere(lane) for lane in self._others)

    @property
    def progress(self) -> tuple[int, int]:
        """How many steps are done of all that is on the way, and of how many."""
        if self.current.travels:
            return self.current.progress
        behind = next((lane for lane in self._others if self._is_elsewhere(lane)), None)
        if behind is None:
            return 0, 0
        return behind.progress if behind.travels else (behind.step, self.step)

    def advance(self, steps: int = UNLIMITED, episodes: int = UNLIMITED) -> None:
        """Let the one in force go on by ``steps`` or ``episodes``, and the others follow."""
        self.current.advance(steps, episodes)
        self.follow()

    def follow(self) -> None:
        """Let the others come to where the one in force stands now."""
        self.step = self.current.step
        for lane in self._others:
            if lane.step < self.step:
                lane.run.learner.set_time_budget(math.inf)
                lane.advance(self.step - lane.step)

    def resume(self, record: Record) -> None:
        """Set out for where the lanes of ``record`` stood, of which these were made."""
        for lane, known in zip(self._lanes, record.lanes, strict=True):
            if known.branches:
                lane.go_to(step=known.step)
        self._resumes = True
        self.step = max(known.step for known in record.lanes)
        self._arrive_if_there()

    def restarted(self, recipe: Recipe) -> tuple[RunRecord, ...]:
        """Return lanes that begin again: the one in force with ``recipe``, the others as they are now."""
        recipes = [replace(_recipe_now(lane), seed=recipe.seed) for lane in self._lanes]
        recipes[self.shown] = recipe
        return tuple(RunRecord(each, ()) for each in recipes)

    def go_to(
        self, *, step: int | None = None, episode: int | None = None, branch: int | None = None
    ) -> None:
        """Let the one in force set out for another moment, as :meth:`BranchingRun.go_to` does."""
        self.current.go_to(step=step, episode=episode, branch=branch)
        for lane in self._others:
            lane.stay()  # where it was going is no longer where it has to be
        self._resumes = False
        self._arrive_if_there()

    def gather(self) -> None:
        """Let the one in force lead again, unless it is over: then the others stay as far as they are."""
        if not self.current.run.over:
            self.step = self.current.step

    def _arrive_if_there(self) -> None:
        if self.current.travels:
            return
        if self._resumes:
            self._resumes = False
            self.gather()
        else:
            self.step = self.current.step

    def work_off(self, steps: int) -> int:
        """Bring whoever is elsewhere nearer to where it has to be, by at most ``steps``; return how many."""
        if self.current.travels:
            taken = self.current.travel(steps)
            self._arrive_if_there()
            return taken
        lane = next((each for each in self._others if self._is_elsewhere(each)), None)
        if lane is None:
            return 0
        if not lane.travels and (lane.step > self.step or lane.timeline.in_past):
            lane.go_to(step=self.step)
        if lane.travels:
            return lane.travel(steps)
        before = lane.step
        lane.advance(max(0, min(steps, self.step - before)))
        return lane.step - before

    def stay(self) -> None:
        """Give up whatever is on the way; the others follow to where the one in force stands."""
        self.current.stay()
        self.step = self.current.step

    def add(self, changes: Sequence[Difference]) -> None:
        """Begin a lane that differs from the one in force by ``changes``, from the start.

        It keeps what was changed on the way, but for what differs, and but for steps taken by a person.
        Raises UserError where there is no room for another, or it cannot work.
        """
        if len(self._lanes) == MOST:
            raise UserError(f"there are {MOST} lanes already; end one first")
        model, step = self.current, self.step
        recipe = model.recipe
        for change in changes:
            recipe = changed(recipe, change)
        left_out = {"", *(_subject(change) for change in changes)}
        journal = tuple(entry for entry in model.run.journal if _subject(entry.change) not in left_out)
        _check(self._world, recipe, journal)
        self._lanes.append(self._new_lane(RunRecord(recipe, (Branch("branch 1", journal, end=step),))))
        self._lanes[-1].go_to(step=step)

    def show(self, lane: int) -> None:
        """Let another one be in force."""
        if 0 <= lane < len(self._lanes):
            self.current.watch(None)
            self.shown = lane

    def drop(self, lane: int) -> None:
        """End one, unless it is the only one."""
        if len(self._lanes) > 1 and 0 <= lane < len(self._lanes):
            self.current.watch(None)
            del self._lanes[lane]
            self.shown -= lane < self.shown or self.shown == len(self._lanes)
            if not self.current.travels:
                self.step = max(each.step for each in self._lanes)
                self.gather()

    def views(self) -> tuple[LaneView, ...]:
        """Return how each is getting on; nothing where there is one."""
        if len(self._lanes) == 1:
            return ()
        names = run_names([_recipe_now(lane) for lane in self._lanes])
        return tuple(_view(lane, name) for lane, name in zip(self._lanes, names, strict=True))

    @property
    def _others(self) -> list[BranchingRun]:
        return [lane for lane in self._lanes if lane is not self.current]

    def _is_elsewhere(self, lane: BranchingRun) -> bool:
        return lane.travels or lane.step > self.step or (lane.step < self.step and not lane.run.over)

    def _new_lane(self, record: RunRecord) -> BranchingRun:
        streams = begin(record.recipe, self._world).streams
        beginning = Beginning(self._world, streams)
        return BranchingRun(
            record.recipe, beginning, branches=record.branches, branch=record.branch, clock=self._clock
        )


def changed(recipe: Recipe, change: Difference) -> Recipe:
    """Return ``recipe`` with ``change`` from the start. Raises UserError where the value does not fit."""
    if isinstance(change, SwitchAlgorithm):
        return replace(recipe, algorithm=change.algorithm)
    try:
        return replace(recipe, hyperparameters=recipe.hyperparameters.changed(change.name, change.value))
    except ValueError as fault:
        raise UserError(str(fault)) from fault


def _subject(change: Change) -> str:
    """Return what ``change`` is about, empty for a step taken by a person."""
    if isinstance(change, SetParameter):
        return change.name
    return "algorithm" if isinstance(change, SwitchAlgorithm) else ""


def _check(world: World, recipe: Recipe, journal: Sequence[JournalEntry]) -> None:
    """Raise UserError where the recipe, or what its journal makes of it, cannot work in ``world``."""
    for each in (None, *journal):
        if each is not None and not isinstance(each.change, TakeAction):
            recipe = changed(recipe, each.change)
        check_compatible(world.space, recipe.algorithm, recipe.hyperparameters)


def _recipe_now(lane: BranchingRun) -> Recipe:
    learner = lane.run.learner
    return replace(lane.recipe, algorithm=learner.algorithm, hyperparameters=learner.hyperparameters)


def _view(lane: BranchingRun, name: str) -> LaneView:
    run, learner = lane.run, lane.run.learner
    return LaneView(
        name=name,
        algorithm=learner.algorithm,
        hyperparameters=learner.hyperparameters,
        step=run.step,
        episodes=learner.episodes,
        q=np.empty(0) if is_large(run.world) else learner.q.copy(),
        curve=run.history.curve(),
        marks=run.marks,
        return_last_100=run.history.return_last_100,
        greedy_return=run.greedy_return,
    )
