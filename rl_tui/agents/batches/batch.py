"""A batch of runs: many seeds, and settings, of one loop in worlds of one shape."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.random import PCG64, Generator

from rl_tui.agents.batches.batch_loop import Runs, Shared, advance_runs
from rl_tui.agents.batches.digest import RECENT, Digest, new_digest
from rl_tui.agents.batches.rows import stacked
from rl_tui.agents.batches.seeding import streams_of
from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.after_update import new_record
from rl_tui.agents.kernels.drift import Drift, Drifted, drifted_by, new_drift
from rl_tui.agents.kernels.machine_code import machine_code
from rl_tui.agents.kernels.parameters import kernel_parameters, schedules_of
from rl_tui.agents.kernels.position import new_episode_log, new_position
from rl_tui.agents.kernels.tables import tables_of
from rl_tui.agents.kernels.watch import Watching, new_watch
from rl_tui.common.streams import Streams
from rl_tui.worlds.mdp.smallest import smallest_mdp
from rl_tui.worlds.mdp.space import FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

LOGGED: Final = 1024
"""Episodes after which the runs' log is added up."""
UNLIMITED: Final = 2**60
_NONE: Final = -1


@dataclass(frozen=True, slots=True, eq=False)
class BatchedRun:
    """One of the runs of a batch.

    ``streams`` are given where the world was drawn from them; elsewhere they are those of ``seed``.
    """

    mdp: TabularMDP
    hyperparameters: Hyperparameters
    seed: int
    streams: Streams | None = None


class Batch:
    """Runs of one algorithm and one policy, in worlds of the same numbers of states, pairs and outcomes.

    Each is advanced to ``steps`` steps or ``episodes`` finished episodes, whichever comes first, with the
    bits of a :class:`~rl_tui.agents.learner.Learner`. Their curves are of the first ``curve_episodes``, in
    bins of ``width``. After each of ``mark_episodes``, which ascend, their estimates are kept.
    Only machine code can do it: see :func:`rl_tui.agents.compiling.loops.compile_here`.
    """

    def __init__(
        self,
        algorithm: str,
        runs: Sequence[BatchedRun],
        *,
        steps: int = UNLIMITED,
        episodes: int = UNLIMITED,
        curve_episodes: int = 0,
        width: int = 1,
        mark_episodes: Sequence[int] = (),
    ) -> None:
        self._goal = steps, episodes
        first = runs[0]
        self._streams, address = _streams_of(runs)
        worlds, world = _distinct([run.mdp for run in runs])
        agents = _agents_of(algorithm, runs)
        count = len(runs)
        self._runs = Runs(
            *agents,
            tables=stacked([tables_of(mdp) for mdp in worlds], [1] * len(worlds)),
            drift=stacked([new_drift(mdp) for mdp in worlds], np.bincount(world).tolist()),
            position=stacked([new_position(_NONE)], [count]),
            digest=stacked([new_digest(curve_episodes, width)], [count]),
            world=world,
            address=address,
            stop=np.zeros(count, np.int64),
            marks=np.zeros(count, np.int64),
        )
        watch = new_watch(Watching(), first.mdp, tables_of(first.mdp), self.q[0], random_ties=True)
        self._shared = Shared(new_episode_log(LOGGED), new_record(), watch)
        self._generator = Generator(PCG64(0))
        self._mark_episodes = np.array(mark_episodes, np.int64)
        self.mark_estimates: FloatArray = np.zeros((count, len(mark_episodes), first.mdp.pairs))
        """The estimates after each of the episodes that are marked, [B, K, P]."""
        self._next = 0

    def advance(self, budget: int) -> bool:
        """Take about ``budget`` steps, without the GIL; return whether there is anything left to do."""
        self._next = machine_code(advance_runs)(
            self._runs,
            self._shared,
            self._generator,
            self._mark_episodes,
            self.mark_estimates,
            self._next,
            *self._goal,
            budget,
        )
        return self._next < len(self._runs.stop)

    @property
    def q(self) -> FloatArray:
        """The estimates, [B, P]."""
        q: FloatArray = self._runs.memory.q
        return q

    @property
    def visits(self) -> IntArray:
        """How often each pair was taken, [B, P]."""
        visits: IntArray = self._runs.memory.visits
        return visits

    @property
    def stop(self) -> IntArray:
        """Why each came back, [B]: a number of :class:`Stop`."""
        return self._runs.stop

    @property
    def steps(self) -> IntArray:
        """The steps taken, [B]."""
        return self._runs.position.step[:, 0]

    @property
    def episodes(self) -> IntArray:
        """The finished episodes, [B]."""
        return self._runs.position.episodes[:, 0]

    @property
    def first_reward_episode(self) -> IntArray:
        """The first episode (from 1) with a reward that is not 0, [B]; 0 where there is none."""
        return self._runs.position.first_reward_episode[:, 0]

    @property
    def marks_passed(self) -> IntArray:
        """How many of the marks each has come to, [B]."""
        return self._runs.marks

    @property
    def digest(self) -> Digest:
        """What is kept of their episodes, a row each."""
        return self._runs.digest

    @property
    def drift(self) -> Drift:
        """How far the means of bandits have moved, a row each."""
        return self._runs.drift

    def drifted(self, run: int) -> Drifted | None:
        """Return how the pulls of ``run`` were spent, where means drift; None elsewhere."""
        drift = self._runs.drift
        return drifted_by(Drift(*(part[run] for part in drift)))

    def recent(self, run: int) -> tuple[FloatArray, IntArray]:
        """Return the returns and the lengths of the last 100 episodes of ``run``, in no order."""
        count = min(int(self.episodes[run]), RECENT)
        digest = self._runs.digest
        return digest.recent_returns[run, :count], digest.recent_lengths[run, :count]


def compile_batch(algorithm: str, hyperparameters: Hyperparameters) -> None:
    """Compile what advances a batch of this algorithm and policy, or read it from the cache."""
    Batch(algorithm, [BatchedRun(smallest_mdp(), hyperparameters, 0)], steps=0).advance(0)


def _agents_of(algorithm: str, runs: Sequence[BatchedRun]) -> tuple[Any, Any, Any, Any]:
    """Return memories, policies, parameters and schedules of ``runs``, a row each, those of equal settings
    made once.
    """
    module = importlib.import_module(BY_ID[algorithm].module)
    parts, counts = list[tuple[Any, Any, Any, Any]](), list[int]()
    before: BatchedRun | None = None
    for run in runs:
        if before is not None and before.hyperparameters is run.hyperparameters and before.mdp is run.mdp:
            counts[-1] += 1
            continue
        before, values, space = run, run.hyperparameters, run.mdp
        policy = importlib.import_module(POLICY_BY_ID[values.policy].module)
        q = np.full(space.pairs, values.initial_q, dtype=np.float64)
        memory = module.new_memory(q, np.zeros(space.pairs, np.int64), space)
        parts.append(
            (memory, policy.new_rule(space, values), kernel_parameters(values), schedules_of(values))
        )
        counts.append(1)
    memories, rules, params, schedules = zip(*parts, strict=True)
    return (
        stacked(memories, counts),
        stacked(rules, counts),
        stacked(params, counts),
        stacked(schedules, counts),
    )


def _distinct(worlds: Sequence[TabularMDP]) -> tuple[list[TabularMDP], IntArray]:
    """Return the worlds that differ from the one before, and which of them is whose, [B]."""
    found, whose = list[TabularMDP](), list[int]()
    for mdp in worlds:
        if not found or found[-1] is not mdp:
            found.append(mdp)
        whose.append(len(found) - 1)
    return found, np.array(whose, np.int64)


def _streams_of(runs: Sequence[BatchedRun]) -> tuple[Any, Any]:
    memory, address = streams_of([run.seed for run in runs])
    for index, run in enumerate(runs):
        for stream, generator in enumerate(run.streams or ()):
            state = generator.bit_generator.state["state"]
            for place, number in ((0, state["state"]), (2, state["inc"])):
                memory[index, stream, place] = number & (2**64 - 1)
                memory[index, stream, place + 1] = number >> 64
    return memory, address
