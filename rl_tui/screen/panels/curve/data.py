"""The numbers that the return curve shows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.catalogue import algorithm_row
from rl_tui.agents.learner_counters import Counters
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.results import Curve, RunResults
from rl_tui.runs.run import WorldChanged
from rl_tui.runs.timeline.branches import Furthest
from rl_tui.runs.timeline.lane_view import LaneView
from rl_tui.screen.draw.braille import NO_STEPS, Steps
from rl_tui.screen.draw.numbers import NEGLIGIBLE
from rl_tui.screen.kit.snapshot_facts import (
    current_study,
    has_estimates,
    hides_greedy,
    is_secret,
    keeps_back,
    reward_range,
    studied_answer,
)
from rl_tui.screen.panels.curve.moving_mean import MovingMean, moving_mean, window_of
from rl_tui.screen.panels.curve.seed_band import SeedBand, seed_bands
from rl_tui.worlds.mdp.space import FloatArray

_RATIO: Final = 1.05  # ratio between right ends of the axis, so that the picture moves in steps
_RATIO_RUNNING: Final = 1.15  # larger, because each step repaints the whole curve


@dataclass(frozen=True, slots=True, eq=False)
class EpisodeAxis:
    """An axis from 0 to ``right`` episodes, by ``step`` and ``episode``, [A]."""

    step: FloatArray
    episode: FloatArray
    right: float

    def episode_of(self, step: float) -> float:
        """Return the episodes after ``step`` steps."""
        return float(np.interp(step, self.step, self.episode))

    def step_of(self, episode: float) -> float:
        """Return the steps after ``episode`` episodes."""
        return float(np.interp(episode, self.episode, self.step))


@lru_cache(2)
def episode_axis(snapshot: Snapshot) -> EpisodeAxis:
    """Return the shown branch's axis."""
    timeline, counters = snapshot.timeline, snapshot.counters
    furthest = timeline.furthest if timeline.in_past else None
    known = furthest or Furthest(counters, snapshot.results)
    step, episode = _moments(known.counters, known.results.curve, snapshot.world_changes)
    end = float(timeline.current.end)
    if end > step[-1]:
        # the rest is unknown, so assume the same rate
        rate = episode[-1] / step[-1] if episode[-1] else 1.0 / end
        step, episode = np.append(step, end), np.append(episode, episode[-1] + rate * (end - step[-1]))
    # includes the whole current episode, so that the curve does not move within it
    own = float(episode[-1] if episode[-1] < 1.0 else np.ceil(episode[-1]))
    last = max([own, *(float(lane.episodes) for lane in snapshot.run_group.lanes)])
    ratio = _RATIO_RUNNING if snapshot.playback.phase is Phase.RUNNING else _RATIO
    return EpisodeAxis(step, episode, _right_end(last, snapshot.world.budget, ratio))


def _moments(
    counters: Counters, curve: Curve, changes: Sequence[WorldChanged]
) -> tuple[FloatArray, FloatArray]:
    """Return steps and episodes, [A] each, strictly ascending from 0 until now."""
    count = np.diff(curve.episode, prepend=0)
    ends = np.concatenate(([0.0], curve.episode))
    steps = np.concatenate(([0.0], np.cumsum(np.rint(curve.length_mean * count))))
    for change in changes:
        if change.given_up:  # its steps are not part of any mean
            steps[ends > change.episodes] += change.step - np.interp(change.episodes, ends, steps)
    under_way, finished, now = counters.episode_step, counters.episodes, counters.step
    # its length is unknown: the longer it takes, the nearer its end
    part = under_way / (under_way + now / (finished + 1)) if under_way else 0.0
    ends = np.concatenate((ends, [finished, finished + part]))
    steps = np.concatenate((steps, [now - under_way, now]))
    inside = (steps <= now) & (ends <= finished + part)
    ends, steps = np.maximum.accumulate(ends[inside]), np.maximum.accumulate(steps[inside])
    rises = np.concatenate(([True], (np.diff(ends) > 0.0) & (np.diff(steps) > 0.0)))
    return steps[rises], ends[rises]


def _right_end(last: float, limit: float | None, ratio: float) -> float:
    if last <= 0.0:
        return 1.0
    right = ratio ** math.ceil(math.log(last) / math.log(ratio) - 1e-9)
    return max(last, right if limit is None else min(right, float(limit)))


_MANY_WITHOUT_REWARD: Final = 10
_EARLY: Final = 12  # parts of the run: the axis ignores the first
_OUTLIERS: Final = 0.02
_COST_OF_ZERO: Final = 0.4


_STUDIED: Final = {PolicyKind.UNIFORM: "random", PolicyKind.BEHAVIOUR: "acting", PolicyKind.DRAWN: "drawn"}


class StudiedLevel(NamedTuple):
    """The exact return of the policy ``kind``."""

    kind: PolicyKind
    name: str
    value: float


@dataclass(frozen=True, slots=True, eq=False)
class LaneLine:
    """One of several runs.

    ``line``: moving mean, or a planner's greedy return (``is_exact``). ``value``: its end. ``greedy_now``:
    None if unknown, hidden or already the line.
    """

    number: int
    name: str
    shown: bool
    finished: int
    line: Steps
    is_exact: bool
    value: float | None
    greedy_now: float | None
    greedy_ends: float | None


@dataclass(frozen=True, slots=True, eq=False)
class CurveData:
    """The shown run's curve, and the numbers beside it.

    ``is_of_steps``: all returns are equal, so ``mean`` is of steps per episode. ``is_of_errors``: each state
    has one action, so ``mean`` is the error of V. Numbers are None if unknown, hidden or already drawn.
    ``barren``: long without reward. ``unlearned``: long without update. ``cut_at``: time limit that truncated
    every episode with one return, else 0. ``is_decided``: estimates differ somewhere. ``greedy_ends``: chance
    that the greedy policy ends, if it has no return. ``waits_for_prediction``: a lesson holds the run.
    """

    finished: int
    axis: EpisodeAxis
    mean: MovingMean
    curve: Curve
    greedy: Steps
    greedy_now: float | None
    mean_now: float | None
    optimum: float | None
    is_of_steps: bool
    is_of_errors: bool
    is_bandit: bool
    unit: str
    hides_optimum: bool
    has_key: bool
    barren: bool
    unlearned: bool
    cut_at: int
    is_decided: bool
    greedy_ends: float | None
    acting_now: float | None
    studied: StudiedLevel | None
    lanes: tuple[LaneLine, ...]
    seeds: tuple[SeedBand, ...]
    has_estimates: bool
    world_changes: tuple[WorldChanged, ...]
    is_over: bool
    """True at the end of a program, so that no key adds an episode."""
    waits_for_prediction: bool

    @property
    def world_since(self) -> int:
        """The finished episodes when the world began."""
        return self.world_changes[-1].episodes if self.world_changes else 0

    @property
    def furthest(self) -> int:
        """The last episode of any run."""
        return max(self.finished, *(lane.finished for lane in self.lanes)) if self.lanes else self.finished

    @property
    def lines(self) -> list[Steps]:
        """The greedy line, unless a run has it, and the runs."""
        if not self.lanes:
            return [self.greedy, self.mean.line]
        has_greedy = not any(lane.shown and lane.is_exact for lane in self.lanes)
        return [self.greedy if has_greedy else NO_STEPS, *(lane.line for lane in self.lanes)]

    @property
    def range(self) -> tuple[float, float]:
        """The vertical axis: 2 to 100 % of the means after the first twelfth.

        It includes the optimum, and policies not too far below. Steps start at 0.
        """
        means = [self.mean.means, *(lane.line.low for lane in self.lanes if not lane.is_exact)]
        late = [each[len(each) // _EARLY :] for each in means if len(each)]
        if self.is_of_errors:
            return 0.0, float(self.mean.means.max(initial=0.0))
        if self.is_of_steps:
            return 0.0, max((float(np.quantile(each, 1.0 - _OUTLIERS)) for each in late), default=1.0)
        exact = [self.greedy_now, None if self.studied is None else self.studied.value]
        exact += [lane.value if lane.is_exact else lane.greedy_now for lane in self.lanes]
        lows = [float(np.quantile(each, _OUTLIERS)) for each in late]
        highs = [float(each.max()) for each in late]
        if self.optimum is not None:
            lows.append(self.optimum)
            highs.append(self.optimum)
        known = np.array([each for each in exact if each is not None])
        if not late:  # only planners
            known = np.concatenate((known, *(line.low[~np.isnan(line.low)] for line in self.lines)))
        if not lows and not len(known):
            return 0.0, 0.0
        high = max(*highs, float(known.max(initial=-np.inf)), -np.inf)
        low = min(lows, default=float(known.min(initial=np.inf)))
        low = float(known[known >= low - max(high - low, abs(high))].min(initial=low))
        return (0.0 if 0.0 < low < _COST_OF_ZERO * high else low), high


def curve_data(snapshot: Snapshot) -> CurveData:
    """Collect the numbers that are not hidden."""
    is_bandit, first_update = snapshot.world.is_bandit, snapshot.answers.first_update
    lanes, results, axis = snapshot.run_group.lanes, snapshot.results, episode_axis(snapshot)
    shown = [each.curve for each in [lane.results for lane in lanes] or [results] if len(each.curve.episode)]
    same_returns = _returns_are_equal(shown)
    cut_at = _limit_of_all(shown, snapshot.world.space.time_limit) if same_returns else 0
    of_steps = same_returns and (cut_at > 0 or any(np.ptp(each.length_mean) > 0.0 for each in shown))
    curve = results.curve
    compares_seeds = not of_steps and current_study(snapshot) is not None
    window = window_of(shown, axis.right, is_compared=bool(lanes) or compares_seeds)
    mean = moving_mean(curve.episode, curve.length_mean if of_steps else curve.return_mean, window)
    last_100 = results.length_last_100 if of_steps else results.return_last_100
    of_errors = _errors(snapshot, axis) if not (lanes or compares_seeds or is_secret(snapshot)) else None
    mean = of_errors or mean
    hidden = hides_greedy(snapshot) or of_steps or of_errors is not None
    hides_optimum = is_secret(snapshot) and not snapshot.exact_answer.refused
    return CurveData(
        finished=snapshot.counters.episodes,
        axis=axis,
        mean=mean,
        curve=curve,
        greedy=NO_STEPS if hidden else _greedy(results, snapshot.counters.episodes),
        greedy_now=None if hidden else results.greedy_return,
        mean_now=mean.now(last_100),
        optimum=None if hides_optimum or of_steps or of_errors else snapshot.exact_answer.expected_return,
        is_of_steps=of_steps,
        is_of_errors=of_errors is not None,
        is_bandit=is_bandit,
        unit=unit_of(plans=snapshot.agent.row.planner, is_bandit=is_bandit),
        hides_optimum=hides_optimum,
        has_key=not keeps_back(snapshot, "answer"),
        barren=_barren(snapshot),
        unlearned=first_update is not None and first_update.is_long and not keeps_back(snapshot, "why"),
        cut_at=cut_at,
        is_decided=is_decided(snapshot),
        greedy_ends=None if hidden else results.greedy_ends,
        acting_now=_acting(snapshot),
        studied=None if of_steps or of_errors else _studied(snapshot),
        lanes=tuple(
            _lane(number, lane, snapshot.run_group.shown, window, hidden=hidden, of_steps=of_steps)
            for number, lane in enumerate(lanes, 1)
        ),
        seeds=seed_bands(snapshot, window) if compares_seeds else (),
        has_estimates=has_estimates(snapshot),
        world_changes=snapshot.world_changes,
        is_over=is_over(snapshot),
        waits_for_prediction=keeps_back(snapshot, "run"),
    )


def is_over(snapshot: Snapshot) -> bool:
    """Return True at the end of a program."""
    program = snapshot.program
    return program is not None and program.ended and not snapshot.timeline.in_past


def _errors(snapshot: Snapshot, axis: EpisodeAxis) -> MovingMean | None:
    history = snapshot.value_errors
    if history is None:
        return None
    ends = np.interp(history.step, axis.step, axis.episode)
    later = np.diff(ends, prepend=0.0) > 0.0
    return moving_mean(ends[later], history.error[later], 1)


def _returns_are_equal(curves: Sequence[Curve]) -> bool:
    return bool(curves) and all(
        each.return_high.max() - each.return_low.min() < NEGLIGIBLE for each in curves
    )


def _limit_of_all(curves: Sequence[Curve], limit: int) -> int:
    return limit if limit > 1 and all(each.length_mean.min() >= limit for each in curves) else 0


def unit_of(*, plans: bool, is_bandit: bool) -> str:
    """Return the horizontal axis's unit."""
    return "sweep" if plans else "pull" if is_bandit else "episode"


def _acting(snapshot: Snapshot) -> float | None:
    if is_secret(snapshot):
        return None
    answer = snapshot.answers.policies.get(PolicyKind.BEHAVIOUR)
    always = snapshot.results.behaviour_return
    return always if always is not None or answer is None else answer.expected_return


def _studied(snapshot: Snapshot) -> StudiedLevel | None:
    kind = snapshot.answers.studied
    answer = studied_answer(snapshot)
    if kind not in _STUDIED or answer is None or answer.expected_return is None:
        return None
    return StudiedLevel(kind, _STUDIED[kind], answer.expected_return)


def _lane(number: int, lane: LaneView, shown: int, window: int, *, hidden: bool, of_steps: bool) -> LaneLine:
    curve, results = lane.results.curve, lane.results
    is_exact = algorithm_row(lane.algorithm).planner and not len(curve.episode)
    greedy_now = None if hidden else results.greedy_return
    mean = moving_mean(curve.episode, curve.length_mean if of_steps else curve.return_mean, window)
    last_100 = results.length_last_100 if of_steps else results.return_last_100
    return LaneLine(
        number=number,
        name=lane.name,
        shown=number - 1 == shown,
        finished=lane.episodes,
        line=_greedy(results, lane.episodes) if is_exact and not hidden else mean.line,
        is_exact=is_exact,
        value=greedy_now if is_exact else mean.now(last_100),
        greedy_now=None if is_exact else greedy_now,
        greedy_ends=None if hidden else results.greedy_ends,
    )


def _greedy(results: RunResults, episodes: int) -> Steps:
    marks = results.marks
    now = np.nan if results.greedy_return is None else results.greedy_return
    episode = np.concatenate((marks.episode.astype(np.float64), [float(episodes)]))
    value = np.concatenate((marks.expected_return, [now]))
    end = np.concatenate((episode[1:], episode[-1:]))
    return Steps(episode, end, value, value)


def is_decided(snapshot: Snapshot) -> bool:
    """Return whether a greedy return exists and estimates differ."""
    if snapshot.results.greedy_return is None:  # then the curve says nothing about the greedy policy
        return False
    space, q = snapshot.world.space, snapshot.agent.q
    counts = np.diff(space.first_pair)
    if not (counts > 1).any():  # a single action is not a tie
        return True
    return bool((q != np.repeat(q[space.first_pair[:-1][counts > 0]], counts[counts > 0])).any())


def _barren(snapshot: Snapshot) -> bool:
    curve, mdp = snapshot.results.curve, snapshot.world.mdp
    if mdp is None or not len(curve.episode):
        return False
    all_zero = not curve.return_low.any() and not curve.return_high.any()
    return snapshot.counters.episodes >= _MANY_WITHOUT_REWARD and all_zero and reward_range(mdp).has_one_sign
