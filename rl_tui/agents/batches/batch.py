"""A batch of runs: many seeds of one setting, in worlds of one shape."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, TypeVar, cast

import numpy as np
from numpy.random import PCG64, Generator

from rl_tui.agents.batches.batch_loop import Runs, Shared, advance_runs
from rl_tui.agents.batches.digest import RECENT, Digest, new_digest
from rl_tui.agents.batches.four_actions import (
    FourActions,
    FourActionWorld,
    smallest_of_four,
    with_four_actions,
)
from rl_tui.agents.batches.rows import stacked
from rl_tui.agents.batches.seeding import streams_of
from rl_tui.agents.batches.turns import SEATS, advance_in_turn, new_seats
from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.after_update import new_record
from rl_tui.agents.kernels.drift import Drift, Drifted, drifted_by, new_drift
from rl_tui.agents.kernels.machine_code import Batching, machine_code
from rl_tui.agents.kernels.parameters import kernel_parameters, schedules_of
from rl_tui.agents.kernels.position import new_episode_log, new_position
from rl_tui.agents.kernels.tables import tables_of
from rl_tui.agents.kernels.watch import Watching, new_watch
from rl_tui.common.streams import Streams
from rl_tui.worlds.mdp.smallest import smallest_mdp
from rl_tui.worlds.mdp.space import FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

Array = TypeVar("Array", FloatArray, IntArray)

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
    seed: int
    streams: Streams | None = None


class Batch:
    """Runs of one algorithm with one setting, in worlds of the same numbers of states, pairs and outcomes.

    Each is advanced to ``steps`` steps or ``episodes`` finished episodes, whichever comes first, with the
    bits of a :class:`~rl_tui.agents.learner.Learner`. Their curves are of the first ``curve_episodes``, in
    bins of ``width``. After each of ``mark_episodes``, which ascend, their estimates are kept.
    Only machine code can do it: see :func:`rl_tui.agents.compiling.loops.compile_here`.
    """

    def __init__(
        self,
        algorithm: str,
        hyperparameters: Hyperparameters,
        runs: Sequence[BatchedRun],
        *,
        steps: int = UNLIMITED,
        episodes: int = UNLIMITED,
        curve_episodes: int = 0,
        width: int = 1,
        mark_episodes: Sequence[int] = (),
    ) -> None:
        self._goal = (steps if episodes else 0), episodes
        self._even = _even_world(runs)
        if self._even is not None:
            runs = [replace(run, mdp=self._even.mdp) for run in runs]
        mdp, count = runs[0].mdp, len(runs)
        self._streams, address = _streams_of(runs)
        worlds, world = _distinct([run.mdp for run in runs])
        tables = [tables_of(mdp) for mdp in worlds]
        self._runs = Runs(
            *_agents_of(algorithm, hyperparameters, runs, in_turn=self._even is not None),
            params=kernel_parameters(hyperparameters),
            schedules=schedules_of(hyperparameters),
            tables=stacked(tables if self._even is None else [FourActions(*tables[0])], [1] * len(worlds)),
            drift=stacked([new_drift(mdp) for mdp in worlds], np.bincount(world).tolist()),
            position=stacked([new_position(_NONE)], [count]),
            digest=stacked([new_digest(curve_episodes, width)], [count]),
            world=world,
            address=address,
            stop=np.zeros(count, np.int64),
            marks=np.zeros(count, np.int64),
        )
        watch = new_watch(Watching(), mdp, tables[0], self._runs.memory.q[0], random_ties=True)
        self._shared = Shared(new_episode_log(LOGGED), new_record(), watch)
        self._seats = new_seats(SEATS, LOGGED)
        self._generator = Generator(PCG64(0))
        self._mark_episodes = np.array(mark_episodes, np.int64)
        self._mark_estimates: FloatArray = np.zeros((count, len(mark_episodes), mdp.pairs))
        self._next = 0

    def advance(self, budget: int) -> bool:
        """Take about ``budget`` steps, without the GIL; return whether there is anything left to do."""
        marks = self._mark_episodes, self._mark_estimates
        if self._even is not None:
            return bool(
                machine_code(advance_in_turn)(
                    self._runs, self._seats, self._generator, *marks, *self._goal, budget
                )
            )
        self._next = machine_code(advance_runs)(
            self._runs, self._shared, self._generator, *marks, self._next, *self._goal, budget
        )
        return self._next < len(self._runs.stop)

    def _of_own_pairs(self, values: Array) -> Array:
        """Return those of ``values``, […, P], that are of pairs of the world itself."""
        return values if self._even is None else values[..., self._even.places]

    @property
    def q(self) -> FloatArray:
        """The estimates, [B, P]."""
        return self._of_own_pairs(cast("FloatArray", self._runs.memory.q))

    @property
    def visits(self) -> IntArray:
        """How often each pair was taken, [B, P]."""
        return self._of_own_pairs(cast("IntArray", self._runs.memory.visits))

    @property
    def mark_estimates(self) -> FloatArray:
        """The estimates after each of the episodes that are marked, [B, K, P]."""
        return self._of_own_pairs(self._mark_estimates)

    @property
    def longest(self) -> int:
        """The steps of the run that has most of them so far."""
        return max(int(self.steps.max()), int(self._seats.step[: int(self._seats.taken[0])].max(initial=0)))

    def done(self) -> tuple[int, int]:
        """Return how many steps and how many episodes all of them have done together."""
        seats, taken = self._seats, slice(0, int(self._seats.taken[0]))
        steps, episodes = int(seats.step[taken].sum()), int(seats.episode[taken].sum())
        return steps + int(self.steps.sum()), episodes + int(self.episodes.sum())

    @property
    def stop(self) -> IntArray:
        """Why each came back, [B]: a number of :class:`Stop`."""
        return self._runs.stop

    @property
    def steps(self) -> IntArray:
        """The steps taken, [B]; of runs that take turns, 0 until they are done."""
        return self._runs.position.step[:, 0]

    @property
    def episodes(self) -> IntArray:
        """The finished episodes, [B]; of runs that take turns, 0 until they are done."""
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


def batching_of(mdp: TabularMDP, *, is_shared: bool) -> Batching:
    """Return how runs in the world of ``mdp`` are batched, which all of them have if it ``is_shared``."""
    return Batching.IN_TURN if is_shared and with_four_actions(mdp) else Batching.ONE_BY_ONE


def compile_batch(algorithm: str, hyperparameters: Hyperparameters, batching: Batching) -> None:
    """Compile what advances a batch of this algorithm and policy, or read it from the cache."""
    mdp = smallest_mdp() if batching is Batching.ONE_BY_ONE else smallest_of_four()
    Batch(algorithm, hyperparameters, [BatchedRun(mdp, 0)], steps=0).advance(0)


def _even_world(runs: Sequence[BatchedRun]) -> FourActionWorld | None:
    mdp = runs[0].mdp
    return with_four_actions(mdp) if all(run.mdp is mdp for run in runs) else None


def _agents_of(
    algorithm: str, values: Hyperparameters, runs: Sequence[BatchedRun], *, in_turn: bool
) -> tuple[Any, Any]:
    """Return the memories and the policies of ``runs``, a row each, those in the same world made once."""
    module = importlib.import_module(BY_ID[algorithm].module)
    policy = importlib.import_module(POLICY_BY_ID[values.policy].module)
    memories, rules = [], []
    worlds, world = _distinct([run.mdp for run in runs])
    for space in worlds:
        q = np.full(space.pairs, values.initial_q, dtype=np.float64)
        memories.append(module.new_memory(q, np.zeros(space.pairs, np.int64), space))
        rule = policy.new_rule(space, values)
        rules.append(rule._replace(in_turn=True) if in_turn and hasattr(rule, "in_turn") else rule)
    counts = np.bincount(world).tolist()
    return stacked(memories, counts), stacked(rules, counts)


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
