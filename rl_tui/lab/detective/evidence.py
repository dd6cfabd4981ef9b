"""The steps of a program with all that hypotheses about its update are made of, as columns."""

from __future__ import annotations

from functools import cached_property
from typing import Final

import numpy as np

from rl_tui.lab.programs.recording import Recording
from rl_tui.worlds.mdp.space import FloatArray, IntArray

NO_ACTION: Final = -1


class TableHistory:
    """The table at any moment: what stood in a cell before a step, for many cells and steps at once."""

    def __init__(self, recording: Recording) -> None:
        if recording.initial is None:
            raise ValueError("no table was found")
        self._initial = np.nan_to_num(recording.initial)
        changes = recording.changes
        order = np.lexsort((np.arange(len(changes.cell)), changes.cell))
        self._span = recording.count + 2
        self._key = changes.cell[order] * self._span + changes.step[order]
        self._cell, self._after = changes.cell[order], changes.after[order]

    def before(self, cell: IntArray, step: IntArray) -> FloatArray:
        """Return what stood in each ``cell`` before ``step``, that is after the changes of the one before it.

        Both may have any one shape. Where a dict had no entry yet it is 0.
        """
        place = np.searchsorted(self._key, cell * self._span + step) - 1
        value: FloatArray = self._initial[cell]
        if len(self._cell):
            known = (place >= 0) & (self._cell[np.maximum(place, 0)] == cell)
            value = np.where(known, self._after[np.maximum(place, 0)], value)
        return value


class Evidence:
    """The steps from where the table was found, [N] each, oldest first.

    ``number`` are their numbers in the program. Of a step ``reward_before`` is the reward of the step before
    it in the program (0 before the first), ``next_action`` the action taken next in the same episode (−1:
    none), ``previous_cell`` the cell of the step before in its episode (−1: none).
    """

    def __init__(self, recording: Recording) -> None:
        self.recording = recording
        self.actions = recording.actions
        self.history = TableHistory(recording)
        steps = recording.steps
        begin = max(recording.found_at - recording.first, 0)
        self.number: IntArray = np.arange(begin, len(steps.state)) + recording.first
        cut = slice(begin, None)
        self.state, self.action = steps.state[cut], steps.action[cut]
        self.reward, self.next_state = steps.reward[cut], steps.next_state[cut]
        self.terminated, self.truncated = steps.terminated[cut], steps.truncated[cut]
        self.episode, self.episode_step = steps.episode[cut], steps.episode_step[cut]
        self.environment = steps.environment[cut]
        self.cell: IntArray = self.state * self.actions + self.action
        self.reward_before = np.concatenate(([0.0], steps.reward))[begin:-1]
        order = np.lexsort((self.number, self.episode))
        follows = self.episode[order][1:] == self.episode[order][:-1]
        self.next_action: IntArray = np.full(len(order), NO_ACTION)
        self.next_action[order[:-1][follows]] = self.action[order[1:][follows]]
        self.previous_cell: IntArray = np.full(len(order), NO_ACTION)
        self.previous_cell[order[1:][follows]] = self.cell[order[:-1][follows]]

    def __len__(self) -> int:
        return len(self.number)

    @cached_property
    def changes_of(self) -> IntArray:
        """How many cells each step changed, [N]."""
        changes = self.recording.changes
        place = changes.step - self.number[0] if len(self) else changes.step
        known = (place >= 0) & (place < len(self)) & (changes.before != changes.after)
        counted: IntArray = np.bincount(place[known], minlength=len(self))
        return counted

    @cached_property
    def only_change(self) -> tuple[IntArray, FloatArray, FloatArray]:
        """Of each step that changed one cell: the cell, what stood and what stands there; else −1, 0, 0."""
        changes = self.recording.changes
        cell: IntArray = np.full(len(self), -1)
        before, after = np.zeros(len(self)), np.zeros(len(self))
        if len(self):
            place = changes.step - self.number[0]
            known = (place >= 0) & (place < len(self)) & (changes.before != changes.after)
            place = place[known]
            single = self.changes_of[place] == 1
            at = place[single]
            cell[at] = changes.cell[known][single]
            before[at] = np.nan_to_num(changes.before[known][single])
            after[at] = changes.after[known][single]
        return cell, before, after

    def rows(self, state: IntArray, at: IntArray) -> FloatArray:
        """Return the rows of ``state`` [n] before the steps at the places ``at`` [n], as [n, A]."""
        cells = state[:, None] * self.actions + np.arange(self.actions)
        steps = np.broadcast_to(self.number[at][:, None], cells.shape)
        return self.history.before(cells, steps)
