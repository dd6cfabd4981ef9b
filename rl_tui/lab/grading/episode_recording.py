"""A recording that also counts over all steps, also over those that it forgets."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
import numpy.typing as npt

from rl_tui.lab.programs.recording import Recording
from rl_tui.worlds.mdp.space import FloatArray, IntArray

OnFinished = Callable[[FloatArray, IntArray], None]
_STATE, _ACTION, _REWARD, _FLAGS, _EPISODE = 1, 2, 3, 5, 6
NEVER: Final = 0


class EpisodeRecording(Recording):
    """The steps of an agent in one environment of ``states`` · ``actions`` pairs.

    ``on_finished`` is called with the returns (undiscounted) and lengths of finished episodes, [n] each, in
    order and each once. ``visits``, [S·A], counts how often each pair was taken.
    """

    def __init__(self, states: int, actions: int, on_finished: OnFinished) -> None:
        super().__init__()
        self.visits: IntArray = np.zeros(states * actions, np.int64)
        self.episodes = 0
        """How many episodes are finished."""
        self.first_reward_episode = NEVER
        """The first episode, from 1, with a reward that is not 0."""
        self._width = actions
        self._on_finished = on_finished
        self._return_so_far, self._length_so_far = 0.0, 0

    def add(self, steps: npt.NDArray[np.float64], changes: npt.NDArray[np.float64]) -> None:
        """Add steps, [n, 8], and changes, [m, 4], as they come through the pipe."""
        super().add(steps, changes)
        if len(steps):
            cells = (steps[:, _STATE] * self._width + steps[:, _ACTION]).astype(np.int64)
            self.visits += np.bincount(cells, minlength=len(self.visits))
            paid = np.flatnonzero(steps[:, _REWARD])
            if self.first_reward_episode == NEVER and len(paid):
                self.first_reward_episode = int(steps[paid[0], _EPISODE]) + 1
            self._finish(steps[:, _REWARD], np.flatnonzero(steps[:, _FLAGS]))

    def _finish(self, rewards: FloatArray, ends: IntArray) -> None:
        """Take in the next ``rewards``, [n]; after those at the places ``ends`` an episode is over."""
        starts = np.concatenate(([0], ends + 1))
        if not len(ends):
            self._return_so_far += float(rewards.sum())
            self._length_so_far += len(rewards)
            return
        returns = np.add.reduceat(rewards, starts[:-1])
        lengths = ends - starts[:-1] + 1
        returns[0] += self._return_so_far
        lengths[0] += self._length_so_far
        rest = rewards[starts[-1] :]
        self._return_so_far, self._length_so_far = float(rest.sum()), len(rest)
        self.episodes += len(ends)
        self._on_finished(returns, lengths)
