"""The compiled loop over the runs of a batch."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from numpy.random import Generator

from rl_tui.agents.batches.digest import Digest, digest_episodes
from rl_tui.agents.batches.rows import generator_at, row
from rl_tui.agents.kernels.after_update import StepRecord
from rl_tui.agents.kernels.compiled import compiled
from rl_tui.agents.kernels.drift import Drift
from rl_tui.agents.kernels.loop import advance, start_state
from rl_tui.agents.kernels.parameters import KernelParameters, Schedules
from rl_tui.agents.kernels.position import DONE, EPISODES_FULL, EpisodeLog, Position
from rl_tui.agents.kernels.tables import Tables
from rl_tui.agents.kernels.watch import Watch
from rl_tui.worlds.mdp.space import FloatArray, IntArray


class Runs(NamedTuple):
    """The data of B runs with one setting, one row each.

    World `world`, [B], is a row of `tables`. The streams of world and learner are at `address`, [B, 2]. Each
    run has passed `marks`, [B].
    """

    memory: Any
    rule: Any
    params: KernelParameters
    schedules: Schedules
    tables: Tables
    drift: Drift
    position: Position
    digest: Digest
    world: IntArray
    address: npt.NDArray[np.uint64]
    stop: IntArray
    marks: IntArray


class Shared(NamedTuple):
    """Scratch memory for one run at a time."""

    log: EpisodeLog
    record: StepRecord
    watch: Watch


@compiled
def advance_runs(
    runs: Runs,
    shared: Shared,
    generator: Generator,
    mark_episodes: IntArray,
    mark_estimates: FloatArray,
    first: int,
    steps: int,
    episodes: int,
    budget: int,
) -> int:
    """Advance the runs one after the other until each has reached its goal.

    Returns the run to continue with after about `budget` steps, or B. Estimates after `mark_episodes`, [K],
    go to `mark_estimates`, [B, K, P]. Only the type of `generator` matters.
    """
    for run in range(first, len(runs.stop)):
        memory, rule = row(runs.memory, run), row(runs.rule, run)
        tables, drift = row(runs.tables, runs.world[run]), row(runs.drift, run)
        position, digest = row(runs.position, run), row(runs.digest, run)
        world = generator_at(generator, runs.address[run, 0])
        learner = generator_at(generator, runs.address[run, 1])
        if position.state[0] < 0:
            position.state[0] = start_state(tables, world)
        while position.step[0] < steps and position.episodes[0] < episodes:
            before, done = position.step[0], position.episodes[0]
            if budget <= 0:
                return run
            mark = runs.marks[run]
            until = min(episodes, mark_episodes[mark]) if mark < len(mark_episodes) else episodes
            shared.log.finished[0] = 0
            stop = advance(
                memory,
                rule,
                runs.params,
                runs.schedules,
                tables,
                drift,
                position,
                shared.log,
                shared.record,
                shared.watch,
                world,
                learner,
                min(steps - before, budget),
                until - done,
            )
            digest_episodes(digest, shared.log, done)
            budget -= position.step[0] - before
            runs.stop[run] = stop
            if stop != DONE and stop != EPISODES_FULL:
                break
            if mark < len(mark_episodes) and position.episodes[0] == mark_episodes[mark]:
                for pair in range(len(memory.q)):
                    mark_estimates[run, mark, pair] = memory.q[pair]
                runs.marks[run] = mark + 1
    return len(runs.stop)
