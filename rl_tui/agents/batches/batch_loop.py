"""The compiled loop over the runs of a batch, which uses the loop of a single run."""

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
    """The data of B runs, with one row each. They share one setting.

    `tables` has one row per world, and `world`, [B], is the row of each run. `address`, [B, 2], locates the
    streams of world and learner. `stop`, [B], is the reason of the last return, and `marks`, [B], the number
    of marks passed.
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
    """Scratch memory that the runs of a batch use in turn."""

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
    """Advance the runs one after the other, until each has reached its goal.

    Args:
        runs: Data of all runs, changed in place.
        shared: Scratch memory.
        generator: Any generator. Only its type matters.
        mark_episodes: Episodes after which estimates are stored, [K].
        mark_estimates: Receives these estimates, [B, K, P].
        first: Run to start with.
        steps: Goal in steps.
        episodes: Goal in episodes.
        budget: Approximate number of steps in this call.

    Returns:
        The run to continue with, or B when all have finished or failed.
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
