"""Runs side by side that advance to the same step."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from rl_tui.agents.catalogue import algorithm_row
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
from rl_tui.runs.timeline.playing import Playing
from rl_tui.runs.timeline.run_names import LanePast, difference, distinct, lane_names
from rl_tui.worlds.world import World

MOST: Final = 4
PROGRAM: Final = "your program"
ONLY_YOUR_PROGRAM: Final = "only your program can create this environment"


class RunGroup:
    """One to four runs of one scenario. The visible one leads; the others follow to its `step`.

    Built-in runs begin at the seed, and `resume` seeks their positions. A watched `program` is always the
    first run and leads; `seeking` is then true until the others have followed.
    """

    def __init__(
        self,
        records: Sequence[RunRecord],
        world: World,
        *,
        shown: int = 0,
        clock: Callable[[], float] = time.perf_counter,
        program: Playing | None = None,
    ) -> None:
        self.shown: int
        """Number of the visible run."""
        self.step = 0
        """Step that all runs follow to."""
        self._beside: Playing | None = None
        self._resumes = False
        self.first = EditedWorld(world) if program is None else program.run.edited
        """The world at the start, shared by all runs."""
        self._unit = "pull" if world.is_bandit else "step"
        self._pasts: list[LanePast] = []
        self._names: list[str] = []
        self._clock = clock
        self.program = program
        """The run of a watched program, or None."""
        self._runs: list[Playing] = [] if program is None else [program]
        self._runs += (self._new_run(record) for record in records)
        self.current: Playing
        self._others: list[Playing]
        self._lead(shown)

    def _lead(self, number: int) -> None:
        self.shown, self.current = number, self._runs[number]
        self._others = [run for run in self._runs if run is not self.current]

    @property
    def built_in(self) -> BranchingRun:
        """The visible run. Raises UserError for a watched program."""
        if not isinstance(self.current, BranchingRun):
            raise UserError("not available for a watched program")
        return self.current

    def replace_program(self, program: Playing) -> None:
        """Let `program` lead from its first step. The others go back to it."""
        self.program = self._runs[0] = program
        self._lead(0)
        self.seek_to(step=program.run.step)

    @property
    def beside(self) -> Playing | None:
        """The second visible run (the marked one, else the next), or None."""
        if self._beside in self._others:
            return self._beside
        return self._runs[(self.shown + 1) % len(self._runs)] if self._others else None

    def mark(self, number: int) -> None:
        """Make `number` the second visible run."""
        if 0 <= number < len(self._runs):
            self._beside = self._runs[number]

    @property
    def runs(self) -> tuple[Run, ...]:
        """All built-in runs at their current positions."""
        return tuple(each.run for each in self._branching)

    @property
    def _branching(self) -> list[BranchingRun]:
        return [each for each in self._runs if isinstance(each, BranchingRun)]

    def records(self, to_come: Sequence[Change] = ()) -> tuple[RunRecord, ...]:
        """Return the records after the changes `to_come` in the visible run."""
        shown = self.built_in.record_with(to_come, self._names_taken)
        return tuple(shown if each is self.current else each.record for each in self._runs)

    @property
    def interpreted_loops(self) -> list[Loop]:
        """Loops not compiled yet, the visible run's first."""
        lanes = [each for each in (self.current, *self._others) if isinstance(each, BranchingRun)]
        runs = [each.run if each.seek is None else each.seek.run for each in lanes]
        return [run.learner.loop for run in runs if not run.learner.is_compiled]

    @property
    def seeking(self) -> bool:
        """True if a run seeks or has to catch up."""
        return self.current.seek is not None or any(self._is_elsewhere(each) for each in self._others)

    @property
    def progress(self) -> tuple[int, int]:
        """Steps done by the seeking run, and steps to do."""
        if self.current.seek is not None:
            return self.current.seek.progress
        behind = next((each for each in self._others if self._is_elsewhere(each)), None)
        if behind is None:
            return 0, 0
        return (behind.run.step, self.step) if behind.seek is None else behind.seek.progress

    def advance(self, steps: int = UNLIMITED, episodes: int = UNLIMITED) -> None:
        """Advance the visible run. The others follow."""
        self.current.advance(steps, episodes)
        self.step = self.current.run.step
        if self._others and self.program is None:
            self.follow()

    def follow(self) -> None:
        """Advance the other runs to the step of the visible one."""
        self.step = self.current.run.step
        for each in self._others:
            each.run.learner.set_time_budget(math.inf)
            while each.run.step < self.step and not each.run.over:
                each.advance(self.step - each.run.step)

    def resume(self, records: Sequence[RunRecord]) -> None:
        """Seek the positions of `records`, from which these runs were made."""
        for each, record in zip(self._runs, records, strict=True):
            each.seek_to(step=record.step)
        self._resumes = True
        self.step = max(record.step for record in records)
        self._lead_if_there()

    def restarted(self, recipe: Recipe, *, keeps_edits: bool) -> tuple[RunRecord, ...]:
        """Return records for a restart: `recipe` for the visible run, current settings for the others.

        Runs that shared its seed share its new one. A run that already had that seed gets the old one. With
        `keeps_edits` each run begins in its current world.
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
        """Return the world at the position of `record`."""
        return self.first.after_all(record.world_changes, record.recipe)

    def seek_to(
        self, *, step: int | None = None, episode: int | None = None, branch: int | None = None
    ) -> None:
        """Let the visible run seek. The others follow."""
        self.current.seek_to(step=step, episode=episode, branch=branch)
        for each in self._others:
            each.stop_seek()  # their targets are outdated
        self._resumes = False
        self._lead_if_there()

    def gather(self) -> None:
        """Let the visible run lead again, unless it is over."""
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
        """Seek with one run by at most `steps` and return the steps taken."""
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
        """True if both visible trails are complete."""
        if not self._others:
            return not self.current.trail_to_find
        return not any(each.trail_to_find for each in self._on_view)

    def find_trails(self, seconds: float) -> None:
        """Complete both visible trails for about `seconds` (may be infinite)."""
        on_view = [each for each in self._on_view if each.trail_to_find]
        for each in on_view:
            each.find_trail(seconds / len(on_view))

    @property
    def _on_view(self) -> list[Playing]:
        return [each for each in (self.current, self.beside) if each is not None]

    def stop_seek(self) -> None:
        """Stop seeking. The others follow to this position."""
        self.current.stop_seek()
        self.step = self.current.run.step

    def add(self, changes: Sequence[Setting], *, next_seed: bool = False) -> None:
        """Add a run that differs from the visible one by `changes`, or by an unused `next_seed`.

        It repeats the journal, except changes of these settings and actions of the user, and ordered sweeps
        for another algorithm. Raises UserError.
        """
        self._check_room()
        model, step = self.current, self.step
        if not model.run.world.is_remade:
            raise UserError(ONLY_YOUR_PROGRAM)
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
        """Add a branch of the visible run, with all its actions, as the second visible one.

        Raises UserError.
        """
        self._check_room()
        model = self.built_in
        timeline = model.timeline
        if not 0 <= number < len(timeline.branches):
            raise UserError(f"there is no branch {number + 1}: choose 1 to {len(timeline.branches)}")
        branch = timeline.branches[number]
        if number == timeline.branch:
            raise UserError(f"{branch.name} is the run shown; choose another one to compare with it")
        alone = replace(branch, parent=None, fork=0, here=0)
        added = self._new_run(RunRecord(model.recipe, (alone,)))
        self._let_catch_up(added)
        self._beside = added

    def _check_room(self) -> None:
        if len(self._runs) == MOST:
            raise UserError(f"there are {MOST} runs already; end one first")

    def _let_catch_up(self, added: BranchingRun) -> None:
        self._runs.append(added)
        self._others.append(added)
        added.seek_to(step=self.step)
        if self.program is not None:
            self._beside = added

    def show(self, number: int) -> None:
        """Make another run visible."""
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
                self._beside = None  # release its memory
            del self._runs[number]
            self._lead(self.shown - (number < self.shown or self.shown == len(self._runs)))
            if self.current.seek is None:
                self.step = max(each.run.step for each in self._runs)
                self.gather()

    def apply(self, change: Change) -> None:
        """Make a change in the visible run, which then leads. Raises UserError."""
        assert isinstance(self.current, BranchingRun)  # programs refuse changes
        self.current.apply(change, self._names_taken)
        self.gather()

    def _names_taken(self) -> list[str]:
        others = [each for each in self._branching if each is not self.current]
        kin = [each for each in others if each.recipe == self.current.recipe]
        return [each.name for run in kin for each in run.timeline.branches]

    @property
    def view(self) -> RunGroupView:
        """All runs side by side, empty if there is only one."""
        if len(self._runs) == 1:
            return RunGroupView()
        pasts = [_past(each) for each in self._runs]
        if pasts != self._pasts:  # skip long journals in the many frames without a change
            self._pasts, self._names = pasts, self._names_of(pasts)
        named = zip(self._runs, self._names, pasts, strict=True)
        views = tuple(_view(each, name, past) for each, name, past in named)
        beside = None if self.beside is None else self._runs.index(self.beside)
        return RunGroupView(views, self.shown, beside)

    def _names_of(self, pasts: Sequence[LanePast]) -> list[str]:
        if self.program is None:
            return lane_names(pasts, self._unit)
        own, *others = (past.now for past in pasts)
        names = []
        for each in others:
            settings = difference(replace(own, algorithm=each.algorithm), each)
            names.append(", ".join(filter(None, (f"ours: {algorithm_row(each.algorithm).name}", settings))))
        return [PROGRAM, *distinct(names)]

    def _is_elsewhere(self, lane: Playing) -> bool:
        step = lane.run.step
        return lane.seek is not None or step > self.step or (step < self.step and not lane.run.over)

    def _new_run(self, record: RunRecord) -> BranchingRun:
        return BranchingRun(record, self.first, self._clock)


def _subject(change: Change) -> str:
    if isinstance(change, SetParameter):
        return change.name
    if isinstance(change, WorldChange):
        return "world"
    return "algorithm" if isinstance(change, SwitchAlgorithm | OrderSweep) else ""


def _check(world: World, recipe: Recipe, journal: Sequence[JournalEntry]) -> None:
    check_compatible(world.space, recipe.algorithm, recipe.hyperparameters)
    for entry in journal:
        if isinstance(entry.change, Setting):
            recipe = changed_recipe(recipe, entry.change)
            check_compatible(world.space, recipe.algorithm, recipe.hyperparameters)


def _recipe_now(lane: Playing) -> Recipe:
    learner = lane.run.learner
    return replace(lane.recipe, algorithm=learner.algorithm, hyperparameters=learner.hyperparameters)


def _past(lane: Playing) -> LanePast:
    branch = lane.timeline.current
    return LanePast(lane.recipe, _recipe_now(lane), branch.name, branch.journal)


def _view(lane: Playing, name: str, past: LanePast) -> LaneView:
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
