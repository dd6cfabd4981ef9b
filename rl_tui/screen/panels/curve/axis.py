"""The axis of episodes that the curve and the timeline share."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np

from rl_tui.agents.learner_counters import Counters
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.results import Curve
from rl_tui.runs.run import WorldChanged
from rl_tui.runs.timeline.branches import Furthest
from rl_tui.worlds.mdp.space import FloatArray

_RATIO: Final = 1.05  # from one right end of the axis to the next: the picture moves in steps only


@dataclass(frozen=True, slots=True, eq=False)
class EpisodeAxis:
    """An axis from 0 to ``right`` episodes. Between A moments both steps and episodes go evenly.

    ``step`` and ``episode``, [A], rise from 0. Inside an episode the place goes by its steps. The unfinished
    episode takes part of one. ``right`` is little further than the last of them.
    """

    step: FloatArray
    episode: FloatArray
    right: float

    def episode_of(self, step: float) -> float:
        """Return how many episodes have passed after ``step``."""
        return float(np.interp(step, self.step, self.episode))

    def step_of(self, episode: float) -> float:
        """Return the step at which ``episode`` episodes have passed."""
        return float(np.interp(episode, self.episode, self.step))


@lru_cache(2)
def episode_axis(snapshot: Snapshot) -> EpisodeAxis:
    """Return the axis of the branch shown, from its beginning to as far as it has come.

    The curve and the timeline both ask for the axis of a snapshot.
    """
    timeline, counters = snapshot.timeline, snapshot.counters
    furthest = timeline.furthest if timeline.in_past else None
    known = furthest or Furthest(counters, snapshot.results)
    step, episode = _moments(known.counters, known.results.curve, snapshot.world_changes)
    end = float(timeline.current.end)
    if end > step[-1]:
        # nothing is known of the rest: it goes on at the same rate
        rate = episode[-1] / step[-1] if episode[-1] else 1.0 / end
        step, episode = np.append(step, end), np.append(episode, episode[-1] + rate * (end - step[-1]))
    # the whole of an episode under way is on it, so that the curve does not move within one
    own = float(episode[-1] if episode[-1] < 1.0 else np.ceil(episode[-1]))
    last = max([own, *(float(lane.episodes) for lane in snapshot.run_group.lanes)])
    return EpisodeAxis(step, episode, _right_end(last, snapshot.world.budget))


def _moments(
    counters: Counters, curve: Curve, changes: Sequence[WorldChanged]
) -> tuple[FloatArray, FloatArray]:
    """Return steps and episodes, [A] each, both strictly ascending from 0 to the moment of ``counters``."""
    count = np.diff(curve.episode, prepend=0)
    ends = np.concatenate(([0.0], curve.episode))
    steps = np.concatenate(([0.0], np.cumsum(np.rint(curve.length_mean * count))))
    for change in changes:
        if change.given_up:  # its steps are in no mean
            steps[ends > change.episodes] += change.step - np.interp(change.episodes, ends, steps)
    under_way, finished, now = counters.episode_step, counters.episodes, counters.step
    # how long it will be is not known: the longer it takes, the nearer it is to its end
    part = under_way / (under_way + now / (finished + 1)) if under_way else 0.0
    ends = np.concatenate((ends, [finished, finished + part]))
    steps = np.concatenate((steps, [now - under_way, now]))
    inside = (steps <= now) & (ends <= finished + part)
    ends, steps = np.maximum.accumulate(ends[inside]), np.maximum.accumulate(steps[inside])
    rises = np.concatenate(([True], (np.diff(ends) > 0.0) & (np.diff(steps) > 0.0)))
    return steps[rises], ends[rises]


def _right_end(last: float, limit: float | None) -> float:
    """Return the first of the round ends that holds ``last`` episodes, no further than there will be any."""
    if last <= 0.0:
        return 1.0
    right = _RATIO ** math.ceil(math.log(last) / math.log(_RATIO) - 1e-9)
    return max(last, right if limit is None else min(right, float(limit)))
