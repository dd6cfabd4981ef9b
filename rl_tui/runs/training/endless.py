"""Checks for worlds whose episodes may never end."""

from __future__ import annotations

from bisect import bisect_right
from typing import Final

import numpy as np

from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.agents.exact.solve import endless_states
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.position import LARGEST_ESTIMATE, LONGEST_EPISODE
from rl_tui.common.streams import streams
from rl_tui.runs.library import episodes_of, recipe_for
from rl_tui.runs.training.learned_length import learned_length
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

EPISODES: Final = 1_000
LONG_EPISODE: Final = 50_000
"""Steps of one episode that deserve a warning."""
MOST_STEPS: Final = 200_000
"""Steps after which a trial begins no further episode; half a second with two actions."""
# in a larger world an untrained agent may wander as long, or choose more slowly
_MOST_STATES, _MOST_ACTIONS = 1_000, 50
_UNTOLD: Final = 1e12  # steps; beyond this, rounding leaves no correct digit
REMEDY: Final = "add a time_limit to end such episodes"
_NOT_WORTH_IT: Final = f"the path to the end costs more than it earns; {REMEDY}"


def endless_warning(scenario: Scenario) -> str:
    """Return a one-line warning if episodes of `scenario` may never end, else "".

    It is no error, because γ below 1 has an exact answer.
    """
    mdp = scenario.build(streams(0).world).mdp
    if mdp is None:
        return ""
    return endless_warning_in(mdp, recipe_for(scenario).hyperparameters, episodes_of(scenario))


def endless_warning_in(mdp: TabularMDP, hyperparameters: Hyperparameters, episodes: int) -> str:
    """Return the warning for `mdp` after `episodes` of training."""
    state = endless_state(mdp)
    if state is not None:
        return (
            f"state {mdp.state_names[state]} can never reach a terminal state, and there is no time limit: "
            f"training stops after {LONGEST_EPISODE:,} steps of one episode; {REMEDY}"
        )
    if not POLICY_BY_ID[hyperparameters.policy].explores_by_epsilon or not _is_tried(mdp):
        return ""
    return _long_once_learned(mdp, hyperparameters, episodes) or _long_in_a_trial(mdp, hyperparameters)


def _long_once_learned(mdp: TabularMDP, hyperparameters: Hyperparameters, episodes: int) -> str:
    gamma = hyperparameters.gamma
    epsilon = min(hyperparameters.epsilon_at(0), hyperparameters.epsilon_at(episodes))
    for name, planned in (("SARSA", epsilon), ("Q-learning", 0.0)):
        length = learned_length(mdp, gamma, planned, epsilon)
        if length > LONG_EPISODE:
            steps = f"{length:,.0f} steps on average" if length < _UNTOLD else "almost forever"
            return (
                f"after {name} has learned, with γ {gamma:g} and ε {epsilon:g}, an episode takes "
                f"{steps}, and "
                f"there is no time limit: {_NOT_WORTH_IT}"
            )
    if learned_length(mdp, gamma, 0.0, 0.0) == np.inf:
        return (
            f"the optimal policy for γ {gamma:g} may never end an episode, and there is no time limit: "
            f"{_NOT_WORTH_IT}"
        )
    return ""


def _long_in_a_trial(mdp: TabularMDP, hyperparameters: Hyperparameters) -> str:
    episode = long_episode(mdp, hyperparameters)
    if episode is None:
        return ""
    return (
        f"in a trial of SARSA, episode {episode} took more than {LONG_EPISODE:,} steps, and there is no "
        f"time limit: an episode may take very long, or never end; {REMEDY}"
    )


def _is_tried(mdp: TabularMDP) -> bool:
    return not mdp.time_limit and mdp.states <= _MOST_STATES and len(mdp.action_names) <= _MOST_ACTIONS


def long_episode(mdp: TabularMDP, hyperparameters: Hyperparameters) -> int | None:
    """Return the number of an early SARSA episode (box on page 130) above `LONG_EPISODE` steps.

    None if all end, the world is large or has a time limit, or estimates diverge.
    """
    if not _is_tried(mdp):
        return None
    first_pair, first_outcome = mdp.first_pair.tolist(), mdp.first_outcome.tolist()
    cumulative, reward, reward_std = mdp.cumulative.tolist(), mdp.reward.tolist(), mdp.reward_std.tolist()
    next_states, terminated = mdp.next_state.tolist(), mdp.terminated.tolist()
    starts = mdp.start_cumulative.tolist()
    world, learner = streams(0)
    q, visits = [hyperparameters.initial_q] * mdp.pairs, [0] * mdp.pairs

    def choose(state: int, epsilon: float) -> int:
        pairs = range(first_pair[state], first_pair[state + 1])
        if learner.random() < epsilon:
            return pairs[int(learner.random() * len(pairs))]
        most = max(q[pair] for pair in pairs)
        best = [pair for pair in pairs if q[pair] == most]
        return best[0 if hyperparameters.ties == "first" else int(learner.random() * len(best))]

    steps_left = MOST_STEPS
    for episode in range(EPISODES):
        alpha, epsilon = hyperparameters.alpha_at(episode), hyperparameters.epsilon_at(episode)
        state = int(mdp.start_state[bisect_right(starts, world.random(), 0, len(starts) - 1)])
        pair = choose(state, epsilon)
        for _ in range(LONG_EPISODE):
            steps_left -= 1
            visits[pair] += 1
            last = first_outcome[pair + 1] - 1
            outcome = bisect_right(cumulative, world.random(), first_outcome[pair], last)
            target = reward[outcome] + reward_std[outcome] * world.standard_normal()
            if not terminated[outcome]:
                next_pair = choose(next_states[outcome], epsilon)
                target += hyperparameters.gamma * q[next_pair]
            q[pair] += (1 / visits[pair] if alpha is None else alpha) * (target - q[pair])
            if not abs(q[pair]) <= LARGEST_ESTIMATE:  # this form also catches NaN
                return None
            if terminated[outcome]:
                break
            pair = next_pair
        else:
            return episode + 1
        if steps_left <= 0:
            break
    return None


def endless_state(mdp: TabularMDP) -> int | None:
    """Return the first reachable state from which no end is reachable, or None, as with a time limit."""
    lost = np.flatnonzero(endless_states(mdp))
    return int(lost[0]) if len(lost) else None
