"""Questions about a snapshot."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.last_step import LastStep
from rl_tui.live.pace.stop_condition import is_optimal
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.answers.policy_values import PolicyAnswer
from rl_tui.runs.history import RECENT
from rl_tui.studies.many_seeds.figures import SeedStudy
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

SHOWN_BY_KEY: Final = "w h shows"
ANSWER_KEY: Final = f"{SHOWN_BY_KEY} the exact values"
ANSWER_KEPT: Final = "the lesson hides it for now"
BEING_BUILT: Final = "the world is being built"

_MOST_JUDGED: Final = 2_500  # pairs
_FASTEST_FOLLOWED: Final = 30.0  # steps per second: faster single steps would only flicker


def is_new_run(before: Snapshot | None, now: Snapshot) -> bool:
    """Return whether a new run began, not only another moment."""
    if before is None or before.run_group.shown != now.run_group.shown:
        return False
    first, was = now.timeline.branches[0], before.timeline.branches[0]
    return before.recipe != now.recipe or first.end < was.end


def why_over(snapshot: Snapshot) -> str:
    """Explain why the run is over."""
    message = snapshot.playback.message
    match snapshot.playback.phase:
        case Phase.SPENT if snapshot.program is None:
            return "the budget is spent. r r: start again"
        case Phase.SPENT:
            return "your program has ended. r r: start it again"
        case Phase.DONE:
            return f"{message}. Change γ to continue, r r: start again"
        case Phase.STOPPED:
            return f"{message}. r r: start again"
    return ""


def is_secret(snapshot: Snapshot) -> bool:
    """Return whether everything that reveals exact values is hidden."""
    is_open = snapshot.playback.phase is Phase.SPENT and not keeps_back(snapshot, "answer")
    return snapshot.answers.is_hidden and not is_open


def keeps_back(snapshot: Snapshot, what: str) -> bool:
    """Return whether a lesson page hides ``what``."""
    return what in snapshot.answers.kept_back


def answer_key(snapshot: Snapshot) -> str:
    """Return the text for hidden contents."""
    return ANSWER_KEPT if keeps_back(snapshot, "answer") else ANSWER_KEY


def shown_by(snapshot: Snapshot, them: str = "it") -> str:
    """Say how to reveal ``them``."""
    return f"the lesson hides {them}" if keeps_back(snapshot, "answer") else f"{SHOWN_BY_KEY} {them}"


def has_estimates(snapshot: Snapshot) -> bool:
    """Return whether estimates are known. A program may have no table."""
    return snapshot.program is None or snapshot.program.table is not None or not snapshot.counters.step


def as_learned(snapshot: Snapshot) -> Snapshot:
    """Replace unknown Q by NaN."""
    if has_estimates(snapshot):
        return snapshot
    unknown = np.full_like(snapshot.agent.q, np.nan)
    return replace(snapshot, agent=replace(snapshot.agent, q=unknown))


def hides_means(snapshot: Snapshot) -> bool:
    """Return whether true means are hidden."""
    return is_secret(snapshot) and snapshot.world.is_bandit


def hides_greedy(snapshot: Snapshot) -> bool:
    """Return whether returns of current policies are hidden: greedy may be optimal."""
    return hides_means(snapshot) or (is_secret(snapshot) and keeps_back(snapshot, "answer"))


def is_kept_back(snapshot: Snapshot, kind: PolicyKind) -> bool:
    """Return whether a policy's return must be hidden.

    Any policy of a bandit reveals its means. If a lesson hides the answer, only the random policy is shown.
    """
    if kind is PolicyKind.OPTIMAL:
        return is_secret(snapshot)
    return hides_means(snapshot) if kind is PolicyKind.UNIFORM else hides_greedy(snapshot)


def studied_answer(snapshot: Snapshot) -> PolicyAnswer | None:
    """Return the studied policy's values, unless hidden."""
    answers = snapshot.answers
    if answers.studied is None or is_kept_back(snapshot, answers.studied):
        return None
    answer = answers.policies.get(answers.studied)
    return answer if answer is not None and answer.v is not None else None


def studied_kind(snapshot: Snapshot) -> PolicyKind | None:
    """Return the studied policy, or None if learned."""
    if snapshot.world.is_bandit or studied_answer(snapshot) is None:
        return None
    return snapshot.answers.studied


def current_study(snapshot: Snapshot) -> SeedStudy | None:
    """Return the current runs' study."""
    study = snapshot.study
    runs = len(snapshot.run_group.lanes) or 1
    if study is None or study.is_outdated or study.seeds < 2 or len(study.lanes) != runs:
        return None
    return study


def shown_lane(study: SeedStudy, snapshot: Snapshot) -> int:
    """Return the shown run's index in ``study``."""
    is_same = len(snapshot.run_group.lanes or (0,)) == len(study.lanes)
    return snapshot.run_group.shown if is_same else study.shown


def episodes_reached(snapshot: Snapshot) -> tuple[int, ...]:
    """Return each run's finished episodes."""
    return tuple(lane.episodes for lane in snapshot.run_group.lanes) or (snapshot.counters.episodes,)


def recent_name(*episodes: int, most: int = RECENT) -> str:
    """Name a mean: ``last 48``, ``last 27–35``."""
    counts = sorted({min(each, most) for each in episodes if each}) or [most]
    return f"last {'–'.join(map(str, dict.fromkeys((counts[0], counts[-1]))))}"


def lacks_exact(snapshot: Snapshot) -> bool:
    """Return whether exact values are being computed."""
    return not snapshot.exact_answer.is_whole


def valued_states(snapshot: Snapshot) -> tuple[int, int] | None:
    """Count states with a changed V, and with actions. None for a large, partly known world."""
    agent, first = snapshot.agent, snapshot.world.space.first_pair
    if agent.part is not None:
        return None
    first = first[:-1][first[:-1] < first[1:]]
    values = np.maximum.reduceat(agent.q, first)
    return int(np.count_nonzero(values != agent.hyperparameters.initial_q)), len(first)


def has_optimal_policy(snapshot: Snapshot) -> bool:
    """Return whether the agent has learned an optimal policy.

    False if hidden, without choices, or in worlds too large to test in every frame.
    """
    world, optimum, agent = snapshot.world, snapshot.exact_answer.solution, snapshot.agent
    counted = valued_states(snapshot) if world.space.pairs <= _MOST_JUDGED else None
    if world.mdp is None or optimum is None or counted is None or is_secret(snapshot):
        return False
    with_value, states = counted
    has_learned = with_value > 0 and states < world.space.pairs
    return has_learned and is_optimal(world.mdp, agent.q, agent.hyperparameters.ties, optimum)


def passes_too_fast(snapshot: Snapshot) -> bool:
    """Return whether steps are too fast to show."""
    too_fast = snapshot.playback.speed is None or snapshot.playback.speed > _FASTEST_FOLLOWED
    return too_fast and snapshot.playback.phase is Phase.RUNNING


def followed_step(snapshot: Snapshot) -> LastStep | None:
    """Return the last step, unless too fast."""
    return None if passes_too_fast(snapshot) else snapshot.counters.last_step


def episode_shown(snapshot: Snapshot) -> int:
    """Return the episode or sweep, from 1."""
    counters, last = snapshot.counters, snapshot.counters.last_step
    if last is None or not counters.has_just_ended or last.planned != snapshot.agent.row.planner:
        return episodes_begun(snapshot)
    return counters.episodes + counters.is_at_beginning


def episodes_begun(snapshot: Snapshot) -> int:
    """Count the episodes or sweeps begun."""
    return snapshot.counters.episodes + (snapshot.playback.phase not in (Phase.SPENT, Phase.DONE))


class RewardRange(NamedTuple):
    """Range of mean rewards, and largest standard deviation."""

    low: float
    high: float
    noise: float

    @property
    def has_one_sign(self) -> bool:
        """True if rewards cannot cancel out."""
        return self.low >= 0.0 or self.high <= 0.0


@lru_cache(maxsize=1)  # only one world is on screen: keep no other alive
def reward_range(mdp: TabularMDP) -> RewardRange:
    """Find the reward range."""
    return RewardRange(float(mdp.reward.min()), float(mdp.reward.max()), float(mdp.reward_std.max()))
