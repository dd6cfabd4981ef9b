"""The progress of a watched program after any recorded step."""

from __future__ import annotations

from bisect import bisect_right
from copy import copy
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, NamedTuple, Self

import numpy as np

from rl_tui.programs.watched.program_world import ProgramWorld
from rl_tui.programs.watched.recording import ChangeColumns, Recording, StepColumns
from rl_tui.runs.evaluation import NO_FIGURES, Evaluation, GreedyReturn, MarksState
from rl_tui.runs.history import History
from rl_tui.runs.results import RunResults
from rl_tui.runs.timeline.table_samples import CellHistory
from rl_tui.worlds.mdp.space import FloatArray, IntArray

# Progress after a step


PIECE: Final = 20_000
"""So many steps at most are taken in between two looks at the clock."""
_TIES: Final = "random"  # what a program does among equals is its own: they are shared evenly


class UnderWay(NamedTuple):
    """An episode that has not ended: its number in the program, its return and its length so far."""

    episode: int
    earned: float
    length: int
    has_ended: bool


@dataclass(frozen=True, slots=True, eq=False)
class ProgressState:
    """A copy of all that is known of a program after ``step`` steps."""

    step: int
    episodes: int
    table: FloatArray | None
    changes_until: int
    visits: IntArray
    under_way: dict[int, UnderWay]
    history: tuple[IntArray | FloatArray, ...]
    marks: MarksState


class ProgramState:
    """Where a program stood after ``step`` steps of ``recording``; it is brought further by :meth:`go_on`.

    The same steps come to the same bits however they are cut. ``table`` is the program's, [cells], NaN where
    it has no entry; None while none was found. ``visits`` counts how often each pair was taken, [P].
    """

    def __init__(self, recording: Recording, world: ProgramWorld) -> None:
        self.recording = recording
        self.world = world
        self.step = 0
        self.episodes = 0
        """Finished episodes; one that the program left to begin another is finished then."""
        self.table: FloatArray | None = None
        self.visits: IntArray = np.zeros(world.world.space.pairs, np.int64)
        self._changes_until = 0  # the changes of steps before this one are in the table
        self._under_way: dict[int, UnderWay] = {}  # by environment
        self._history = History()
        mdp = world.world.mdp
        self._greedy_return = GreedyReturn(lambda: mdp)
        self._evaluation = Evaluation(mdp, self._greedy_return)

    @property
    def q(self) -> FloatArray:
        """The estimates of our pairs, [P]; 0 where there is no table."""
        if self.table is None:
            return np.zeros(self.world.world.space.pairs)
        return self.world.q_of(self.table)

    @property
    def results(self) -> RunResults:
        """What it has achieved so far; what the greedy policy is worth only where there is a table."""
        mean_return, mean_length = self._history.last_100
        greedy = NO_FIGURES if self.table is None else self._greedy_return.figures(self.q, _TIES, None)
        return RunResults(
            curve=self._history.curve(),
            marks=self._evaluation.marks(),
            return_last_100=mean_return,
            length_last_100=mean_length,
            greedy_return=greedy.expected_return,
            greedy_ends=greedy.ends,
        )

    def go_on(self, until: int) -> None:
        """Take in what was recorded up to the step ``until``."""
        while True:
            self._take_changes()
            self._mark_if_due(is_left=self.step < until)
            if self.step >= until:
                return
            mark = self._evaluation.next_step
            stop = min(until, self.step + PIECE)
            self._take_steps(stop if mark is None else min(stop, mark))

    def checkpoint(self) -> ProgressState:
        """Return a copy of where it stands."""
        return ProgressState(
            self.step,
            self.episodes,
            None if self.table is None else self.table.copy(),
            self._changes_until,
            self.visits.copy(),
            dict(self._under_way),
            self._history.checkpoint(),
            self._evaluation.checkpoint(),
        )

    def at(self, state: ProgressState) -> Self:
        """Return another progress of the same program that stands at ``state``."""
        other = copy(self)
        other.step, other.episodes = state.step, state.episodes
        other.table = None if state.table is None else state.table.copy()
        other._changes_until, other.visits = state.changes_until, state.visits.copy()
        other._under_way = dict(state.under_way)
        mdp = self.world.world.mdp
        other._history, other._greedy_return = History(), GreedyReturn(lambda: mdp)
        other._evaluation = Evaluation(mdp, other._greedy_return)
        other._history.restore(state.history)
        other._evaluation.restore(state.marks)
        return other

    def _take_changes(self) -> None:
        """Bring the table to where it stands after the steps taken in."""
        recording = self.recording
        if self.table is None:
            if recording.initial is None or recording.found_at > self.step:
                return
            self.table, self._changes_until = recording.initial.copy(), recording.found_at
        if self._changes_until < self.step:
            changes = recording.changes
            begin, end = np.searchsorted(changes.step, (self._changes_until, self.step))
            self.table[changes.cell[begin:end]] = changes.after[begin:end]
            self._changes_until = self.step

    def _mark_if_due(self, *, is_left: bool) -> None:
        """Take the mark that is due here; without a table only where this moment is left for the next."""
        mark = self._evaluation.next_step
        while mark is not None and mark <= self.step and (is_left or self.table is not None):
            self._evaluation.mark(self.episodes, None if self.table is None else self.q, _TIES)
            mark = self._evaluation.next_step

    def _take_steps(self, stop: int) -> None:
        """Take in the steps up to ``stop``: episodes that end, and which pairs were taken."""
        steps = steps_between(self.recording, self.step, stop)
        pair_of_cell = self.world.pair_of_cell
        actions = len(self.world.world.space.action_names)
        cells = steps.state * actions + steps.action
        pairs = pair_of_cell[np.clip(cells, 0, len(pair_of_cell) - 1)]
        np.add.at(self.visits, pairs[pairs >= 0], 1)
        finished = self._finished(steps)
        self.episodes += len(finished)
        self._history.add(
            np.array([each[1] for each in finished]), np.array([each[2] for each in finished], np.int64)
        )
        self.step = stop

    def ends_until(self, stop: int) -> list[int]:
        """Return after how many steps each of the episodes ends that end from here to ``stop``.

        What has begun but not ended is another afterwards: call it of a copy.
        """
        steps = steps_between(self.recording, self.step, stop)
        return [self.step + place + 1 for place, _, _ in self._finished(steps)]

    def _finished(self, steps: StepColumns) -> list[tuple[int, float, int]]:
        """Return (place, return, length) of the episodes that end in ``steps``, the first to end first."""
        found: list[tuple[int, float, int]] = []
        for environment in np.unique(steps.environment):
            places = np.flatnonzero(steps.environment == environment)
            found += self._finished_in(int(environment), places, steps)
        return sorted(found)

    def _finished_in(
        self, environment: int, places: IntArray, steps: StepColumns
    ) -> list[tuple[int, float, int]]:
        """Return (place, return, length) of the episodes of one environment that end at its ``places``."""
        episode, ended = steps.episode[places], (steps.terminated | steps.truncated)[places]
        begins = np.flatnonzero(np.diff(episode, prepend=episode[0]) != 0).tolist()
        pieces = [0, *begins, len(places)]
        found = []
        for first, last in pairwise(pieces):
            if first == last:
                continue
            number, before = int(episode[first]), self._under_way.get(environment)
            earned, length = 0.0, 0
            if before is not None and before.episode == number:
                earned, length = before.earned, before.length
            elif before is not None and not before.has_ended:
                found.append((int(places[first]), before.earned, before.length))
            for reward in steps.reward[places[first:last]].tolist():
                earned += reward
            length += last - first
            has_ended = bool(ended[last - 1])
            if has_ended:
                found.append((int(places[last - 1]), earned, length))
            self._under_way[environment] = UnderWay(number, earned, length, has_ended)
        return found


def steps_between(recording: Recording, first: int, last: int) -> StepColumns:
    """Return the steps from ``first`` to before ``last``, as far as they are kept."""
    begin, end = max(first - recording.first, 0), max(last - recording.first, 0)
    return StepColumns._make(column[begin:end] for column in recording.steps)


# Going back in the recording


_MOST: Final = 32
_FIRST_SPACING: Final = 1_000
_MOST_SAMPLES: Final = 256


class ProgramHistory:
    """The newest moment of a program, the one shown, and what is needed to go back.

    ``shown`` is ``newest`` itself unless the past is shown.
    """

    def __init__(self, recording: Recording, world: ProgramWorld) -> None:
        self.recording = recording
        self.newest = ProgramState(recording, world)
        self.shown = self.newest
        self.begun_at: int | None = None
        """Where an episode's beginning was asked for: there the end of the one before is not shown."""
        self._spacing = _FIRST_SPACING
        self._kept: list[ProgressState] = [self.newest.checkpoint()]
        self._followed: tuple[int, int, int] = (-1, 0, 0)
        self._places: IntArray = np.empty(0, np.int64)
        self._looked_at = 0

    @property
    def in_past(self) -> bool:
        """Whether an earlier moment than the newest is shown."""
        return self.shown is not self.newest

    @property
    def first_step(self) -> int:
        """The first step that can still be shown."""
        return next((each.step for each in self._kept if each.step >= self.recording.first), self.newest.step)

    def go_on(self, until: int) -> None:
        """Bring the newest moment to the step ``until``."""
        newest = self.newest
        while newest.step < until:
            newest.go_on(min(until, self._kept[-1].step + self._spacing))
            if newest.step == self._kept[-1].step + self._spacing:
                self._keep()
        newest.go_on(until)  # a table may have been found here meanwhile

    def show(self, step: int) -> None:
        """Show the moment after ``step`` steps, or the nearest that is known."""
        self.begun_at = None
        step = max(step, self.first_step)
        if step >= self.newest.step:
            self.shown = self.newest
            return
        place = bisect_right([each.step for each in self._kept], step) - 1
        self.shown = self.newest.at(self._kept[max(place, 0)])
        self.shown.go_on(step)

    def begin_of_episode(self, number: int) -> int:
        """Return after how many steps episode ``number`` (from 1) began; the newest step if it has not."""
        wanted = number - 1
        first = next((each for each in self._kept[::-1] if each.episodes < wanted), self._kept[0])
        if first.step < self.recording.first:
            return self.first_step
        if self.newest.episodes < wanted:
            return self.newest.step
        if first.episodes >= wanted:
            return first.step
        until = next((each.step for each in self._kept if each.episodes >= wanted), self.newest.step)
        return self.newest.at(first).ends_until(until)[wanted - first.episodes - 1]

    def cell(self, pair: int) -> CellHistory | None:
        """Return how the estimate of ``pair`` went up to the moment shown; None where there is no table."""
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
        """Return the places of the changes of ``cell``, looking only at what came since it was last asked."""
        key, count = (cell, self.recording.first, self.recording.found_at), len(changes.cell)
        if self._followed != key:
            self._followed, self._places, self._looked_at = key, np.empty(0, np.int64), 0
        if count > self._looked_at:
            found = np.flatnonzero(changes.cell[self._looked_at :] == cell) + self._looked_at
            self._places, self._looked_at = np.concatenate((self._places, found)), count
        return self._places

    def _keep(self) -> None:
        self._kept.append(self.newest.checkpoint())
        if len(self._kept) > _MOST:
            self._kept = self._kept[::2]
            self._spacing *= 2
