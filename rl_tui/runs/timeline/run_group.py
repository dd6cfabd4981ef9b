"""Runs side by side that advance to the same step."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from rl_tui.agents.compatibility import check_compatible
from rl_tui.agents.kernels.machine_code import Loop
from rl_tui.common.errors import UserError
from rl_tui.runs.edited_world import EditedWorld
from rl_tui.runs.large_worlds import is_large
from rl_tui.runs.recipe import (
    SEED_DRAWS_WORLD,
    UNLIMITED,
    Change,
    JournalEntry,
    OrderSweep,
    Recipe,
    SetParameter,
    Setting,
    SwitchAlgorithm,
    WorldChange,
    changed_recipe,
)
from rl_tui.runs.run import Run
from rl_tui.runs.timeline.branches import FIRST, Branch, RunRecord
from rl_tui.runs.timeline.branching_run import BranchingRun
from rl_tui.runs.timeline.lane_view import LaneView, RunGroupView
from rl_tui.runs.timeline.run_names import LanePast, lane_names
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.world import World

MOST: Final = 4


class RunGroup:
    """One to four branching runs of one scenario: the lanes of a playground.

    The one shown leads: the others follow to ``step``, where it stands, unless they are over before. Each of
    ``records`` begins at the seed: :meth:`resume` seeks where it stood. ``clock`` gives seconds.
    """

    def __init__(
        self,
        records: Sequence[RunRecord],
        world: World,
        *,
        shown: int = 0,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.shown: int
        """The number of the run shown."""
        self.step = 0
        """The step at which all are to stand."""
        self._beside: BranchingRun | None = None
        self._resumes = False
        self.first = EditedWorld(world)
        """The world that all of them began in."""
        self._unit = "pull" if isinstance(world.drawing, Arms) else "step"
        self._pasts: list[LanePast] = []
        self._names: list[str] = []
        self._clock = clock
        self._runs = [self._new_run(record) for record in records]
        self.current: BranchingRun
        """The run shown."""
        self._others: list[BranchingRun]
        self._lead(shown)

    def _lead(self, number: int) -> None:
        """Let the run with this ``number`` be shown, and lead."""
        self.shown, self.current = number, self._runs[number]
        self._others = [run for run in self._runs if run is not self.current]

    @property
    def beside(self) -> BranchingRun | None:
        """The run that stands beside the one shown: the one marked, else the next; None if it is alone."""
        if self._beside in self._others:
            return self._beside
        return self._runs[(self.shown + 1) % len(self._runs)] if self._others else None

    def mark(self, number: int) -> None:
        """Let the run with this ``number`` stand beside the one shown."""
        if 0 <= number < len(self._runs):
            self._beside = self._runs[number]

    @property
    def runs(self) -> tuple[Run, ...]:
        """Every run as it stands."""
        return tuple(each.run for each in self._runs)

    def records(self, to_come: Sequence[Change] = ()) -> tuple[RunRecord, ...]:
        """Return what is needed to come back to here, once the run shown has made the changes ``to_come``."""
        shown = self.current.record_with(to_come, self._names_taken)
        return tuple(shown if each is self.current else each.record for each in self._runs)

    @property
    def interpreted_loops(self) -> list[Loop]:
        """Which loops of its runs are not there as machine code yet, that of the run shown first."""
        runs = [each.run if each.seek is None else each.seek.run for each in (self.current, *self._others)]
        return [run.learner.loop for run in runs if not run.learner.is_compiled]

    @property
    def seeking(self) -> bool:
        """Whether any seeks another step, or has to catch up."""
        return self.current.seek is not None or any(self._is_elsewhere(each) for each in self._others)

    @property
    def progress(self) -> tuple[int, int]:
        """How many steps are done by the one that is seeking now, and of how many."""
        if self.current.seek is not None:
            return self.current.seek.progress
        behind = next((each for each in self._others if self._is_elsewhere(each)), None)
        if behind is None:
            return 0, 0
        return (behind.run.step, self.step) if behind.seek is None else behind.seek.progress

    def advance(self, steps: int = UNLIMITED, episodes: int = UNLIMITED) -> None:
        """Let the one shown advance by ``steps`` or ``episodes``, and the others follow."""
        self.current.advance(steps, episodes)
        self.step = self.current.run.step
        if self._others:
            self.follow()

    def follow(self) -> None:
        """Let the others come to where the one shown stands now."""
        self.step = self.current.run.step
        for each in self._others:
            each.run.learner.set_time_budget(math.inf)
            while each.run.step < self.step and not each.run.over:
                each.advance(self.step - each.run.step)

    def resume(self, records: Sequence[RunRecord]) -> None:
        """Begin to seek where the runs of ``records`` stood, of which these were made."""
        for each, record in zip(self._runs, records, strict=True):
            each.seek_to(step=record.step)
        self._resumes = True
        self.step = max(record.step for record in records)
        self._lead_if_there()

    def restarted(self, recipe: Recipe, *, keeps_edits: bool) -> tuple[RunRecord, ...]:
        """Return runs that begin again: the one shown with ``recipe``, the others as they are now.

        Those that had its seed go on to have it. One that had the seed which it takes gets the one given up,
        so that seeds which differ go on to differ. Where it ``keeps_edits``, each begins in its world as it
        is now: what was edited on the way comes at the start.
        """
        before = self.current.recipe.seed
        seeds = {recipe.seed: before, before: recipe.seed}
        now = map(_recipe_now, self._runs)
        recipes = [replace(each, seed=seeds.get(each.seed, each.seed)) for each in now]
        recipes[self.shown] = recipe
        edits = [each.record.world_changes if keeps_edits else [] for each in self._runs]
        journals = [tuple(JournalEntry(0, change) for change in changes) for changes in edits]
        return tuple(
            RunRecord(each, (replace(FIRST, journal=journal),))
            for each, journal in zip(recipes, journals, strict=True)
        )

    def world_of(self, record: RunRecord) -> EditedWorld:
        """Return the world in which the run of ``record``, one of these, was left."""
        return self.first.after_all(record.world_changes, record.recipe)

    def seek_to(
        self, *, step: int | None = None, episode: int | None = None, branch: int | None = None
    ) -> None:
        """Let the one shown begin to seek, as :meth:`BranchingRun.seek_to` does; the others follow."""
        self.current.seek_to(step=step, episode=episode, branch=branch)
        for each in self._others:
            each.stop_seek()  # where it was going is no longer where it has to be
        self._resumes = False
        self._lead_if_there()

    def gather(self) -> None:
        """Let the one shown lead again, unless it is over: then the others stay as far as they are."""
        if not self.current.run.over:
            self.step = self.current.run.step

    def _lead_if_there(self) -> None:
        if self.current.seek is not None:
            return
        if self._resumes:
            self._resumes = False
            self.gather()
        else:
            self.step = self.current.run.step

    def continue_seek(self, steps: int) -> int:
        """Bring the next run that is elsewhere nearer to where it has to be, by at most ``steps``.

        Returns how many were taken.
        """
        if self.current.seek is not None:
            taken = self.current.continue_seek(steps)
            self._lead_if_there()
            return taken
        lane = next((each for each in self._others if self._is_elsewhere(each)), None)
        if lane is None:
            return 0
        if lane.seek is None and (lane.run.step > self.step or lane.timeline.in_past):
            lane.seek_to(step=self.step)
        if lane.seek is not None:
            return lane.continue_seek(steps)
        before = lane.run.step
        lane.advance(max(0, min(steps, self.step - before)))
        return lane.run.step - before

    @property
    def trails_are_whole(self) -> bool:
        """Whether nothing more can be found out of how the episodes of the two runs on view went."""
        return not any(each.trail_to_find for each in self._on_view)

    def find_trails(self, seconds: float) -> None:
        """Find out for about ``seconds``, or infinity, how the episodes of the two runs on view went."""
        on_view = self._on_view
        for each in on_view:
            each.find_trail(seconds / len(on_view))

    @property
    def _on_view(self) -> list[BranchingRun]:
        """The run shown and the one beside it."""
        return [each for each in (self.current, self.beside) if each is not None]

    def stop_seek(self) -> None:
        """Seek no further; the others follow to where the one shown stands."""
        self.current.stop_seek()
        self.step = self.current.run.step

    def add(self, changes: Sequence[Setting], *, next_seed: bool = False) -> None:
        """Add a run that differs from the one shown by ``changes`` from the start.

        With ``next_seed`` its seed is one more than the largest of all runs, else that of the one shown.
        It keeps what was changed on the way, the world too, but for what differs, and but for steps taken by
        a person; with another algorithm also but for sweeps that were ordered. Raises UserError where there
        is no room for another, or it cannot work.
        """
        self._check_room()
        model, step = self.current, self.step
        recipe = changed_recipe(model.recipe, *changes)
        if next_seed:
            recipe = replace(recipe, seed=1 + max(each.recipe.seed for each in self._runs))
            if recipe.scenario.section.drawn_from_seed:
                raise UserError(SEED_DRAWS_WORLD)
        left_out = {"", *(_subject(change) for change in changes)}
        journal = tuple(entry for entry in model.run.journal if _subject(entry.change) not in left_out)
        for world in (self.first.world, model.run.world):
            _check(world, recipe, journal)
        added = self._new_run(RunRecord(recipe, (Branch("branch 1", journal, end=step),)))
        self._let_catch_up(added)

    def add_branch(self, number: int) -> None:
        """Add a run that is the branch with this ``number`` of the one shown, and let it stand beside that.

        All that was done on the branch is done in it, steps of a person too. It is a run of its own: what is
        changed in one of the two is not changed in the other. It comes to the step where all are to stand,
        beyond the end of the branch as the branch would. Raises UserError where there is no room for another,
        or no such branch, or it is the one in force.
        """
        self._check_room()
        timeline = self.current.timeline
        if not 0 <= number < len(timeline.branches):
            raise UserError(f"there is no branch {number + 1} here: they are 1 to {len(timeline.branches)}")
        branch = timeline.branches[number]
        if number == timeline.branch:
            raise UserError(f"{branch.name} is what is shown: choose another to stand beside it")
        alone = replace(branch, parent=None, fork=0, here=0)
        added = self._new_run(RunRecord(self.current.recipe, (alone,)))
        self._let_catch_up(added)
        self._beside = added

    def _check_room(self) -> None:
        if len(self._runs) == MOST:
            raise UserError(f"there are {MOST} runs already; end one first")

    def _let_catch_up(self, added: BranchingRun) -> None:
        self._runs.append(added)
        self._others.append(added)
        added.seek_to(step=self.step)

    def show(self, number: int) -> None:
        """Show another run."""
        if 0 <= number < len(self._runs):
            self.current.watch(None)
            if self.beside is self._runs[number]:
                self._beside = self.current  # the two change places
            self._lead(number)

    def drop(self, number: int) -> None:
        """End a run, unless it is the only one."""
        if len(self._runs) > 1 and 0 <= number < len(self._runs):
            self.current.watch(None)
            if self._beside is self._runs[number]:
                self._beside = None  # or else it would stay in memory
            del self._runs[number]
            self._lead(self.shown - (number < self.shown or self.shown == len(self._runs)))
            if self.current.seek is None:
                self.step = max(each.run.step for each in self._runs)
                self.gather()

    def apply(self, change: Change) -> None:
        """Change something in the run shown, which leads again. Raises UserError where it does not fit.

        The name of a branch that begins is new among all lanes that began alike, be they branches of one run.
        """
        self.current.apply(change, self._names_taken)
        self.gather()

    def _names_taken(self) -> list[str]:
        kin = [each for each in self._others if each.recipe == self.current.recipe]
        return [each.name for run in kin for each in run.timeline.branches]

    @property
    def view(self) -> RunGroupView:
        """How each is getting on; nothing where there is one."""
        if len(self._runs) == 1:
            return RunGroupView()
        pasts = [_past(each) for each in self._runs]
        if pasts != self._pasts:  # a journal may be long, and frames are many
            self._pasts, self._names = pasts, lane_names(pasts, self._unit)
        named = zip(self._runs, self._names, pasts, strict=True)
        views = tuple(_view(each, name, past) for each, name, past in named)
        beside = None if self.beside is None else self._runs.index(self.beside)
        return RunGroupView(views, self.shown, beside)

    def _is_elsewhere(self, lane: BranchingRun) -> bool:
        step = lane.run.step
        return lane.seek is not None or step > self.step or (step < self.step and not lane.run.over)

    def _new_run(self, record: RunRecord) -> BranchingRun:
        return BranchingRun(record, self.first, self._clock)


def _subject(change: Change) -> str:
    """Return what ``change`` is about, empty for a step taken by a person."""
    if isinstance(change, SetParameter):
        return change.name
    if isinstance(change, WorldChange):
        return "world"
    return "algorithm" if isinstance(change, SwitchAlgorithm | OrderSweep) else ""


def _check(world: World, recipe: Recipe, journal: Sequence[JournalEntry]) -> None:
    """Raise UserError where the recipe, or what its journal sets in it, cannot work in ``world``."""
    check_compatible(world.space, recipe.algorithm, recipe.hyperparameters)
    for entry in journal:
        if isinstance(entry.change, Setting):
            recipe = changed_recipe(recipe, entry.change)
            check_compatible(world.space, recipe.algorithm, recipe.hyperparameters)


def _recipe_now(lane: BranchingRun) -> Recipe:
    learner = lane.run.learner
    return replace(lane.recipe, algorithm=learner.algorithm, hyperparameters=learner.hyperparameters)


def _past(lane: BranchingRun) -> LanePast:
    branch = lane.timeline.current
    return LanePast(lane.recipe, _recipe_now(lane), branch.name, branch.journal)


def _view(lane: BranchingRun, name: str, past: LanePast) -> LaneView:
    run, learner = lane.run, lane.run.learner
    return LaneView(
        name=name,
        algorithm=learner.algorithm,
        hyperparameters=learner.hyperparameters,
        step=run.step,
        episodes=learner.episodes,
        q=np.empty(0) if is_large(run.world) else learner.q.copy(),
        results=run.results,
        past=past,
    )
