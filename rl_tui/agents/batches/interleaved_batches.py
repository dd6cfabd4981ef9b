"""Runs that take turns: while one waits for memory, the processor works on others."""

from __future__ import annotations

from typing import Any, Final, NamedTuple

import numpy as np
from numpy.random import Generator

from rl_tui.agents.algorithms.family import Experience, act, has_room, learn
from rl_tui.agents.batches.batch_loop import Runs
from rl_tui.agents.batches.digest import digest_episodes
from rl_tui.agents.batches.rows import generator_at, row
from rl_tui.agents.kernels.compiled import compiled, for_kernels, inlined
from rl_tui.agents.kernels.loop import draw_outcome, draw_reward, start_state
from rl_tui.agents.kernels.parameters import alpha_in, epsilon_in, with_alpha
from rl_tui.agents.kernels.position import (
    DIVERGED,
    DONE,
    ENDLESS_EPISODE,
    LARGEST_ESTIMATE,
    LONGEST_EPISODE,
    MEMORY_FULL,
    EpisodeLog,
)
from rl_tui.agents.kernels.tables import IndexArray, Tables, landing
from rl_tui.agents.policies.family import in_force
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

SEATS: Final = 4
"""Number of runs that take turns. With eight, the processor has too few registers."""


class Seats(NamedTuple):
    """The state of the runs that take turns, one seat each, [M]. The first `taken`, [1], are in use.

    The next run without a seat is `waiting`, [1]. A run needs attention after `until_episode` episodes, or
    for `stop`. Its latest `logged` episodes are in `returns` and `lengths`, [M, L]. Indices are unsigned; see
    :class:`Tables`.
    """

    run: IndexArray
    taken: IntArray
    waiting: IntArray
    step: IntArray
    episode: IntArray
    until_episode: IntArray
    state: IndexArray
    episode_step: IntArray
    episode_return: FloatArray
    first_reward_episode: IntArray
    epsilon: FloatArray
    alpha: FloatArray
    stop: IntArray
    logged: IntArray
    returns: FloatArray
    lengths: IntArray
    optimal: BoolArray


def new_seats(seats: int, logged: int) -> Seats:
    """Return empty seats, each with room for `logged` episodes."""
    whole, real = np.zeros((7, seats), np.int64), np.zeros((3, seats))
    return Seats(
        run=np.zeros(seats, np.uint32),
        taken=np.zeros(1, np.int64),
        waiting=np.zeros(1, np.int64),
        step=whole[0],
        episode=whole[1],
        until_episode=whole[2],
        state=np.zeros(seats, np.uint32),
        episode_step=whole[3],
        episode_return=real[0],
        first_reward_episode=whole[4],
        epsilon=real[1],
        alpha=real[2],
        stop=whole[5],
        logged=whole[6],
        returns=np.zeros((seats, logged)),
        lengths=np.zeros((seats, logged), np.int64),
        optimal=np.zeros(logged, np.bool_),
    )


@compiled
def advance_in_turn(
    runs: Runs,
    seats: Seats,
    generator: Generator,
    mark_episodes: IntArray,
    mark_estimates: FloatArray,
    steps: int,
    episodes: int,
    budget: int,
) -> bool:
    """Advance all runs in turn, like :func:`~rl_tui.agents.batches.batch_loop.advance_runs`.

    They share one world, not a bandit. Returns True if there is more to do.
    """
    tables = row(runs.tables, 0)
    while True:
        while seats.taken[0] < len(seats.run) and seats.waiting[0] < len(runs.stop):
            _sit_down(runs, seats, tables, generator, mark_episodes, episodes)
        taken = seats.taken[0]
        if taken == 0:
            return False
        if budget <= 0:
            return True
        rounds = budget // taken + 1
        for seat in range(taken):
            rounds = min(rounds, steps - seats.step[seat], LONGEST_EPISODE - seats.episode_step[seat])
        rounds = take_rounds(runs, seats, tables, generator, taken, rounds)
        budget -= rounds * taken
        for seat in range(taken - 1, -1, -1):
            seats.step[seat] += rounds
            _look_after(runs, seats, seat, mark_episodes, mark_estimates, steps, episodes)


@for_kernels
def take_rounds(runs: Runs, seats: Seats, tables: Any, generator: Generator, taken: int, rounds: int) -> int:
    """Let the first `taken` seats take turns for `rounds`, or until a run needs attention.

    Returns the rounds done, each a step as in :func:`rl_tui.agents.kernels.loop.advance`.
    """
    drift = row(runs.drift, 0)
    # Shared data is read once, since policies that learn are for bandits only
    first_rule = row(runs.rule, 0)
    done, is_due = 0, False
    while done < rounds and not is_due:
        done += 1
        for seat in range(taken):
            run, state = _index(seats.run, seat), _index(seats.state, seat)
            memory = row(runs.memory, run)
            rule = in_force(first_rule, seats.epsilon[seat])
            params = with_alpha(runs.params, seats.alpha[seat])
            world = generator_at(generator, runs.address[run, 0])
            learner = generator_at(generator, runs.address[run, 1])
            # Choose A from S using the policy derived from Q
            pair, _ = act(memory, rule, tables, state, learner)
            # Take action A, observe R, S′
            outcome = draw_outcome(tables, pair, world)
            reward = draw_reward(tables, drift, pair, outcome, world)
            next_state = landing(tables, outcome)
            terminated = tables.terminated[outcome]
            episode_step = seats.episode_step[seat] + 1
            episode_return = seats.episode_return[seat] + reward
            truncated = episode_step == tables.time_limit and not terminated
            experience = Experience(state, pair, reward, next_state, terminated, truncated)
            update = learn(memory, rule, params, tables, experience, learner)
            # S ← S′, until S is terminal or the time is up
            if seats.first_reward_episode[seat] == 0 and reward != 0.0:
                seats.first_reward_episode[seat] = seats.episode[seat] + 1
            if not abs(update.extreme) <= LARGEST_ESTIMATE:
                seats.stop[seat] = DIVERGED
                is_due = True
            elif terminated or truncated:
                logged = seats.logged[seat]
                seats.returns[seat, logged] = episode_return
                seats.lengths[seat, logged] = episode_step
                seats.logged[seat] = logged + 1
                episode = seats.episode[seat] + 1
                seats.episode[seat] = episode
                is_due = (
                    is_due or episode == seats.until_episode[seat] or logged + 1 == seats.returns.shape[1]
                )
                seats.epsilon[seat] = epsilon_in(runs.schedules, episode)
                seats.alpha[seat] = alpha_in(runs.schedules, episode)
                next_state = start_state(tables, world)
                episode_step, episode_return = 0, 0.0
            elif not has_room(memory):
                seats.stop[seat] = MEMORY_FULL
                is_due = True
            seats.state[seat] = next_state
            seats.episode_step[seat] = episode_step
            seats.episode_return[seat] = episode_return
    return done


@inlined
def _index(indices: IndexArray, place: int) -> int:
    return np.int64(indices[place])  # type: ignore[return-value]


@for_kernels
def _sit_down(
    runs: Runs, seats: Seats, tables: Tables, generator: Generator, mark_episodes: IntArray, episodes: int
) -> None:
    seat, run = seats.taken[0], seats.waiting[0]
    seats.taken[0] += 1
    seats.waiting[0] += 1
    seats.run[seat] = run
    seats.step[seat] = seats.episode[seat] = seats.episode_step[seat] = seats.logged[seat] = 0
    seats.first_reward_episode[seat] = 0
    seats.episode_return[seat] = 0.0
    seats.stop[seat] = DONE
    seats.epsilon[seat], seats.alpha[seat] = epsilon_in(runs.schedules, 0), alpha_in(runs.schedules, 0)
    seats.state[seat] = start_state(tables, generator_at(generator, runs.address[run, 0]))
    seats.until_episode[seat] = min(episodes, mark_episodes[0]) if len(mark_episodes) > 0 else episodes


@for_kernels
def _look_after(
    runs: Runs,
    seats: Seats,
    seat: int,
    mark_episodes: IntArray,
    mark_estimates: FloatArray,
    steps: int,
    episodes: int,
) -> None:
    # Sums up its episodes, stores estimates at a mark, and frees the seat of a finished run
    run, episode = _index(seats.run, seat), seats.episode[seat]
    digest, position = row(runs.digest, run), row(runs.position, run)
    logged = seats.logged[seat : seat + 1]
    log = EpisodeLog(logged, seats.returns[seat], seats.lengths[seat], seats.optimal)
    digest_episodes(digest, log, episode - logged[0])
    logged[0] = 0
    mark = runs.marks[run]
    if mark < len(mark_episodes) and episode == mark_episodes[mark]:
        memory = row(runs.memory, run)
        for pair in range(len(memory.q)):
            mark_estimates[run, mark, pair] = memory.q[pair]
        mark += 1
        runs.marks[run] = mark
        until = min(episodes, mark_episodes[mark]) if mark < len(mark_episodes) else episodes
        seats.until_episode[seat] = until
    if seats.stop[seat] == DONE and seats.episode_step[seat] >= LONGEST_EPISODE:
        seats.stop[seat] = ENDLESS_EPISODE
    if seats.stop[seat] == DONE and seats.step[seat] < steps and episode < episodes:
        return
    position.step[0] = seats.step[seat]
    position.episodes[0] = episode
    position.first_reward_episode[0] = seats.first_reward_episode[seat]
    runs.stop[run] = seats.stop[seat]
    # The last seat moves here. It was handled already, because seats are visited in reverse
    last = seats.taken[0] - 1
    seats.taken[0] = last
    _move(seats, last, seat)


@inlined
def _move(seats: Seats, origin: int, seat: int) -> None:
    seats.run[seat] = seats.run[origin]
    seats.step[seat] = seats.step[origin]
    seats.episode[seat] = seats.episode[origin]
    seats.until_episode[seat] = seats.until_episode[origin]
    seats.state[seat] = seats.state[origin]
    seats.episode_step[seat] = seats.episode_step[origin]
    seats.episode_return[seat] = seats.episode_return[origin]
    seats.first_reward_episode[seat] = seats.first_reward_episode[origin]
    seats.epsilon[seat] = seats.epsilon[origin]
    seats.alpha[seat] = seats.alpha[origin]
    seats.stop[seat] = seats.stop[origin]
