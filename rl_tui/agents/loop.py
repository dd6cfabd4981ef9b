"""The agent–environment loop, compiled: one driver for all algorithms (Sutton & Barto, 2nd ed., Fig. 3.1)."""

from __future__ import annotations

from enum import IntEnum
from typing import Any, Final

from numpy.random import Generator

from rl_tui.agents.action_rules import exploration
from rl_tui.agents.algorithms.family import Transition, act, learn
from rl_tui.agents.compiled import compiled, inlined
from rl_tui.agents.position import EpisodeLog, LastRecord, Position, record_transition, record_update
from rl_tui.agents.settings import EpsilonGreedy, Settings
from rl_tui.agents.tables import Tables

LARGEST_ESTIMATE: Final = 1e12
LONGEST_EPISODE: Final = 10_000_000


class Stop(IntEnum):
    """Why the loop came back."""

    DONE = 0  # the steps or episodes that were asked for
    EPISODES_FULL = 1  # the episode log is full: drain it and go on
    DIVERGED = 2  # an estimate left ±1e12 or is not a number
    ENDLESS_EPISODE = 3  # an episode went beyond 10⁷ steps


_EPISODES_FULL: Final = Stop.EPISODES_FULL.value
_DIVERGED: Final = Stop.DIVERGED.value
_ENDLESS_EPISODE: Final = Stop.ENDLESS_EPISODE.value


@inlined
def start_state(tables: Tables, generator: Generator) -> int:
    """Draw where an episode starts; a single start takes no draw."""
    index = 0
    if len(tables.start_state) > 1:
        draw = generator.random()
        while draw >= tables.start_cumulative[index]:
            index += 1
    return int(tables.start_state[index])


@inlined
def draw_outcome(tables: Tables, pair: int, generator: Generator) -> int:
    """Draw what happens when ``pair`` is taken; a certain outcome takes no draw."""
    outcome = int(tables.first_outcome[pair])
    if tables.first_outcome[pair + 1] - outcome > 1:
        draw = generator.random()
        while draw >= tables.cumulative[outcome]:
            outcome += 1
    return outcome


@inlined
def draw_reward(tables: Tables, outcome: int, generator: Generator) -> float:
    """Return the reward of ``outcome``, with its Gaussian noise where it has any."""
    reward = float(tables.reward[outcome])
    if tables.reward_std[outcome] > 0.0:
        reward += tables.reward_std[outcome] * generator.standard_normal()
    return reward


@compiled
def advance(
    memory: Any,
    rule: EpsilonGreedy,
    settings: Settings,
    tables: Tables,
    position: Position,
    log: EpisodeLog,
    last: LastRecord,
    world: Generator,
    learner: Generator,
    steps: int,
    episodes: int,
) -> int:
    """Take at most ``steps`` steps, or until ``episodes`` more have ended; return a :class:`Stop`."""
    first_step = step = position.step[0]
    episode = position.episodes[0]
    state = position.state[0]
    episode_step = position.episode_step[0]
    episode_return = position.episode_return[0]
    first_reward_episode = position.first_reward_episode[0]
    logged = log.finished[0]
    last_step, last_episode = step + steps, episode + episodes
    epsilon = exploration(rule, episode)
    stop = 0
    while stop == 0 and step < last_step and episode < last_episode:
        # Choose A from S using the policy derived from Q
        pair, explored = act(memory, rule, epsilon, tables, state, learner)
        # Take action A, observe R, S′
        outcome = draw_outcome(tables, pair, world)
        reward = draw_reward(tables, outcome, world)
        next_state = tables.next_state[outcome]
        terminated = tables.terminated[outcome]
        step += 1
        episode_step += 1
        episode_return += reward
        truncated = episode_step == tables.time_limit and not terminated
        transition = Transition(state, pair, reward, next_state, terminated, truncated)
        update = learn(memory, settings, tables, transition)
        # S ← S′, until S is terminal or the time is up
        acted_episode, acted_epsilon = episode, epsilon
        state = next_state
        if first_reward_episode == 0 and reward != 0.0:
            first_reward_episode = episode + 1
        if not abs(update.after) <= LARGEST_ESTIMATE:  # written so that NaN is caught too
            stop = _DIVERGED
        elif terminated or truncated:
            log.returns[logged] = episode_return
            log.lengths[logged] = episode_step
            log.last_pairs[logged] = pair
            logged += 1
            if logged == len(log.returns):
                stop = _EPISODES_FULL
            episode += 1
            episode_step = 0
            episode_return = 0.0
            epsilon = exploration(rule, episode)
            state = start_state(tables, world)
        elif episode_step >= LONGEST_EPISODE:
            stop = _ENDLESS_EPISODE
    position.step[0] = step
    position.episodes[0] = episode
    position.state[0] = state
    position.episode_step[0] = episode_step
    position.episode_return[0] = episode_return
    position.first_reward_episode[0] = first_reward_episode
    log.finished[0] = logged
    if step > first_step:
        record_transition(last, step, acted_episode + 1, explored, acted_epsilon, outcome, transition)
        record_update(last, update, settings.gamma)
    return stop
