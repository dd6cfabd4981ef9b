"""The memory of a learner: content, changes, copies, and final stops."""

from __future__ import annotations

import importlib
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID, SweepPhase
from rl_tui.agents.compatibility import check_compatible
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.drift import Drifted, drifted_by, new_drift
from rl_tui.agents.kernels.environment_loop import SteppedLoop
from rl_tui.agents.kernels.loop import start_state
from rl_tui.agents.kernels.parameters import kernel_parameters, schedules_of
from rl_tui.agents.kernels.position import Stop
from rl_tui.agents.kernels.tables import tables_of
from rl_tui.agents.kernels.watch import WatchedEvents, Watching, forget, new_watch, noticed_by
from rl_tui.agents.last_step import Author, LastStep
from rl_tui.agents.learner_counters import LearnerCounters
from rl_tui.agents.world_change import (
    carried_state,
    carried_watching,
    carry_drift,
    carry_over,
    goes_on,
    starts_in,
)
from rl_tui.common.errors import UserError
from rl_tui.common.streams import Streams
from rl_tui.worlds.editing.carried import Carried
from rl_tui.worlds.environment import Environment
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# Why a learner stops for good


def breakdown(stop: Stop, algorithm: str, last: LastStep, space: FiniteSpace, q: FloatArray) -> str:
    """Return why a learner stopped for good, as a sentence, or ""."""
    if stop is Stop.DIVERGED:
        pair = int(np.argmax(np.nan_to_num(np.abs(q), nan=np.inf)))
        chosen = BY_ID[algorithm]
        traces = "lambda" in chosen.parameters
        remedy = "discount" if chosen.planner else "step size or λ" if traces else "step size"
        return (
            f"Q({space.pair_name(pair)}) left ±1e12 at step {last.step:,}: "
            f"take a smaller {remedy} or start again"
        )
    if stop is Stop.ENDLESS_EPISODE:
        return f"episode {last.episode:,} has not ended after 10,000,000 steps, at step {last.step:,}"
    if stop is Stop.MEMORY_FULL:
        return (
            f"{BY_ID[algorithm].name} remembers 1,000,000 steps of an episode, and episode "
            f"{last.episode:,} has not ended, at step {last.step:,}"
        )
    return ""


# A copy to return to


Arrays = tuple[Any, ...]


class Planned(NamedTuple):
    """Steps and episodes that were a planner's backups and sweeps."""

    steps: int
    sweeps: int


@dataclass(frozen=True, slots=True, eq=False)
class LearnerState:
    """A copy of the state of a learner, except `space`.

    Arrays of the memory may be shortened; see :func:`put_back`.
    """

    space: FiniteSpace
    algorithm: str
    hyperparameters: Hyperparameters
    memory: Arrays
    rule: Arrays
    drift: Arrays
    position: Arrays
    record: Arrays
    streams: tuple[Any, ...]
    planned: Planned
    author: Author
    came_to_rest: bool
    world_since: int
    stop: Stop

    @property
    def nbytes(self) -> int:
        """Size of the copies in bytes."""
        parts = (self.memory, self.rule, self.drift, self.position, self.record)
        return sum(array.nbytes for part in parts for array in part)


def arrays_of(parts: Iterable[Any]) -> Arrays:
    """Return the arrays in `parts`."""
    return tuple(part for part in parts if isinstance(part, np.ndarray))


def copies(arrays: Iterable[Any]) -> Arrays:
    """Return copies of `arrays`."""
    return tuple(array.copy() for array in arrays)


def put_back(arrays: Iterable[Any], kept: Arrays) -> None:
    """Write the stored beginning back into each array, [n]. The rest is unused."""
    for array, copy in zip(arrays, kept, strict=True):
        array[: len(copy)] = copy


# The live memory


class LearnerMemory(LearnerCounters):
    """The complete state of a learner.

    `q` (float64) and `visits` (int64), both [P], are live arrays. Read them only between calls that advance
    the learner.

    Args:
        space: A TabularMDP, or a space without a transition table.
        streams: Random streams of world and learner.
        environment: Needed if `space` has no transition table.

    Raises:
        UserError: The algorithm or policy cannot work in `space`.
    """

    def __init__(
        self,
        space: FiniteSpace,
        algorithm: str,
        hyperparameters: Hyperparameters,
        streams: Streams,
        environment: Environment | None = None,
    ) -> None:
        check_compatible(space, algorithm, hyperparameters)
        super().__init__()
        self.streams = streams
        self._stepped = (
            None if environment is None else SteppedLoop(environment, streams.world, space.pair_action)
        )
        self.rewindable = environment is None
        """True if it can return to a checkpoint, which a simulated environment cannot."""
        self.planned = Planned(0, 0)
        """The planner's part of all steps and episodes."""
        self.author = Author(algorithm, hyperparameters)
        """Algorithm and settings of the last step, or of the first one before it."""
        self.came_to_rest = False
        """True if a planner had converged in the last step, whatever changed since."""
        self.rule: Any
        """Current rule of the policy, with live arrays of what it has learned."""
        self._memory: Any
        self._stop = Stop.DONE
        self._watching: Watching | None = None
        self._take_space(space, hyperparameters)
        self._take_algorithm(algorithm)
        self._begin_anew()

    def configure(self, hyperparameters: Hyperparameters) -> None:
        """Use new settings from the next step on. ``initial_q`` does not affect existing pairs.

        The knowledge of a policy is kept while the policy stays the same.

        Raises:
            UserError: The settings cannot work here.
        """
        other_policy = hyperparameters.policy != self.hyperparameters.policy
        other_ties = hyperparameters.ties != self.hyperparameters.ties
        if other_policy or hyperparameters.sample_average:  # other changes cannot make an agent incompatible
            check_compatible(self.space, self.algorithm, hyperparameters)
        learned = () if other_policy else arrays_of(self.rule)
        self._take_rule(hyperparameters)
        if learned:
            put_back(arrays_of(self.rule), learned)
        if other_ties:
            noticed = self._watch.noticed.copy()
            self.watch(self._watching)  # the new tie rule redefines the former greedy policy
            self._watch.noticed[:] = noticed
        self._go_on_planning()

    def switch(self, algorithm: str) -> None:
        """Continue with another algorithm and the same estimates and visits.

        The rest of the memory is new. The current episode is abandoned only between agent and planner.

        Raises:
            ValueError: There is no such algorithm.
            UserError: The algorithm cannot work here.
        """
        check_compatible(self.space, algorithm, self.hyperparameters)
        planned = self.plans
        self._take_algorithm(algorithm)
        if planned or self.plans:
            self._begin_anew()
        self._go_on_planning()

    def enter(self, space: FiniteSpace) -> None:
        """Enter another world with empty memory, before :meth:`restore`."""
        self._watching = None
        self._take_space(space, self.hyperparameters)
        self._take_algorithm(self.algorithm)

    def change_world(self, space: FiniteSpace, carried: Carried) -> bool:
        """Continue in another world, with everything learned about the common part.

        New pairs start at ``initial_q`` without visits. The current episode is abandoned if its state is gone
        or terminal, or if the new time limit has passed. A planner begins a sweep.

        Args:
            space: The new world.
            carried: Former numbers of its states and pairs.

        Returns:
            True if an episode was abandoned.

        Raises:
            UserError: The agent cannot work in `space`. Nothing has changed then.
        """
        check_compatible(space, self.algorithm, self.hyperparameters)
        state, watching = carried_state(carried, self.state), carried_watching(carried, self._watching)
        q, visits, drift, rule = self.q, self.visits, self._drift, self.rule
        self._take_space(space, self.hyperparameters)
        carry_over(self.q, q, carried.pairs)
        carry_over(self.visits, visits, carried.pairs)
        carry_drift(self._drift, drift, carried.pairs)
        policy = importlib.import_module(POLICY_BY_ID[self.hyperparameters.policy].module)
        if hasattr(policy, "carry_rule"):
            policy.carry_rule(self.rule, rule, carried.pairs)
        self._take_algorithm(self.algorithm)
        self._record.updates[0] = 0
        self.world_since = self.step
        self.watch(watching)
        self._go_on_planning()
        is_under_way = self.episode_step > 0 and not self.plans
        given_up = is_under_way and not goes_on(space, state, self.episode_step)
        if self.plans or given_up or (self.episode_step == 0 and not starts_in(space, state)):
            self._begin_anew()
        else:
            self._position.state[0] = state
        return given_up

    def _take_space(self, space: FiniteSpace, hyperparameters: Hyperparameters) -> None:
        self.space = space
        self.q: FloatArray = np.full(space.pairs, hyperparameters.initial_q, dtype=np.float64)
        self.visits: IntArray = np.zeros(space.pairs, dtype=np.int64)
        self._tables = tables_of(space)
        self._drift = new_drift(space)
        self._watch = new_watch(Watching(), space, self._tables, self.q, random_ties=True)
        self._take_rule(hyperparameters)

    def _take_rule(self, hyperparameters: Hyperparameters) -> None:
        policy = importlib.import_module(POLICY_BY_ID[hyperparameters.policy].module)
        self.rule = policy.new_rule(self.space, hyperparameters)
        self.hyperparameters = hyperparameters
        self._params = kernel_parameters(hyperparameters)
        self._schedules = schedules_of(hyperparameters)

    def _take_algorithm(self, algorithm: str) -> None:
        self._row = BY_ID[algorithm]
        self._module = importlib.import_module(self._row.module)
        self.algorithm, self.plans = algorithm, self._row.planner
        self._memory = self._module.new_memory(self.q, self.visits, self.space)

    def _begin_anew(self) -> None:
        if self.plans:
            start = int(np.argmax(np.diff(self.space.first_pair) > 0))
        elif self._stepped is None:
            start = start_state(self._tables, self.streams.world)
        else:
            start = self._stepped.state
        self._position.state[0] = start
        self._position.episode_step[0] = 0
        self._position.episode_return[0] = 0.0

    def _go_on_planning(self) -> None:
        if self._stop is Stop.CONVERGED:
            self._stop = Stop.DONE

    @property
    def nbytes(self) -> int:
        """Bytes of estimates, visits, traces and model."""
        return sum(array.nbytes for array in arrays_of((*self._memory, *self.rule)))

    @property
    def planning(self) -> str:
        """Progress of a planner as text, or empty."""
        return str(self._module.describe(self._memory)) if self.plans else ""

    @property
    def phase(self) -> SweepPhase | None:
        """Phase of the current or last sweep. None before the first, and without phases."""
        return self._module.phase_of(self._memory) if self._row.takes_orders else None

    @property
    def ordered(self) -> SweepPhase | None:
        """Phase ordered for the next sweep, or None."""
        return self._module.ordered(self._memory) if self._row.takes_orders else None

    def order(self, phase: SweepPhase) -> None:
        """Make the next sweep one of `phase`, even for a finished planner.

        Raises:
            UserError: The algorithm has no such sweeps.
        """
        if not self._row.takes_orders:
            able = " or ".join(each.id for each in BY_ID.values() if each.takes_orders)
            raise UserError(f"{self._row.name} has no separate evaluation and improvement: choose {able}")
        self._module.order(self._memory, phase)
        self._go_on_planning()

    @property
    def mdp(self) -> TabularMDP | None:
        """The current transition table, with drifted rewards, or None."""
        if not isinstance(self.space, TabularMDP) or not len(self._drift.offset):
            return self.space if isinstance(self.space, TabularMDP) else None
        return replace(self.space, reward=self.space.reward + self._drift.offset[self.space.outcome_pair])

    @property
    def drifted(self) -> Drifted | None:
        """Regret of a bandit with drifting means, else None."""
        return drifted_by(self._drift)

    @property
    def stop_reason(self) -> str:
        """Why the learner stopped for good, as a sentence, or empty."""
        last = self.last_step
        if self._stop is Stop.WORLD_FAILED and self._stepped is not None:
            return self._stepped.failure
        return "" if last is None else breakdown(self._stop, self.algorithm, last, self.space, self.q)

    @property
    def converged(self) -> bool:
        """True if a planner has finished."""
        return self._stop is Stop.CONVERGED

    def remembered(self, *names: str) -> tuple[FloatArray, ...]:
        """Return copies of arrays of the algorithm's memory. Empty if one is missing."""
        if not all(hasattr(self._memory, name) for name in names):
            return ()
        return tuple(getattr(self._memory, name).copy() for name in names)

    def watch(self, watching: Watching | None) -> None:
        """Stop after steps with these events, from current estimates on.

        Learning and checkpoints are not affected.

        Raises:
            ValueError: A state or pair does not exist.
        """
        if watching is None and self._watching is None:
            forget(self._watch)
            return
        self._watching = watching
        random_ties = self.hyperparameters.ties == "random"
        self._watch = new_watch(watching or Watching(), self.space, self._tables, self.q, random_ties)

    @property
    def noticed(self) -> WatchedEvents:
        """Watched events of the last step."""
        return noticed_by(self._watch)
