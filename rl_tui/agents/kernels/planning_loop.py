"""The loop of planners: a step backs up one state, an episode is a sweep."""

from __future__ import annotations

from typing import Any

from rl_tui.agents.algorithms.family import Experience, back_up, has_converged
from rl_tui.agents.kernels.after_update import StepRecord, after_update, record_step
from rl_tui.agents.kernels.compiled import compiled
from rl_tui.agents.kernels.parameters import KernelParameters
from rl_tui.agents.kernels.position import CONVERGED, Position
from rl_tui.agents.kernels.tables import Tables
from rl_tui.agents.kernels.watch import Watch, watched


@compiled
def state_with_pairs(tables: Tables, start: int) -> int:
    """Return the first state from `start` on with pairs, or the number of states."""
    state = start
    while state < len(tables.first_pair) - 1 and tables.first_pair[state] == tables.first_pair[state + 1]:
        state += 1
    return state


@compiled
def sweep(
    memory: Any,
    params: KernelParameters,
    tables: Tables,
    position: Position,
    record: StepRecord,
    watch: Watch,
    steps: int,
    episodes: int,
) -> int:
    """Back up to `steps` states with pairs, or `episodes` sweeps, and return a :class:`Stop`.

    The next state is ``position.state``.
    """
    step, episode, state = position.step[0], position.episodes[0], position.state[0]
    first_step, last_step, last_episode = step, step + steps, episode + episodes
    watching = watch.active[0]
    stop = 0
    while stop == 0 and step < last_step and episode < last_episode:
        swept, backed_up = episode, state
        update = back_up(memory, params, tables, state, episode)
        step += 1
        position.episode_step[0] += 1
        swept_step = position.episode_step[0]
        experience = Experience(backed_up, -1, 0.0, backed_up, False, False)
        state = state_with_pairs(tables, state + 1)
        stop = after_update(record, update)
        if state == len(tables.first_pair) - 1:
            episode += 1
            state = state_with_pairs(tables, 0)
            position.episode_step[0] = 0
            if stop == 0 and has_converged(memory, params):
                stop = CONVERGED
        stop = watched(
            watching, watch, memory.q, params.random_ties, tables, experience, update, backed_up, stop
        )
    position.step[0], position.episodes[0], position.state[0] = step, episode, state
    if step > first_step:
        record_step(
            record, step, swept + 1, swept_step, False, False, 0.0, -1, params.gamma, experience, update
        )
    return stop
