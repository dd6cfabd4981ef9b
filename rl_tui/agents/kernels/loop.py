"""The compiled agent–environment loop (Sutton & Barto, 2nd ed., Fig. 3.1)."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.random import Generator

from rl_tui.agents.algorithms.family import Experience, act, has_room, learn, on_override
from rl_tui.agents.kernels.after_update import StepRecord, after_update, record_step
from rl_tui.agents.kernels.compiled import compiled, inlined
from rl_tui.agents.kernels.draws import uniform
from rl_tui.agents.kernels.drift import Drift, drift_on
from rl_tui.agents.kernels.parameters import KernelParameters, Schedules, alpha_in, epsilon_in, with_alpha
from rl_tui.agents.kernels.position import (
    DONE,
    ENDLESS_EPISODE,
    EPISODES_FULL,
    LONGEST_EPISODE,
    MEMORY_FULL,
    REWARDS_KEPT,
    EpisodeLog,
    Position,
    discount_rewards,
)
from rl_tui.agents.kernels.tables import Tables, landing, outcomes_of, pairs_of
from rl_tui.agents.kernels.watch import Watch, watched
from rl_tui.agents.policies.family import in_force, reinforce

# Internal stop: stored rewards must be summed before they are overwritten
_REWARDS_FULL: Final = -1


@inlined
def start_state(tables: Tables, generator: Generator) -> int:
    """Draw the start of an episode. A single start needs no draw."""
    index = 0
    if len(tables.start_state) > 1:
        draw = uniform(generator)
        while draw >= tables.start_cumulative[index]:
            index += 1
    return np.int64(tables.start_state[index])  # type: ignore[return-value]


@inlined
def draw_outcome(tables: Tables, pair: int, generator: Generator) -> int:
    """Draw the outcome of `pair`. A certain outcome needs no draw."""
    first, last = outcomes_of(tables, pair)
    outcome = first
    if last - first > 1:
        draw = uniform(generator)
        # Counting instead of stopping early avoids branch mispredictions
        for each in range(first, last - 1):
            outcome += draw >= tables.cumulative[each]
    return outcome


@inlined
def draw_reward(tables: Tables, drift: Drift, pair: int, outcome: int, generator: Generator) -> float:
    """Return the reward of an outcome, with drift and Gaussian noise."""
    reward = float(tables.reward[outcome])
    if len(drift.offset) > 0:
        reward += drift.offset[pair]
    if tables.reward_std[outcome] > 0.0:
        reward += tables.reward_std[outcome] * generator.standard_normal()
    return reward


@compiled
def advance(
    memory: Any,
    rule: Any,
    params: KernelParameters,
    schedules: Schedules,
    tables: Tables,
    drift: Drift,
    position: Position,
    log: EpisodeLog,
    record: StepRecord,
    watch: Watch,
    world: Generator,
    learner: Generator,
    steps: int,
    episodes: int,
) -> int:
    """Take up to `steps` steps or `episodes` episodes, and return a :class:`Stop`."""
    if steps <= 0 or episodes <= 0:
        return DONE
    discounted_step = step = position.step[0]
    episode = position.episodes[0]
    state = position.state[0]
    episode_step = position.episode_step[0]
    episode_return = position.episode_return[0]
    first_reward_episode = position.first_reward_episode[0]
    logged = log.finished[0]
    forced, watching = position.forced[0], watch.active[0]
    last_step, last_episode = step + steps, episode + episodes
    rule = in_force(rule, epsilon_in(schedules, episode))
    params = with_alpha(params, alpha_in(schedules, episode))
    # Rare events are checked only after this step, since every check costs time in a billion steps
    pause = step + 1 if watching else min(last_step, step + LONGEST_EPISODE - episode_step)
    going_on = True
    while going_on:
        # Choose A from S using the policy derived from Q
        if forced >= 0:
            pair, explored = forced, False
            on_override(memory, tables, state, forced)
        else:
            pair, explored = act(memory, rule, tables, state, learner)
        # Take action A, observe R, S′
        outcome = draw_outcome(tables, pair, world)
        reward = draw_reward(tables, drift, pair, outcome, world)
        next_state = landing(tables, outcome)
        terminated = tables.terminated[outcome]
        step += 1
        position.rewards[episode_step % REWARDS_KEPT] = reward
        episode_step += 1
        episode_return += reward
        truncated = episode_step == tables.time_limit and not terminated
        experience = Experience(state, pair, reward, next_state, terminated, truncated)
        update = learn(memory, rule, params, tables, experience, learner)
        first_pair, last_pair = pairs_of(tables, state)
        reinforce(rule, params.alpha, first_pair, last_pair, pair, reward)
        # S ← S′, until S is terminal or the time is up
        state = next_state
        taken = episode_step
        if first_reward_episode == 0 and reward != 0.0:
            first_reward_episode = episode + 1
        stop = after_update(record, update)
        if stop != DONE:
            pass  # an estimate diverged, so nothing else matters
        elif terminated or truncated:
            log.returns[logged] = episode_return
            log.lengths[logged] = episode_step
            log.optimal[logged] = drift.optimal[pair]
            logged += 1
            if logged == len(log.returns):
                stop = EPISODES_FULL
            episode += 1
            episode_step = 0
            episode_return = 0.0
            rule = in_force(rule, epsilon_in(schedules, episode))
            params = with_alpha(params, alpha_in(schedules, episode))
            state = start_state(tables, world)
        elif not has_room(memory):
            stop = MEMORY_FULL
        elif episode_step % REWARDS_KEPT == 0:
            stop = _REWARDS_FULL
        drift_on(drift, tables, pair, world)
        if stop != DONE or step == pause or episode == last_episode:
            if stop == _REWARDS_FULL:
                discount_rewards(position, params.gamma, step - discounted_step, episode_step)
                discounted_step = step
                stop = DONE
            if stop == DONE and episode_step >= LONGEST_EPISODE:
                stop = ENDLESS_EPISODE
            stop = watched(
                watching, watch, memory.q, params.random_ties, tables, experience, update, state, stop
            )
            pause = step + 1 if watching else min(last_step, step + LONGEST_EPISODE - episode_step)
            going_on = stop == DONE and step < last_step and episode < last_episode
            if not going_on:
                discount_rewards(position, params.gamma, step - discounted_step, taken)
                acted_episode = episode if taken == episode_step else episode - 1
                record_step(
                    record,
                    step,
                    acted_episode + 1,
                    taken,
                    forced >= 0,
                    explored,
                    epsilon_in(schedules, acted_episode),
                    outcome,
                    params.gamma,
                    experience,
                    update,
                )
    position.step[0] = step
    position.episodes[0] = episode
    position.state[0] = state
    position.episode_step[0] = episode_step
    position.episode_return[0] = episode_return
    position.first_reward_episode[0] = first_reward_episode
    log.finished[0] = logged
    return stop
