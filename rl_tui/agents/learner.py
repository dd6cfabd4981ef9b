"""A learner: one declared set of arrays, two random streams, and its position."""

from __future__ import annotations

import importlib
from dataclasses import replace
from typing import Any, Final

import numpy as np

from rl_tui.agents.breakdown import breakdown
from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.compatibility import check_compatible
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.drift import Drifted, drifted_by, new_drift
from rl_tui.agents.kernels.loop import advance, start_state
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS, Loop, fastest, interpreted, use_machine_code
from rl_tui.agents.kernels.parameters import kernel_parameters, schedules_of
from rl_tui.agents.kernels.planning_loop import sweep
from rl_tui.agents.kernels.position import NOT_FORCED
from rl_tui.agents.kernels.stepped_loop import SteppedLoop
from rl_tui.agents.kernels.stop import Stop
from rl_tui.agents.kernels.tables import Tables, tables_of
from rl_tui.agents.kernels.watch import forget, new_watch, noticed_by
from rl_tui.agents.kernels.watching import WatchedEvents, Watching
from rl_tui.agents.last_step import Author
from rl_tui.agents.learner_counters import EPISODES_LOGGED, LearnerCounters
from rl_tui.agents.learner_state import LearnerState, Planned, arrays_of, copies, put_back
from rl_tui.agents.sweep_phases import SweepPhase
from rl_tui.common.errors import UserError
from rl_tui.common.streams import Streams
from rl_tui.worlds.environment import Environment
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

UNLIMITED: Final = 2**60
_FOR_GOOD: Final = (Stop.DIVERGED, Stop.ENDLESS_EPISODE, Stop.MEMORY_FULL, Stop.WORLD_FAILED)


class Learner(LearnerCounters):
    """An algorithm at work in a world.

    ``q`` (float64) and ``visits`` (int64), both [P], are the live arrays: read them between calls of
    :meth:`advance`, never during one. Equal arguments give equal bits, however the work is cut into calls.
    ``environment`` is stepped where ``space`` is no table. Raises UserError where the algorithm or the
    policy cannot work in ``space``.
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
        super().__init__(algorithm)
        self.space = space
        self.streams = streams
        self.q: FloatArray = np.full(space.pairs, hyperparameters.initial_q, dtype=np.float64)
        self.visits: IntArray = np.zeros(space.pairs, dtype=np.int64)
        self._tables = tables_of(space)
        self._drift = new_drift(space)
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
        self._take_rule(hyperparameters)
        self._take_algorithm(algorithm)
        self._begin_anew()
        self._watching: Watching | None = None
        self._watch = new_watch(Watching(), space, self._tables, self.q, random_ties=True)

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

    def _take_rule(self, hyperparameters: Hyperparameters) -> None:
        policy = importlib.import_module(POLICY_BY_ID[hyperparameters.policy].module)
        self.rule = policy.new_rule(self.space, hyperparameters)
        self.hyperparameters = hyperparameters
        self._params = kernel_parameters(hyperparameters)
        self._schedules = schedules_of(hyperparameters)

    def _take_algorithm(self, algorithm: str) -> None:
        self._module = importlib.import_module(BY_ID[algorithm].module)
        self.algorithm = algorithm
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
    def planning(self) -> str:
        """How a planner is getting on, in words; empty before its first step, and for an agent."""
        return str(self._module.describe(self._memory)) if self.plans else ""

    @property
    def phase(self) -> SweepPhase | None:
        """What the sweep under way, or the last one, does to the policy; None before the first.

        It is None too where sweeps are all alike, and for an agent.
        """
        return self._module.phase_of(self._memory) if self._takes_orders else None

    @property
    def ordered(self) -> SweepPhase | None:
        """What is ordered for the next sweep; None where nothing is."""
        return self._module.ordered(self._memory) if self._takes_orders else None

    @property
    def _takes_orders(self) -> bool:
        return BY_ID[self.algorithm].takes_orders

    def order(self, phase: SweepPhase) -> None:
        """Let the next sweep be one of ``phase``, whatever is due by itself, be it that nothing is.

        Raises UserError where the algorithm in force has no such sweeps.
        """
        if not self._takes_orders:
            able = " or ".join(each.id for each in BY_ID.values() if each.takes_orders)
            raise UserError(
                f"{BY_ID[self.algorithm].name} has no sweeps of evaluation and improvement: take {able}"
            )
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

    def take(self, pair: int) -> Stop:
        """Take one step with ``pair`` in place of the agent's choice; it learns from it as from its own.

        The choice draws nothing. Returns what :meth:`advance` returns for one step. Raises UserError for a
        planner, and where ``pair`` is not one of the state in which the step starts.
        """
        if self.plans:
            raise UserError(
                f"{BY_ID[self.algorithm].name} plans and takes no steps: to act yourself, take an algorithm "
                f"that learns, such as q-learning"
            )
        legal = self.space.pairs_of(self.state)
        if pair not in legal:
            names = ", ".join(self.space.action_names[self.space.pair_action[each]] for each in legal)
            there = self.space.state_names[self.state]
            raise UserError(f"that action cannot be taken in state {there}: take one of {names}")
        self._position.forced[0] = pair
        try:
            return self.advance(1)
        finally:
            self._position.forced[0] = NOT_FORCED

    def advance(self, steps: int, episodes: int = UNLIMITED) -> Stop:
        """Take ``steps`` steps or finish ``episodes`` more episodes, whichever comes first.

        Stops early with ``Stop.NOTICED`` after a step that brought something watched, with
        ``Stop.EPISODES_FULL`` when :meth:`drain_episodes` is due (where it is both, the next call tells),
        with ``Stop.CONVERGED`` when a planner is done, and for good on a runaway. For a planner a step is the
        backup of one state, an episode a sweep over all.
        """
        forget(self._watch)
        if self._stop in _FOR_GOOD or self._stop is Stop.CONVERGED:
            return self._stop
        if self._log.finished[0] == EPISODES_LOGGED:
            return Stop.EPISODES_FULL
        before = self.step
        stop = Stop(self._advance(steps, episodes, compiled=self.is_compiled))
        # What is watched must leave no trace in where it stands
        self._stop = Stop.DONE if stop is Stop.NOTICED else stop
        if self.step > before:
            self.author = Author(self.algorithm, self.hyperparameters)
            self.came_to_rest = stop is Stop.CONVERGED
        return stop

    def set_time_budget(self, seconds: float) -> None:
        """Let :meth:`advance` come back once so many are over, where a step may take any time.

        It then has taken fewer steps than it was asked for, but at least one.
        """
        if self._stepped is not None:
            self._stepped.time_budget = seconds

    def _advance(self, steps: int, episodes: int, *, compiled: bool) -> int:
        if self.plans:
            return self._plan(steps, episodes, compiled)
        args = (self._memory, self.rule, self._params, self._schedules, self._tables)
        moved = (self._position, self._log, self._record, self._watch)
        if self._stepped is not None:
            return self._stepped.advance(*args, *moved, self.streams.learner, steps, episodes, compiled)
        take = (fastest if compiled else interpreted)(advance)
        return take(*args, self._drift, *moved, *self.streams, steps, episodes)

    def _plan(self, steps: int, sweeps: int, compiled: bool) -> int:
        before, swept = self.step, self.episodes
        moved = (self._position, self._record, self._watch)
        take = (fastest if compiled else interpreted)(sweep)
        stop = take(self._memory, self._params, self._tables_now(), *moved, steps, sweeps)
        backups, done = self.planned
        self.planned = Planned(backups + self.step - before, done + self.episodes - swept)
        return stop

    def _tables_now(self) -> Tables:
        """Return the tables as planners know them: with rewards where they have drifted to."""
        mdp = self.mdp
        if mdp is None or mdp is self.space:
            return self._tables
        return self._tables._replace(reward=mdp.reward)

    @property
    def loop(self) -> Loop:
        """Which loop it runs: each has machine code of its own."""
        policy = "" if self.plans else self.hyperparameters.policy
        return Loop(self.algorithm, policy, self._stepped is not None)

    @property
    def is_compiled(self) -> bool:
        """Whether it runs as machine code; else it is interpreted, with the same bits but far more slowly."""
        return self.loop in COMPILED_LOOPS

    def compile(self) -> None:
        """Compile the loop, or read it from the cache, without taking a step.

        It holds for all learners of this process that run the same loop.
        """
        use_machine_code(sweep if self.plans else advance)
        self._advance(0, UNLIMITED, compiled=True)
        COMPILED_LOOPS.add(self.loop)

    def checkpoint(self) -> LearnerState:
        """Return all there is to come back to; episodes must have been drained.

        Raises UserError where the learner is not ``rewindable``.
        """
        if not self.rewindable:
            raise UserError(
                "an environment that is stepped for real cannot go back: start again and take the same steps"
            )
        return LearnerState(
            self.algorithm,
            self.hyperparameters,
            copies(self._checkpoint_arrays()),
            copies(arrays_of(self.rule)),
            copies(self._drift),
            copies(self._position),
            copies(self._record),
            tuple(generator.bit_generator.state for generator in self.streams),
            self.planned,
            self.author,
            self.came_to_rest,
            self._stop,
        )

    def _checkpoint_arrays(self) -> tuple[Any, ...]:
        """Return the memory, of its arrays only the beginning where the algorithm reads no further."""
        if hasattr(self._module, "checkpoint_arrays"):
            return tuple(self._module.checkpoint_arrays(self._memory))
        return tuple(self._memory)

    def restore(self, state: LearnerState) -> None:
        """Go back to ``state``, bit for bit."""
        if state.hyperparameters != self.hyperparameters:
            self._take_rule(state.hyperparameters)
        if state.algorithm != self.algorithm:
            self._take_algorithm(state.algorithm)
        put_back(self._memory, state.memory)
        put_back(arrays_of(self.rule), state.rule)
        put_back(self._drift, state.drift)
        put_back(self._position, state.position)
        put_back(self._record, state.record)
        for generator, bits in zip(self.streams, state.streams, strict=True):
            generator.bit_generator.state = bits
        self._log.finished[0] = 0
        self.planned = state.planned
        self.author = state.author
        self.came_to_rest = state.came_to_rest
        self._stop = state.stop
        self.watch(self._watching)
