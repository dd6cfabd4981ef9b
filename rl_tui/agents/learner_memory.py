"""The memory of a learner: what it holds, how to change, copy and restore it, and why it stops for good."""

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
    """Return why ``algorithm`` stopped for good after the step ``last``, as a sentence; empty if it did not.

    ``q``, [P], are its estimates.
    """
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
    """How many of the steps and of the episodes so far were a planner's: backups and sweeps."""

    steps: int
    sweeps: int


@dataclass(frozen=True, slots=True, eq=False)
class LearnerState:
    """All that a learner is at one step; the arrays are copies, but for those of the world, ``space``.

    Of an array of the memory only the beginning may be there: see :func:`put_back`.
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
        """How much memory the copies take."""
        parts = (self.memory, self.rule, self.drift, self.position, self.record)
        return sum(array.nbytes for part in parts for array in part)


def arrays_of(parts: Iterable[Any]) -> Arrays:
    """Return those of ``parts`` that are arrays: what a policy has learned."""
    return tuple(part for part in parts if isinstance(part, np.ndarray))


def copies(arrays: Iterable[Any]) -> Arrays:
    """Return copies of ``arrays``."""
    return tuple(array.copy() for array in arrays)


def put_back(arrays: Iterable[Any], kept: Arrays) -> None:
    """Write the ``kept`` beginning back into each of ``arrays``, [n]; the rest of it is not in use."""
    for array, copy in zip(arrays, kept, strict=True):
        array[: len(copy)] = copy


# The live memory


class LearnerMemory(LearnerCounters):
    """All that a learner has: a world, an algorithm, settings, estimates, and what it watches for.

    ``q`` (float64) and ``visits`` (int64), both [P], are the live arrays: read them between calls that move
    it, never during one. ``environment`` is stepped where ``space`` is no table. Raises UserError where the
    algorithm or the policy cannot work in ``space``.
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
        """Whether it can go back to a checkpoint: an environment that is stepped cannot."""
        self.planned = Planned(0, 0)
        """What part of the work was a planner's, and so not in the world."""
        self.author = Author(algorithm, hyperparameters)
        """Who took the last step; before the first, who will."""
        self.came_to_rest = False
        """Whether the last step was a planner's last: it had converged, whatever has been changed since."""
        self.rule: Any
        """The policy in force, with what it has learned in live arrays, as those of ``q`` are."""
        self._memory: Any
        self._stop = Stop.DONE
        self._watching: Watching | None = None
        self._take_space(space, hyperparameters)
        self._take_algorithm(algorithm)
        self._begin_anew()

    def configure(self, hyperparameters: Hyperparameters) -> None:
        """Take these hyper-parameters from the next step on; ``initial_q`` only counts in the constructor.

        What a policy has learned is kept while the policy stays the same. Raises UserError where they cannot
        work here.
        """
        check_compatible(self.space, self.algorithm, hyperparameters)
        other_ties = hyperparameters.ties != self.hyperparameters.ties
        learned = arrays_of(self.rule) if hyperparameters.policy == self.hyperparameters.policy else None
        self._take_rule(hyperparameters)
        if learned is not None:
            put_back(arrays_of(self.rule), learned)
        if other_ties:
            noticed = self._watch.noticed.copy()
            self.watch(self._watching)  # the new tie rule says what was greedy before
            self._watch.noticed[:] = noticed
        self._go_on_planning()

    def switch(self, algorithm: str) -> None:
        """Let another algorithm go on with the same estimates and visits; the rest of its memory is new.

        It goes on with the episode under way as well; but from an agent to a planner or back the one under
        way is given up, unfinished, and another episode or sweep begins.

        Raises ValueError if there is no algorithm of that id, UserError where it cannot work here.
        """
        check_compatible(self.space, algorithm, self.hyperparameters)
        planned = self.plans
        self._take_algorithm(algorithm)
        if planned or self.plans:
            self._begin_anew()
        self._go_on_planning()

    def enter(self, space: FiniteSpace) -> None:
        """Go to another world, in which nothing is known yet, for :meth:`restore` to come back to it."""
        self._watching = None
        self._take_space(space, self.hyperparameters)
        self._take_algorithm(self.algorithm)

    def change_world(self, space: FiniteSpace, carried: Carried) -> bool:
        """Go on in another world, with all that was learned of what is in both, as ``carried`` says.

        A pair that is new begins at ``initial_q``, without visits. The rest of the memory is new, as where
        the algorithm is switched. An episode is given up, unfinished, where the state of the agent is gone or
        has become an end, or the time limit is over; another then begins, and so it does where none had begun
        and the agent stood at what is no start any more. A planner begins a sweep. Returns whether an episode
        was given up.

        Raises UserError where the agent cannot work in ``space``; nothing then has changed.
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
        """Stand where an episode or a sweep begins; one under way is given up."""
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
        """Let a planner that was done look again: what was changed may have given it something to do."""
        if self._stop is Stop.CONVERGED:
            self._stop = Stop.DONE

    @property
    def nbytes(self) -> int:
        """How many bytes all that it remembers takes: estimates, visits, traces, a model."""
        return sum(array.nbytes for array in arrays_of((*self._memory, *self.rule)))

    @property
    def planning(self) -> str:
        """How a planner is getting on, in words; empty before its first step, and for an agent."""
        return str(self._module.describe(self._memory)) if self.plans else ""

    @property
    def phase(self) -> SweepPhase | None:
        """What the sweep under way, or the last one, does to the policy; None before the first.

        It is None too where sweeps are all alike, and for an agent.
        """
        return self._module.phase_of(self._memory) if self._row.takes_orders else None

    @property
    def ordered(self) -> SweepPhase | None:
        """What is ordered for the next sweep; None where nothing is."""
        return self._module.ordered(self._memory) if self._row.takes_orders else None

    def order(self, phase: SweepPhase) -> None:
        """Let the next sweep be one of ``phase``, whatever is due by itself, be it that nothing is.

        Raises UserError where the algorithm in force has no such sweeps.
        """
        if not self._row.takes_orders:
            able = " or ".join(each.id for each in BY_ID.values() if each.takes_orders)
            raise UserError(f"{self._row.name} has no sweeps of evaluation and improvement: take {able}")
        self._module.order(self._memory, phase)
        self._go_on_planning()

    @property
    def mdp(self) -> TabularMDP | None:
        """The transition table as it is now, with rewards where they have drifted to; None without one."""
        if not isinstance(self.space, TabularMDP) or not len(self._drift.offset):
            return self.space if isinstance(self.space, TabularMDP) else None
        return replace(self.space, reward=self.space.reward + self._drift.offset[self.space.outcome_pair])

    @property
    def drifted(self) -> Drifted | None:
        """How the pulls of a bandit were spent whose means drift; None elsewhere."""
        return drifted_by(self._drift)

    @property
    def stop_reason(self) -> str:
        """Why the learner will not go on, as a sentence; empty while it will."""
        last = self.last_step
        if self._stop is Stop.WORLD_FAILED and self._stepped is not None:
            return self._stepped.failure
        return "" if last is None else breakdown(self._stop, self.algorithm, last, self.space, self.q)

    @property
    def converged(self) -> bool:
        """Whether a planner is done: no estimate moves any more."""
        return self._stop is Stop.CONVERGED

    def remembered(self, *names: str) -> tuple[FloatArray, ...]:
        """Return copies of these arrays of the algorithm's own memory; none where it keeps none so named."""
        if not all(hasattr(self._memory, name) for name in names):
            return ()
        return tuple(getattr(self._memory, name).copy() for name in names)

    def watch(self, watching: Watching | None) -> None:
        """Stop after a step that brings any of ``watching``, from the estimates as they are; None: no more.

        It changes nothing in what is learned, and is no part of a checkpoint. Raises ValueError where a state
        or a pair is unknown.
        """
        if watching is None and self._watching is None:
            forget(self._watch)
            return
        self._watching = watching
        random_ties = self.hyperparameters.ties == "random"
        self._watch = new_watch(watching or Watching(), self.space, self._tables, self.q, random_ties)

    @property
    def noticed(self) -> WatchedEvents:
        """What the last step of the last :meth:`advance` or :meth:`take` brought of what is watched."""
        return noticed_by(self._watch)
