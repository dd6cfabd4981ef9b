"""The agent–environment loop without a transition table, one step per call."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.random import Generator

from rl_tui.agents.algorithms.family import Experience, act, has_room, learn, on_override
from rl_tui.agents.kernels.after_update import StepRecord, after_update, record_step
from rl_tui.agents.kernels.compiled import compiled
from rl_tui.agents.kernels.machine_code import interpreted, machine_code
from rl_tui.agents.kernels.parameters import KernelParameters, Schedules, scheduled, with_alpha
from rl_tui.agents.kernels.position import (
    ENDLESS_EPISODE,
    EPISODES_FULL,
    LONGEST_EPISODE,
    MEMORY_FULL,
    REWARDS_KEPT,
    EpisodeLog,
    Position,
    Stop,
    discount_rewards,
)
from rl_tui.agents.kernels.tables import Tables, pairs_of
from rl_tui.agents.kernels.watch import Watch, watched
from rl_tui.agents.policies.family import in_force, reinforce
from rl_tui.worlds.environment import Environment, EnvironmentFailedError
from rl_tui.worlds.mdp.space import IntArray

MOST_SEEDS: Final = 2**31


class Chosen(NamedTuple):
    """The chosen pair, [1], and 1 if it explores, [1]."""

    pair: IntArray
    explored: IntArray


@compiled
def turn(
    memory: Any,
    rule: Any,
    params: KernelParameters,
    schedules: Schedules,
    tables: Tables,
    position: Position,
    log: EpisodeLog,
    record: StepRecord,
    watch: Watch,
    chosen: Chosen,
    learner: Generator,
    has_result: bool,
    next_state: int,
    reward: float,
    terminated: bool,
    truncated: bool,
    start: int,
    last_step: int,
    last_episode: int,
) -> int:
    """Learn from the result of the chosen action, if any, then choose the next.

    If the episode is over, `start` begins the next one. Returns the pair to take, or −1 − :class:`Stop`. One
    call per step, because a call costs more than its work.
    """
    step = position.step[0]
    episode = position.episodes[0]
    state = position.state[0]
    epsilon = scheduled(schedules.epsilon, episode)
    rule = in_force(rule, epsilon)
    params = with_alpha(params, scheduled(schedules.alpha, episode))
    stop = 0
    if has_result:
        # Take action A, observe R, S′: done by the caller
        experience = Experience(state, chosen.pair[0], reward, next_state, terminated, truncated)
        step += 1
        position.rewards[position.episode_step[0] % REWARDS_KEPT] = reward
        episode_step = position.episode_step[0] + 1
        discount_rewards(position, params.gamma, 1, episode_step)
        position.step[0] = step
        position.episode_step[0] = episode_step
        position.episode_return[0] += reward
        update = learn(memory, rule, params, tables, experience, learner)
        first_pair, last_pair = pairs_of(tables, state)
        reinforce(rule, params.alpha, first_pair, last_pair, chosen.pair[0], reward)
        by_hand, explored = position.forced[0] >= 0, chosen.explored[0] == 1
        record_step(
            record,
            step,
            episode + 1,
            episode_step,
            by_hand,
            explored,
            epsilon,
            -1,
            params.gamma,
            experience,
            update,
        )
        # S ← S′, until S is terminal or the time is up
        state = next_state
        if position.first_reward_episode[0] == 0 and reward != 0.0:
            position.first_reward_episode[0] = episode + 1
        stop = after_update(record, update)
        if stop != 0:
            pass  # an estimate diverged, so nothing else matters
        elif terminated or truncated:
            logged = log.finished[0]
            log.returns[logged] = position.episode_return[0]
            log.lengths[logged] = episode_step
            log.optimal[logged] = False
            log.finished[0] = logged + 1
            if logged + 1 == len(log.returns):
                stop = EPISODES_FULL
            episode += 1
            position.episodes[0] = episode
            position.episode_step[0] = 0
            position.episode_return[0] = 0.0
            rule = in_force(rule, scheduled(schedules.epsilon, episode))
            params = with_alpha(params, scheduled(schedules.alpha, episode))
            state = start
        elif episode_step >= LONGEST_EPISODE:
            stop = ENDLESS_EPISODE
        elif not has_room(memory):
            stop = MEMORY_FULL
        position.state[0] = state
        watching, random_ties = watch.active[0], params.random_ties
        stop = watched(watching, watch, memory.q, random_ties, tables, experience, update, state, stop)
    if stop != 0 or step >= last_step or episode >= last_episode:
        return np.int64(-1 - stop)  # type: ignore[return-value]
    # Choose A from S using the policy derived from Q
    forced = position.forced[0]
    if forced >= 0:
        pair, explored = forced, False
        on_override(memory, tables, state, forced)
    else:
        pair, explored = act(memory, rule, tables, state, learner)
    chosen.pair[0] = pair
    chosen.explored[0] = explored
    return np.int64(pair)  # type: ignore[return-value]


class SteppedLoop:
    """One environment and its current episode, seeded by a draw from `world`.

    The first episode starts in `state`. Errors of the environment are in `failure`. Steps start only within
    `time_budget` seconds of :meth:`advance`. Pairs have the actions `pair_action`, [P].

    Raises:
        EnvironmentFailedError: The environment cannot start.
    """

    def __init__(self, environment: Environment, world: Generator, pair_action: IntArray) -> None:
        self.failure = ""
        self.time_budget = math.inf
        self.state = environment.reset(int(world.integers(MOST_SEEDS)))
        self._environment = environment
        self._pair_action = pair_action
        self._chosen = Chosen(np.zeros(1, np.int64), np.zeros(1, np.int64))
        self._compiled_for: tuple[type, ...] = ()
        self._machine_code: Callable[..., int] = turn

    def advance(
        self,
        memory: Any,
        rule: Any,
        params: KernelParameters,
        schedules: Schedules,
        tables: Tables,
        position: Position,
        log: EpisodeLog,
        record: StepRecord,
        watch: Watch,
        learner: Generator,
        steps: int,
        episodes: int,
        in_machine_code: bool,
    ) -> Stop:
        """Take steps until the step, episode or time limit is reached, with the bits of the compiled loop.

        If the environment fails, the loop stops after the last valid step.
        """
        args = (memory, rule, params, schedules, tables, position, log, record, watch, self._chosen, learner)
        last_step = int(position.step[0]) + steps
        last_episode = int(position.episodes[0]) + episodes
        nothing = (False, 0, 0.0, False, False, 0)
        take_turn: Callable[..., int] = interpreted(turn)
        if in_machine_code:
            types = type(memory), type(rule)
            if types != self._compiled_for:
                self._machine_code = machine_code(turn, *args, *nothing, last_step, last_episode)
                self._compiled_for = types
            take_turn = self._machine_code
        until = time.perf_counter() + self.time_budget
        pair = take_turn(*args, *nothing, last_step, last_episode)
        while pair >= 0:
            step = int(position.step[0]) + 1
            try:
                result = self._environment.step(int(self._pair_action[pair]))
            except EnvironmentFailedError as failure:
                self.failure = f"at step {step:,} {failure}"
                return Stop.WORLD_FAILED
            start = result.next_state
            if result.terminated or result.truncated:
                start = self._start(result.next_state, step)
            if self.failure or time.perf_counter() >= until:
                last_step = 0  # the step itself was valid: learn from it, but choose no further action
            pair = take_turn(*args, True, *result, start, last_step, last_episode)
        stop = Stop(-1 - pair)
        return Stop.WORLD_FAILED if self.failure and stop is not Stop.DIVERGED else stop

    def _start(self, otherwise: int, step: int) -> int:
        # `otherwise` on failure
        try:
            return self._environment.reset()
        except EnvironmentFailedError as failure:
            self.failure = f"after step {step:,} {failure}"
            return otherwise
