"""Built-in runs for comparison with a program: same world, seed and step."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from typing import Final

from rl_tui.agents.catalogue import algorithm_row
from rl_tui.agents.compatibility import check_compatible
from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.common.errors import UserError
from rl_tui.runs.edited_world import EditedWorld
from rl_tui.runs.recipe import Recipe, SetParameter, Setting, changed_recipe
from rl_tui.runs.timeline.branches import RunRecord
from rl_tui.runs.timeline.branching_run import BranchingRun
from rl_tui.worlds.world import World

MOST: Final = 3
_PIECE: Final = 2_000
_UNHURRIED: Final = math.inf


class RunsBeside:
    """Up to three built-in runs that follow the shown step of the program."""

    def __init__(self, world: World, *, automatic: bool) -> None:
        self.world = world
        """World of the program and the runs."""
        self.runs: list[BranchingRun] = []
        self.names: list[str] = []
        self.marked = 0
        """Index of the run compared with the program."""
        self._automatic = automatic

    @property
    def beside(self) -> BranchingRun | None:
        """The run compared with the program, or None."""
        return self.runs[min(self.marked, len(self.runs) - 1)] if self.runs else None

    def add(self, recipe: Recipe, changes: Sequence[Setting]) -> None:
        """Add a run of `recipe` with `changes`. Raises UserError if it cannot work."""
        if len(self.runs) == MOST:
            raise UserError(f"your program already has {MOST} other runs; end one first")
        if self.world.mdp is None and self.world.new_environment is None:
            raise UserError("only your program can create this environment")
        recipe = changed_recipe(recipe, *changes)
        check_compatible(self.world.space, recipe.algorithm, recipe.hyperparameters)
        self.runs.append(BranchingRun(RunRecord(recipe), EditedWorld(self.world), time.perf_counter))
        self.names.append(_name(recipe, changes))
        self.marked = len(self.runs) - 1

    def drop(self, place: int) -> None:
        """End the run at index `place`."""
        if 0 <= place < len(self.runs):
            del self.runs[place], self.names[place]
            self.marked = max(0, min(self.marked, len(self.runs) - 1))

    def is_behind(self, step: int) -> bool:
        """Return True if a run is at another step."""
        return any(self._has_to_move(run, step) for run in self.runs)

    def follow(self, step: int, seconds: float) -> bool:
        """Move the runs to `step` for about `seconds` and return True if one moved."""
        until, has_moved = time.perf_counter() + seconds, False
        for run in self.runs:
            while self._has_to_move(run, step) and (
                not self._automatic or time.perf_counter() < until or not has_moved
            ):
                self._move(run, step)
                has_moved = True
        if self._automatic:
            loops = [run.run.learner.loop for run in self.runs if not run.run.learner.is_compiled]
            if loops:
                BACKGROUND.want(loops)
        return has_moved

    def _has_to_move(self, lane: BranchingRun, step: int) -> bool:
        here = lane.run.step
        return lane.seek is not None or here > step or (here < step and not lane.run.over)

    def _move(self, lane: BranchingRun, step: int) -> None:
        if lane.seek is None and (lane.run.step > step or lane.timeline.in_past):
            lane.seek_to(step=step)
        if lane.seek is not None:
            lane.continue_seek(_PIECE)
        run = lane.run
        if lane.seek is None and run.step < step and not lane.timeline.in_past:
            run.learner.set_time_budget(_UNHURRIED)
            lane.advance(min(_PIECE, step - run.step))


def _name(recipe: Recipe, changes: Sequence[Setting]) -> str:
    values = [f"{each.name} {each.value}" for each in changes if isinstance(each, SetParameter)]
    return " ".join([f"ours: {algorithm_row(recipe.algorithm).name}", *values])
