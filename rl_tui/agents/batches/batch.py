"""A batch of runs: many seeds of one setting."""

from __future__ import annotations

import importlib
import math
from collections.abc import Sequence
from typing import Any, Final, NamedTuple, TypeVar, cast

import numpy as np
from numpy.random import PCG64, Generator

from rl_tui.agents.batches.batch_loop import Runs, Shared, advance_runs
from rl_tui.agents.batches.digest import RECENT, Digest, mean_recent, new_digest
from rl_tui.agents.batches.four_actions import (
    FourActions,
    smallest_of_four,
    with_four_actions,
)
from rl_tui.agents.batches.interleaved_batches import SEATS, advance_in_turn, new_seats
from rl_tui.agents.batches.rows import stacked
from rl_tui.agents.batches.seeding import WordArray, copy_streams, streams_of
from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.after_update import new_record
from rl_tui.agents.kernels.drift import Drift, Drifted, drifted_by, new_drift
from rl_tui.agents.kernels.machine_code import Batching, fastest, machine_code
from rl_tui.agents.kernels.parameters import kernel_parameters, schedules_of
from rl_tui.agents.kernels.position import new_episode_log, new_position
from rl_tui.agents.kernels.tables import tables_of
from rl_tui.agents.kernels.watch import Watching, new_watch
from rl_tui.common.streams import Streams
from rl_tui.worlds.mdp.space import FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP, smallest_mdp

Array = TypeVar("Array", FloatArray, IntArray)

LOGGED: Final = 1024
"""Episodes after which the log of a run is summed up."""
UNLIMITED: Final = 2**60
_NONE: Final = -1


class DrawnWorld(NamedTuple):
    """A world drawn from a seed, and the streams afterwards."""

    mdp: TabularMDP
    streams: Streams


class RunBatch:
    """Runs of one algorithm with one setting and many seeds, in machine code.

    Results equal those of a :class:`~rl_tui.agents.learner.Learner`, bit for bit.

    Args:
        seeds: [B].
        world: The common world, or one per run with equal numbers of states, pairs and outcomes.
        steps: Length of a run in steps.
        episodes: Length in episodes, if earlier.
        curve_episodes: Number of episodes in the curve.
        width: Episodes per bin of the curve.
        mark_episodes: Rising numbers of episodes after which estimates are stored.
    """

    def __init__(
        self,
        algorithm: str,
        hyperparameters: Hyperparameters,
        seeds: Sequence[int],
        world: TabularMDP | Sequence[DrawnWorld],
        *,
        steps: int = UNLIMITED,
        episodes: int = UNLIMITED,
        curve_episodes: int = 0,
        width: int = 1,
        mark_episodes: Sequence[int] = (),
    ) -> None:
        self._goal = (steps if episodes else 0), episodes
        drawn = [] if isinstance(world, TabularMDP) else world
        worlds = [world] if isinstance(world, TabularMDP) else [mdp for mdp, _ in drawn]
        self._even = None if drawn else with_four_actions(worlds[0])
        worlds = worlds if self._even is None else [self._even.mdp]
        count, each = len(seeds), [1] * len(worlds) if drawn else [len(seeds)]
        mdp, tables = worlds[0], [tables_of(mdp) for mdp in worlds]
        self._streams, address = _streams_of(seeds, [streams for _, streams in drawn])
        agents = [
            _agent_in(mdp, algorithm, hyperparameters, in_turn=self._even is not None) for mdp in worlds
        ]
        self._runs = Runs(
            memory=stacked([memory for memory, _ in agents], each),
            rule=stacked([rule for _, rule in agents], each),
            params=kernel_parameters(hyperparameters),
            schedules=schedules_of(hyperparameters),
            tables=stacked(tables if self._even is None else [FourActions(*tables[0])], [1] * len(worlds)),
            drift=stacked([new_drift(mdp) for mdp in worlds], each),
            position=stacked([new_position(_NONE)], [count]),
            digest=stacked([new_digest(curve_episodes, width)], [count]),
            world=np.arange(count) if drawn else np.zeros(count, np.int64),
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
        """Take about `budget` steps, without the GIL. Return True if there are more."""
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
        # [… P] → the pairs of the real world
        return values if self._even is None else values[..., self._even.places]

    @property
    def q(self) -> FloatArray:
        """Estimates, [B, P]."""
        return self._of_own_pairs(cast("FloatArray", self._runs.memory.q))

    @property
    def visits(self) -> IntArray:
        """Visits of each pair, [B, P]."""
        return self._of_own_pairs(cast("IntArray", self._runs.memory.visits))

    @property
    def mark_estimates(self) -> FloatArray:
        """Estimates after each marked episode, [B, K, P]."""
        return self._of_own_pairs(self._mark_estimates)

    @property
    def longest(self) -> int:
        """Steps of the longest run so far."""
        return max(int(self.steps.max()), int(self._seats.step[: int(self._seats.taken[0])].max(initial=0)))

    def done(self) -> tuple[int, int]:
        """Return the steps and episodes of all runs."""
        seats, taken = self._seats, slice(0, int(self._seats.taken[0]))
        steps, episodes = int(seats.step[taken].sum()), int(seats.episode[taken].sum())
        return steps + int(self.steps.sum()), episodes + int(self.episodes.sum())

    @property
    def stop(self) -> IntArray:
        """Number of a :class:`Stop` of each run, [B]."""
        return self._runs.stop

    @property
    def steps(self) -> IntArray:
        """Steps taken, [B]; 0 in unfinished runs that take turns."""
        return self._runs.position.step[:, 0]

    @property
    def episodes(self) -> IntArray:
        """Finished episodes, [B]; 0 in unfinished runs that take turns."""
        return self._runs.position.episodes[:, 0]

    @property
    def first_reward_episode(self) -> IntArray:
        """First episode (from 1) with a non-zero reward, or 0, [B]."""
        return self._runs.position.first_reward_episode[:, 0]

    @property
    def marks_passed(self) -> IntArray:
        """Number of marks reached, [B]."""
        return self._runs.marks

    @property
    def digest(self) -> Digest:
        """Summary of the episodes, one row per run."""
        return self._runs.digest

    @property
    def drift(self) -> Drift:
        """Drift of bandit means, one row per run."""
        return self._runs.drift

    def drifted(self, run: int) -> Drifted | None:
        """Return the regret of `run` if means drift, else None."""
        drift = self._runs.drift
        return drifted_by(Drift(*(part[run] for part in drift)))

    def recent_means(self) -> tuple[FloatArray, FloatArray]:
        """Return mean return and length of the last 100 episodes, [B] each, or NaN.

        Sums are exact and rounded once.
        """
        returns, lengths = np.full((2, len(self.stop)), np.nan)
        fastest(mean_recent)(self._runs.digest, self.episodes, returns, lengths)
        for run in np.flatnonzero(np.isinf(returns)).tolist():
            found, _ = self.recent(run)
            returns[run] = math.fsum(found.tolist()) / len(found)
        return returns, lengths

    def recent(self, run: int) -> tuple[FloatArray, IntArray]:
        """Return returns and lengths of the last 100 episodes of `run`, unordered."""
        count = min(int(self.episodes[run]), RECENT)
        digest = self._runs.digest
        return digest.recent_returns[run, :count], digest.recent_lengths[run, :count]


def batching_of(mdp: TabularMDP, *, is_shared: bool) -> Batching:
    """Return how runs in `mdp` are batched."""
    return Batching.IN_TURN if is_shared and with_four_actions(mdp) else Batching.ONE_BY_ONE


def compile_batch(algorithm: str, hyperparameters: Hyperparameters, batching: Batching) -> None:
    """Compile the loop of a batch, or read it from the cache."""
    mdp = smallest_mdp() if batching is Batching.ONE_BY_ONE else smallest_of_four()
    RunBatch(algorithm, hyperparameters, [0], mdp, steps=0).advance(0)


def _agent_in(
    space: TabularMDP, algorithm: str, values: Hyperparameters, *, in_turn: bool
) -> tuple[Any, Any]:
    module = importlib.import_module(BY_ID[algorithm].module)
    policy = importlib.import_module(POLICY_BY_ID[values.policy].module)
    q = np.full(space.pairs, values.initial_q, dtype=np.float64)
    memory, rule = (
        module.new_memory(q, np.zeros(space.pairs, np.int64), space),
        policy.new_rule(space, values),
    )
    return memory, rule._replace(in_turn=True) if in_turn and hasattr(rule, "in_turn") else rule


def _streams_of(seeds: Sequence[int], drawn: Sequence[Streams]) -> tuple[WordArray, WordArray]:
    """Return memory and addresses of streams. `drawn` ones are continued."""
    memory, address = streams_of(seeds)
    for index, both in enumerate(drawn):
        copy_streams(both, memory[index])
    return memory, address
