"""The progress of a watched program after any recorded step."""

from __future__ import annotations

from bisect import bisect_right
from copy import copy
from itertools import pairwise
from typing import Final, NamedTuple, Self

import numpy as np

from rl_tui.programs.watched.program_world import ProgramWorld
from rl_tui.programs.watched.recording import ChangeColumns, Recording, StepColumns
from rl_tui.runs.evaluation import NO_FIGURES, Evaluation, GreedyEarnings, GreedyReturn
from rl_tui.runs.history import History
from rl_tui.runs.results import RunResults
from rl_tui.runs.timeline.table_samples import CellHistory
from rl_tui.worlds.mdp.space import FloatArray, IntArray

# Progress after a step


PIECE: Final = 20_000
"""Most steps between two looks at the clock."""
_TIES: Final = "random"  # a program's choice among ties is unknown, so they are shared equally


class _UnderWay(NamedTuple):
    episode: int
    earned: float
    length: int
    has_ended: bool


class ProgramState:
    """A program after `step` steps of `recording`. The bits do not depend on how the steps are divided.

    `table`, `[cells]`, is the program's, with NaN for missing entries, or None while none was found.
    `visits`, `[P]`, counts how often each pair was taken.
    """

    def __init__(self, recording: Recording, world: ProgramWorld) -> None:
        self.recording = recording
        self.world = world
        self.step = 0
        self.episodes = 0
        """Finished episodes, including those that the program left early."""
        self.ended_at = 0
        """Step at which the last of them was finished, 0 before the first."""
        self.table: FloatArray | None = None
        self.visits: IntArray = np.zeros(world.world.space.pairs, np.int64)
        self._changes_until = 0  # the table includes changes of earlier steps
        self._q: FloatArray | None = None  # until the table changes
        self._greedy: GreedyEarnings | None = None  # the same
        self._under_way: dict[int, _UnderWay] = {}  # by environment
        self._history = History()
        mdp = world.world.mdp
        self._greedy_return = GreedyReturn(lambda: mdp)
        self._evaluation = Evaluation(mdp, self._greedy_return)

    @property
    def q(self) -> FloatArray:
        """Our estimates, `[P]`, or 0."""
        if self._q is None:
            self._q = np.zeros(len(self.visits)) if self.table is None else self.world.q_of(self.table)
        return self._q

    @property
    def results(self) -> RunResults:
        """Results so far."""
        mean_return, mean_length = self._history.last_100
        if self._greedy is None:
            has_table = self.table is not None
            self._greedy = self._greedy_return.figures(self.q, _TIES, None) if has_table else NO_FIGURES
        return RunResults(
            curve=self._history.curve(),
            marks=self._evaluation.marks(),
            return_last_100=mean_return,
            length_last_100=mean_length,
            greedy_return=self._greedy.expected_return,
            greedy_ends=self._greedy.ends,
        )

    def go_on(self, until: int) -> None:
        """Advance to the step `until`."""
        while True:
            self._take_changes()
            mark = self._evaluation.next_step
            # without a table, a mark is taken only when the progress moves on
            while mark is not None and mark <= self.step and (self.step < until or self.table is not None):
                self._evaluation.mark(self.episodes, None if self.table is None else self.q, _TIES)
                mark = self._evaluation.next_step
            if self.step >= until:
                return
            stop = min(until, self.step + PIECE)
            self._take_steps(stop if mark is None else min(stop, mark))

    def copied(self) -> Self:
        """Return another progress of the same program."""
        other, mdp = copy(self), self.world.world.mdp
        other.table = None if self.table is None else self.table.copy()
        other.visits, other._under_way = self.visits.copy(), dict(self._under_way)
        other._q = other._greedy = None
        other._history, other._greedy_return = History(), GreedyReturn(lambda: mdp)
        other._evaluation = Evaluation(mdp, other._greedy_return)
        other._history.restore(self._history.checkpoint())
        other._evaluation.restore(self._evaluation.checkpoint())
        return other

    def _take_changes(self) -> None:
        recording = self.recording
        if self.table is None:
            if recording.initial is None or recording.found_at > self.step:
                return
            self.table, self._changes_until = recording.initial.copy(), recording.found_at
            self._q = self._greedy = None
        if self._changes_until < self.step:
            changes = recording.changes
            begin, end = np.searchsorted(changes.step, (self._changes_until, self.step))
            self._changes_until = self.step
            if begin < end:
                self.table[changes.cell[begin:end]] = changes.after[begin:end]
                self._q = self._greedy = None

    def _take_steps(self, stop: int) -> None:
        steps = steps_between(self.recording, self.step, stop)
        pair_of_cell = self.world.pair_of_cell
        actions = len(self.world.world.space.action_names)
        cells = steps.state * actions + steps.action
        pairs = pair_of_cell[np.clip(cells, 0, len(pair_of_cell) - 1)]
        np.add.at(self.visits, pairs[pairs >= 0], 1)
        finished = self._finished(steps)
        self.episodes += len(finished)
        if finished:
            self.ended_at = self.step + finished[-1][0] + 1
        self._history.add(
            np.array([each[1] for each in finished]), np.array([each[2] for each in finished], np.int64)
        )
        self.step = stop

    def ends_until(self, stop: int) -> list[int]:
        """Return the step at which each episode ends, up to `stop`. Call it on a copy, which it changes."""
        steps = steps_between(self.recording, self.step, stop)
        return [self.step + place + 1 for place, _, _ in self._finished(steps)]

    def _finished(self, steps: StepColumns) -> list[tuple[int, float, int]]:
        found: list[tuple[int, float, int]] = []
        order = np.argsort(steps.environment, kind="stable")
        episode, ended = steps.episode[order], (steps.terminated | steps.truncated)[order]
        begins = np.flatnonzero(np.diff(episode, prepend=-1)).tolist()
        for first, last in pairwise((*begins, len(order))):
            number, environment = int(episode[first]), int(steps.environment[order[first]])
            before = self._under_way.get(environment)
            earned, length = 0.0, last - first
            if before is not None and before.episode == number:
                earned, length = before.earned, before.length + length
            elif before is not None and not before.has_ended:
                found.append((int(order[first]), before.earned, before.length))
            for reward in steps.reward[order[first:last]].tolist():
                earned += reward
            has_ended = bool(ended[last - 1])
            if has_ended:
                found.append((int(order[last - 1]), earned, length))
            self._under_way[environment] = _UnderWay(number, earned, length, has_ended)
        return sorted(found)


def steps_between(recording: Recording, first: int, last: int) -> StepColumns:
    """Return the recorded steps in [first, last)."""
    begin, end = max(first - recording.first, 0), max(last - recording.first, 0)
    return StepColumns._make(column[begin:end] for column in recording.steps)


# Going back in the recording


_MOST: Final = 32
_FIRST_SPACING: Final = 1_000
_MOST_SAMPLES: Final = 256


class ProgramHistory:
    """The newest moment of a program, the shown one, and stored moments."""

    def __init__(self, recording: Recording, world: ProgramWorld) -> None:
        self.recording = recording
        self.newest = ProgramState(recording, world)
        self.shown = self.newest
        self.first_step = 0
        """First step that can still be shown."""
        self._spacing = _FIRST_SPACING
        self._kept = [self.newest.copied()]
        self._followed: tuple[int, int, int] = (-1, 0, 0)
        self._places: IntArray = np.empty(0, np.int64)
        self._looked_at = 0

    @property
    def in_past(self) -> bool:
        """True if an earlier moment is shown."""
        return self.shown is not self.newest

    def go_on(self, until: int) -> None:
        """Advance the newest moment to the step `until`."""
        newest = self.newest
        while newest.step < until:
            newest.go_on(min(until, self._kept[-1].step + self._spacing))
            if newest.step == self._kept[-1].step + self._spacing:
                self._keep()
        newest.go_on(until)  # a table may have been found meanwhile
        kept = (each.step for each in self._kept if each.step >= self.recording.first)
        self.first_step = next(kept, newest.step)

    def show(self, step: int) -> None:
        """Show the nearest known moment to `step`."""
        step = max(step, self.first_step)
        if step >= self.newest.step:
            self.shown = self.newest
            return
        place = bisect_right([each.step for each in self._kept], step) - 1
        self.shown = self._kept[max(place, 0)].copied()
        self.shown.go_on(step)

    def begin_of_episode(self, number: int) -> int:
        """Return the first step of episode `number` (from 1), or the newest step."""
        wanted = number - 1
        first = next((each for each in self._kept[::-1] if each.episodes < wanted), self._kept[0])
        if first.step < self.recording.first:
            return self.first_step
        if self.newest.episodes < wanted:
            return self.newest.step
        if first.episodes >= wanted:
            return first.step
        until = next((each.step for each in self._kept if each.episodes >= wanted), self.newest.step)
        return first.copied().ends_until(until)[wanted - first.episodes - 1]

    def cell(self, pair: int) -> CellHistory | None:
        """Return the estimate's history up to the shown moment."""
        shown, recording = self.shown, self.recording
        cells = shown.world.cell_of_pair
        if shown.table is None or not 0 <= pair < len(cells):
            return None
        changes = recording.changes
        mine = self._changes_of(int(cells[pair]), changes)
        mine = mine[: int(np.searchsorted(changes.step[mine], shown.step))]
        now = float(np.nan_to_num(shown.table[cells[pair]]))
        first = now if not len(mine) else float(np.nan_to_num(changes.before[mine[0]]))
        if len(mine) > _MOST_SAMPLES:
            mine = mine[np.linspace(0, len(mine) - 1, _MOST_SAMPLES).astype(np.int64)]
        step = np.concatenate(([self.first_step], changes.step[mine] + 1, [shown.step]))
        value = np.concatenate(([first], changes.after[mine], [now]))
        last_of_step = np.append(np.diff(step) > 0, True)
        return CellHistory(pair, step[last_of_step], value[last_of_step])

    def _changes_of(self, cell: int, changes: ChangeColumns) -> IntArray:
        key, count = (cell, self.recording.first, self.recording.found_at), len(changes.cell)
        if self._followed != key:
            self._followed, self._places, self._looked_at = key, np.empty(0, np.int64), 0
        if count > self._looked_at:
            found = np.flatnonzero(changes.cell[self._looked_at :] == cell) + self._looked_at
            self._places, self._looked_at = np.concatenate((self._places, found)), count
        return self._places

    def _keep(self) -> None:
        self._kept.append(self.newest.copied())
        if len(self._kept) > _MOST:
            self._kept = self._kept[::2]
            self._spacing *= 2
