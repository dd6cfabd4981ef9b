"""What the return curve shows of a snapshot, in numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.catalogue import algorithm_row
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.results import RunResults
from rl_tui.runs.run import WorldChanged
from rl_tui.runs.timeline.lane_view import LaneView
from rl_tui.screen.draw.braille import NO_STEPS, Steps
from rl_tui.screen.kit.snapshot_facts import has_estimates, hides_greedy, is_secret, keeps_back
from rl_tui.screen.panels.curve.seed_band import SeedBand, seed_bands, smoothed
from rl_tui.screen.panels.model.reward_range import reward_range
from rl_tui.screen.panels.policies.names import POLICY_NAMES
from rl_tui.screen.panels.policies.studied import studied_answer
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.mdp.space import FloatArray

_MANY_WITHOUT_REWARD: Final = 10


class StudiedLevel(NamedTuple):
    """The exact return, ``value``, of a policy that is studied, and what that is called."""

    name: str
    value: float


@dataclass(frozen=True, slots=True, eq=False)
class LaneLine:
    """One of several runs side by side.

    ``number`` counts from 1. ``line`` is the smoothed mean of its returns; of a planner, which has none, what
    its greedy policy is worth (then ``is_exact``). ``value`` is where that line ends: the mean of the last
    100 episodes, None before the first. ``greedy_now`` is None where unknown, hidden, or the line itself.
    ``greedy_ends`` is as in :class:`CurveData`.
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
    """The curves and the figures beside them.

    ``episodes`` is the smoothed mean of the returns, ``greedy`` the exact expected return of the greedy
    policy, each over episodes from 0. ``greedy_now``, ``mean_now`` (of the last 100 episodes) and
    ``optimum`` are the values to print, None where unknown or hidden. ``hides_optimum`` tells that the
    optimum is hidden, of a bandit the greedy arm as well, and ``has_key`` that a key shows it then.
    ``barren`` tells that there were many episodes and none had a reward, ``unlearned`` that no estimate has
    moved in many, ``is_decided`` that somewhere one action is estimated above another, so that being greedy
    means something (true as well where there is no choice, false where ``greedy_now`` is unknown).
    ``greedy_ends`` is, where the greedy policy has no return, how likely an episode of it ends; else None.
    ``acting_now`` is the exact return of the agent as it acts now, None where it is not known, ``studied``
    that of a policy that is studied and has no line already; ``is_studying`` tells that any is studied.
    ``unit`` is what the horizontal axis counts: pulls, a planner's sweeps, or episodes. The optimum is the
    undiscounted return of the policy that is best for the γ in force.

    All this is of the run shown; ``lanes`` are the runs side by side, itself among them, none if it is alone.
    ``seeds`` is what many seeds say of the same runs, none while that is not known. ``has_estimates`` is
    false for a program without a table, which has no greedy policy. ``world_changes`` are those of the run
    shown: only from the last of them on are optimum and studied policy those of the world in force.
    """

    finished: int
    limit: int | None
    episodes: Steps
    greedy: Steps
    greedy_now: float | None
    mean_now: float | None
    optimum: float | None
    is_bandit: bool
    unit: str
    hides_optimum: bool
    has_key: bool
    barren: bool
    unlearned: bool
    is_decided: bool
    greedy_ends: float | None
    acting_now: float | None = None
    studied: StudiedLevel | None = None
    is_studying: bool = False
    lanes: tuple[LaneLine, ...] = ()
    seeds: tuple[SeedBand, ...] = ()
    has_estimates: bool = True
    world_changes: tuple[WorldChanged, ...] = ()

    @property
    def world_since(self) -> int:
        """How many episodes had ended when the world in force began."""
        return self.world_changes[-1].episodes if self.world_changes else 0

    @property
    def has_both_units(self) -> bool:
        """Whether planners run beside agents, so that the horizontal axis counts sweeps and episodes."""
        return len({lane.is_exact for lane in self.lanes}) > 1

    @property
    def furthest(self) -> int:
        """The last episode that any run has finished."""
        return max(self.finished, *(lane.finished for lane in self.lanes)) if self.lanes else self.finished

    @property
    def lines(self) -> list[Steps]:
        """The lines that are drawn: of a run alone that of its episodes and the greedy one.

        Of runs side by side the greedy line of the one shown (without a step where that is the run's own
        line), then one a run.
        """
        if not self.lanes:
            return [self.episodes, self.greedy]
        has_greedy = not any(lane.shown and lane.is_exact for lane in self.lanes)
        return [self.greedy if has_greedy else NO_STEPS, *(lane.line for lane in self.lanes)]

    @property
    def line_names(self) -> list[str]:
        """The names of :attr:`lines`."""
        if not self.lanes:
            return ["pulls" if self.is_bandit else "episodes", "greedy"]
        return ["greedy", *(lane.name for lane in self.lanes)]

    @property
    def range(self) -> tuple[float, float]:
        """The lowest and highest value that must be on the vertical axis.

        What is far below all the rest may stick out, for it would leave no room for the others: the
        lowest twentieth of the episodes, and greedy policies, which may walk into walls until the time limit.
        """
        ends = [self.optimum, self.mean_now, *(lane.value for lane in self.lanes if not lane.is_exact)]
        lines = [self.episodes, *(lane.line for lane in self.lanes if not lane.is_exact)]
        exact = [self.greedy, *(lane.line for lane in self.lanes if lane.is_exact)]
        seen = [_known(line.low) for line in lines]
        worth = [_known(line.low) for line in exact]
        known = np.array([each for each in ends if each is not None])
        core = np.concatenate((known, *map(_without_lowest, seen)))
        if not len(core):
            core = np.concatenate(list(map(_without_lowest, worth)))
        if not len(core):
            return 0.0, 0.0
        low, high = float(core.min()), float(core.max())
        room = max((high - low) / 2.0, abs(high)) if core.any() else np.inf
        studied = np.array([] if self.studied is None else [self.studied.value])
        every = np.concatenate((*seen, *worth, studied))
        every = every[every >= low - room]
        return float(every.min(initial=low)), float(every.max(initial=high))


def _known(values: FloatArray) -> FloatArray:
    return np.asarray(values[~np.isnan(values)])


def _without_lowest(values: FloatArray) -> FloatArray:
    """Return all of ``values`` but the lowest twentieth."""
    few = len(values) // 20
    return np.partition(values, few)[few:] if few else values


def curve_data(snapshot: Snapshot) -> CurveData:
    """Return what there is to draw; what would give the answer away only where it is not hidden."""
    is_bandit = isinstance(snapshot.world.drawing, Arms)
    hidden = hides_greedy(snapshot)
    plans = snapshot.agent.row.planner
    hides_optimum = is_secret(snapshot) and not snapshot.exact_answer.refused
    episodes = _episodes(snapshot.results)
    return CurveData(
        finished=snapshot.counters.episodes,
        limit=None if plans else snapshot.world.budget,
        episodes=episodes,
        greedy=NO_STEPS if hidden else _greedy(snapshot.results, snapshot.counters.episodes),
        greedy_now=None if hidden else snapshot.results.greedy_return,
        mean_now=snapshot.results.return_last_100,
        optimum=None if hides_optimum else snapshot.exact_answer.expected_return,
        is_bandit=is_bandit,
        unit=unit_of(plans=plans, is_bandit=is_bandit),
        hides_optimum=hides_optimum,
        has_key=not keeps_back(snapshot, "answer"),
        barren=_barren(snapshot),
        unlearned=_is_unlearned(snapshot),
        is_decided=is_decided(snapshot),
        greedy_ends=None if hidden else snapshot.results.greedy_ends,
        acting_now=_acting(snapshot),
        studied=_studied(snapshot),
        is_studying=snapshot.answers.studied is not None and not hidden,
        lanes=tuple(
            _lane(number, lane, shown=number - 1 == snapshot.run_group.shown, hidden=hidden)
            for number, lane in enumerate(snapshot.run_group.lanes, 1)
        ),
        seeds=seed_bands(snapshot),
        has_estimates=has_estimates(snapshot),
        world_changes=snapshot.world_changes,
    )


def unit_of(*, plans: bool, is_bandit: bool) -> str:
    """Return what the horizontal axis counts."""
    return "sweep" if plans else "pull" if is_bandit else "episode"


def _is_unlearned(snapshot: Snapshot) -> bool:
    """Return whether no update is in sight, where a person may ask why."""
    first = snapshot.answers.first_update
    return first is not None and first.is_long and not keeps_back(snapshot, "why")


def _acting(snapshot: Snapshot) -> float | None:
    """Return the exact return of the agent as it acts now: known always, or since it was asked for."""
    if is_secret(snapshot):
        return None
    answer = snapshot.answers.policies.get(PolicyKind.BEHAVIOUR)
    always = snapshot.results.behaviour_return
    return always if always is not None or answer is None else answer.expected_return


def _studied(snapshot: Snapshot) -> StudiedLevel | None:
    """Return the level of the policy that is studied; the greedy one and the best have lines already."""
    kind = snapshot.answers.studied
    answer = studied_answer(snapshot)
    has_line = kind is None or kind in (PolicyKind.GREEDY, PolicyKind.OPTIMAL)
    if has_line or kind is None or answer is None or answer.expected_return is None:
        return None
    return StudiedLevel(POLICY_NAMES[kind].line, answer.expected_return)


def _lane(number: int, lane: LaneView, *, shown: bool, hidden: bool) -> LaneLine:
    is_exact = algorithm_row(lane.algorithm).planner and not len(lane.results.curve.episode)
    greedy_now = None if hidden else lane.results.greedy_return
    return LaneLine(
        number=number,
        name=lane.name,
        shown=shown,
        finished=lane.episodes,
        line=_greedy(lane.results, lane.episodes) if is_exact and not hidden else _episodes(lane.results),
        is_exact=is_exact,
        value=greedy_now if is_exact else lane.results.return_last_100,
        greedy_now=None if is_exact else greedy_now,
        greedy_ends=None if hidden else lane.results.greedy_ends,
    )


def _episodes(results: RunResults) -> Steps:
    end = results.curve.episode.astype(np.float64)
    start = np.concatenate(([0.0], end[:-1])) if len(end) else end
    mean = smoothed(results.curve.return_mean)
    return Steps(start, end, mean, mean)


def _greedy(results: RunResults, episodes: int) -> Steps:
    """Return the marks, each held until the next, and the value of this very moment at the end."""
    marks = results.marks
    now = np.nan if results.greedy_return is None else results.greedy_return
    episode = np.concatenate((marks.episode.astype(np.float64), [float(episodes)]))
    value = np.concatenate((marks.expected_return, [now]))
    end = np.concatenate((episode[1:], episode[-1:]))
    return Steps(episode, end, value, value)


def is_decided(snapshot: Snapshot) -> bool:
    """Return whether the greedy policy has a return and somewhere one action is estimated above another."""
    if snapshot.results.greedy_return is None:  # then nothing is said of the greedy policy
        return False
    space, q = snapshot.world.space, snapshot.agent.q
    counts = np.diff(space.first_pair)
    if not (counts > 1).any():  # one action is no tie
        return True
    return bool((q != np.repeat(q[space.first_pair[:-1][counts > 0]], counts[counts > 0])).any())


def _barren(snapshot: Snapshot) -> bool:
    """Return whether there were many episodes without any reward, not just with rewards that cancel out.

    Where the rewards are not known, or a planner sees them anyway, that is not claimed.
    """
    curve, mdp = snapshot.results.curve, snapshot.world.mdp
    if mdp is None or not len(curve.episode):
        return False
    all_zero = not curve.return_low.any() and not curve.return_high.any()
    return snapshot.counters.episodes >= _MANY_WITHOUT_REWARD and all_zero and reward_range(mdp).has_one_sign
