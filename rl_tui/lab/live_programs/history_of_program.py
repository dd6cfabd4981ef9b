"""Any moment of a program that is still recorded."""

from __future__ import annotations

from bisect import bisect_right
from typing import Final

import numpy as np

from rl_tui.lab.live_programs.progress import ProgramState, ProgressState
from rl_tui.lab.programs.program_world import ProgramWorld
from rl_tui.lab.programs.recording import ChangeColumns, Recording
from rl_tui.lab.timeline.table_samples import CellHistory
from rl_tui.worlds.mdp.space import IntArray

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
