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
"""Most steps between two looks at the clock."""
_TIES: Final = "random"  # a program's choice among ties is unknown, so they are shared equally


class UnderWay(NamedTuple):
    """An unfinished episode: its number in the program, return and length so far."""

    episode: int
    earned: float
    length: int
    has_ended: bool


@dataclass(frozen=True, slots=True, eq=False)
class ProgressState:
    """A copy of the progress after `step` steps."""

    step: int
    episodes: int
    table: FloatArray | None
    changes_until: int
    visits: IntArray
    under_way: dict[int, UnderWay]
    history: tuple[IntArray | FloatArray, ...]
    marks: MarksState


class ProgramState:
    """The state of a program after `step` steps of `recording`; `go_on` advances it. The bits do not
    depend on how the steps are divided. `table`, `[cells]`, is the program's, with NaN for missing
    entries, or None while none was found. `visits`, `[P]`, counts how often each pair was taken.
    """

    def __init__(self, recording: Recording, world: ProgramWorld) -> None:
        self.recording = recording
        self.world = world
        self.step = 0
        self.episodes = 0
        """Finished episodes, including those that the program left early."""
        self.table: FloatArray | None = None
        self.visits: IntArray = np.zeros(world.world.space.pairs, np.int64)
        self._changes_until = 0  # the table includes changes of earlier steps
        self._under_way: dict[int, UnderWay] = {}  # by environment
        self._history = History()
        mdp = world.world.mdp
        self._greedy_return = GreedyReturn(lambda: mdp)
        self._evaluation = Evaluation(mdp, self._greedy_return)

    @property
    def q(self) -> FloatArray:
        """Estimates of our pairs, `[P]`, or 0 without a table."""
        if self.table is None:
            return np.zeros(self.world.world.space.pairs)
        return self.world.q_of(self.table)

    @property
    def results(self) -> RunResults:
        """Results so far, without a table there is no greedy return."""
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
        """Advance to the step `until` of the recording."""
        while True:
            self._take_changes()
            self._mark_if_due(is_left=self.step < until)
            if self.step >= until:
                return
            mark = self._evaluation.next_step
            stop = min(until, self.step + PIECE)
            self._take_steps(stop if mark is None else min(stop, mark))

    def checkpoint(self) -> ProgressState:
        """Return a copy of the state."""
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
        """Return another progress of the same program at `state`."""
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
        """Bring the table up to date with the steps."""
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
        """Take the mark that is due here. Without a table, only when the progress moves on."""
        mark = self._evaluation.next_step
        while mark is not None and mark <= self.step and (is_left or self.table is not None):
            self._evaluation.mark(self.episodes, None if self.table is None else self.q, _TIES)
            mark = self._evaluation.next_step

    def _take_steps(self, stop: int) -> None:
        """Process the steps up to `stop`: finished episodes and taken pairs."""
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
        """Return the step at which each episode ends, from here to `stop`. This changes unfinished
        episodes, so call it on a copy.
        """
        steps = steps_between(self.recording, self.step, stop)
        return [self.step + place + 1 for place, _, _ in self._finished(steps)]

    def _finished(self, steps: StepColumns) -> list[tuple[int, float, int]]:
        """Return (place, return, length) of the episodes that end in `steps`, in order."""
        found: list[tuple[int, float, int]] = []
        for environment in np.unique(steps.environment):
            places = np.flatnonzero(steps.environment == environment)
            found += self._finished_in(int(environment), places, steps)
        return sorted(found)

    def _finished_in(
        self, environment: int, places: IntArray, steps: StepColumns
    ) -> list[tuple[int, float, int]]:
        """Return (place, return, length) of the episodes of one environment."""
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
    """Return the recorded steps in [first, last)."""
    begin, end = max(first - recording.first, 0), max(last - recording.first, 0)
    return StepColumns._make(column[begin:end] for column in recording.steps)


# Going back in the recording


_MOST: Final = 32
_FIRST_SPACING: Final = 1_000
_MOST_SAMPLES: Final = 256


class ProgramHistory:
    """The newest moment of a program, the shown one, and stored moments to return to. `shown` is `newest`
    unless the past is shown.
    """

    def __init__(self, recording: Recording, world: ProgramWorld) -> None:
        self.recording = recording
        self.newest = ProgramState(recording, world)
        self.shown = self.newest
        self._spacing = _FIRST_SPACING
        self._kept: list[ProgressState] = [self.newest.checkpoint()]
        self._followed: tuple[int, int, int] = (-1, 0, 0)
        self._places: IntArray = np.empty(0, np.int64)
        self._looked_at = 0

    @property
    def in_past(self) -> bool:
        """True if an earlier moment than the newest is shown."""
        return self.shown is not self.newest

    @property
    def first_step(self) -> int:
        """First step that can still be shown."""
        return next((each.step for each in self._kept if each.step >= self.recording.first), self.newest.step)

    def go_on(self, until: int) -> None:
        """Advance the newest moment to the step `until`."""
        newest = self.newest
        while newest.step < until:
            newest.go_on(min(until, self._kept[-1].step + self._spacing))
            if newest.step == self._kept[-1].step + self._spacing:
                self._keep()
        newest.go_on(until)  # a table may have been found meanwhile

    def show(self, step: int) -> None:
        """Show the moment after `step` steps, or the nearest known one."""
        step = max(step, self.first_step)
        if step >= self.newest.step:
            self.shown = self.newest
            return
        place = bisect_right([each.step for each in self._kept], step) - 1
        self.shown = self.newest.at(self._kept[max(place, 0)])
        self.shown.go_on(step)

    def begin_of_episode(self, number: int) -> int:
        """Return the step at which episode `number` (from 1) began. The newest step if it has not."""
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
        """Return the history of the estimate of `pair` up to the shown moment, or None without a table."""
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
        """Return the places of the changes of `cell`, searching only new changes."""
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
