"""An algorithm at work in a world, with all its state."""

from __future__ import annotations

from typing import Any, Final

from rl_tui.agents.kernels.loop import advance
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS, Loop, fastest, interpreted, use_machine_code
from rl_tui.agents.kernels.planning_loop import sweep
from rl_tui.agents.kernels.position import NOT_FORCED, Stop
from rl_tui.agents.kernels.tables import Tables
from rl_tui.agents.kernels.watch import forget
from rl_tui.agents.last_step import Author
from rl_tui.agents.learner_counters import EPISODES_LOGGED
from rl_tui.agents.learner_memory import LearnerMemory, LearnerState, Planned, arrays_of, copies, put_back
from rl_tui.agents.world_change import is_same_table
from rl_tui.common.errors import UserError

UNLIMITED: Final = 2**60
_FOR_GOOD: Final = (Stop.DIVERGED, Stop.ENDLESS_EPISODE, Stop.MEMORY_FULL, Stop.WORLD_FAILED)


class Learner(LearnerMemory):
    """An algorithm at work in a world, with the attributes of :class:`LearnerMemory`.

    Equal arguments give equal bits, however the work is split into calls.
    """

    def take(self, pair: int) -> Stop:
        """Take one step with `pair`, without drawing a number for the choice.

        Raises:
            UserError: The learner is a planner, or `pair` does not belong to the current state.
        """
        if self.plans:
            raise UserError(
                f"{self._row.name} is a planner and takes no steps: to act yourself, choose an "
                f"algorithm that learns, such as q-learning"
            )
        legal = self.space.pairs_of(self.state)
        if pair not in legal:
            names = ", ".join(self.space.action_names[self.space.pair_action[each]] for each in legal)
            there = self.space.state_names[self.state]
            raise UserError(f"this action is not available in state {there}: choose one of {names}")
        self._position.forced[0] = pair
        try:
            return self.advance(1)
        finally:
            self._position.forced[0] = NOT_FORCED

    def advance(self, steps: int, episodes: int = UNLIMITED) -> Stop:
        """Take up to `steps` steps or `episodes` episodes, whichever comes first.

        For a planner, a step backs up one state and an episode is a sweep over all states.

        Returns:
            ``Stop.NOTICED`` for a watched event. ``Stop.EPISODES_FULL``: call :meth:`drain_episodes`. If both
            apply, the next call reports this. ``Stop.CONVERGED``: a planner has finished. Others are final.
        """
        forget(self._watch)
        if self._stop in _FOR_GOOD or self._stop is Stop.CONVERGED:
            return self._stop
        if self._log.finished[0] == EPISODES_LOGGED:
            return Stop.EPISODES_FULL
        before = self.step
        stop = Stop(self._advance(steps, episodes, compiled=self.is_compiled))
        # Watching must not change the state of the learner
        self._stop = Stop.DONE if stop is Stop.NOTICED else stop
        if self.step > before:
            self.author = Author(self.algorithm, self.hyperparameters)
            self.came_to_rest = stop is Stop.CONVERGED
        return stop

    def set_time_budget(self, seconds: float) -> None:
        """Let :meth:`advance` return after `seconds` and at least one step, if steps may be slow."""
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
        mdp = self.mdp
        if mdp is None or mdp is self.space:
            return self._tables
        return self._tables._replace(reward=mdp.reward)

    @property
    def loop(self) -> Loop:
        """Key of the loop that runs, which has its own machine code."""
        policy = "" if self.plans else self.hyperparameters.policy
        return Loop(self.algorithm, policy, self._stepped is not None)

    @property
    def is_compiled(self) -> bool:
        """True for machine code. Interpreted it has the same bits."""
        return self.loop in COMPILED_LOOPS

    def compile(self) -> None:
        """Compile the loop, or read it from the cache, for the whole process."""
        use_machine_code(sweep if self.plans else advance)
        self._advance(0, UNLIMITED, compiled=True)
        COMPILED_LOOPS.add(self.loop)

    def checkpoint(self) -> LearnerState:
        """Return a copy of the state, after draining episodes.

        Raises:
            UserError: The learner is not ``rewindable``.
        """
        if not self.rewindable:
            raise UserError("a simulated environment cannot go back: start again and take the same steps")
        return LearnerState(
            self.space,
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
            self.world_since,
            self._stop,
        )

    def _checkpoint_arrays(self) -> tuple[Any, ...]:
        if hasattr(self._module, "checkpoint_arrays"):
            return tuple(self._module.checkpoint_arrays(self._memory))
        return tuple(self._memory)

    def restore(self, state: LearnerState) -> None:
        """Return to `state`, bit for bit, or raise ValueError in another world."""
        if not is_same_table(state.space, self.space):
            raise ValueError("this checkpoint belongs to another world: enter that world first")
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
        self.world_since = state.world_since
        self._stop = state.stop
        self.watch(self._watching)
