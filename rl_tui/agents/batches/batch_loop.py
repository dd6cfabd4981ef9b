"""The loop over the runs of a batch, compiled: each is advanced by the very loop of a single run."""

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
    """All that B runs have, a row each; of their settings there is one.

    ``tables`` has a row for each world, and ``world``, [B], says which is whose. ``address``, [B, 2], is
    where the streams of world and learner are. ``stop``, [B], is why a run came back the last time, and
    ``marks``, [B], how many of the marks it has passed.
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
    """What the runs of a batch use in turn: room that nothing is kept in."""

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
    """Advance the runs from ``first`` on, one after the other, until each has ``steps`` or ``episodes``.

    After each of ``mark_episodes``, [K], its estimates are copied to ``mark_estimates``, [B, K, P]. It comes
    back after about ``budget`` steps, or when all are done or broke down; returns the run to go on with.
    ``generator`` is any one: it lends its type.
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
