"""A learner: one declared set of arrays, two random streams, and where it stands."""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.last_step import LastStep
from rl_tui.agents.loop import Stop, advance, start_state
from rl_tui.agents.position import new_episode_log, new_position, new_record, read_record
from rl_tui.agents.settings import action_rule_of, settings_of
from rl_tui.agents.tables import tables_of
from rl_tui.worlds.mdp import FloatArray, IntArray, TabularMDP
from rl_tui.worlds.streams import Streams

UNLIMITED: Final = 2**60
EPISODES_LOGGED: Final = 8192


class Episodes(NamedTuple):
    """Finished episodes, oldest first, [n] each: undiscounted return, length in steps, pair taken last."""

    returns: FloatArray
    lengths: IntArray
    last_pairs: IntArray


@dataclass(frozen=True, slots=True, eq=False)
class LearnerState:
    """All that a learner is at one step, to come back to."""

    algorithm: str
    hyperparameters: Hyperparameters
    memory: tuple[Any, ...]
    position: tuple[Any, ...]
    last: tuple[Any, ...]
    streams: tuple[Any, ...]
    stop: Stop


class Learner:
    """An algorithm at work on a table.

    ``q`` (float64) and ``visits`` (int64), both [P], are the live arrays: read them between calls of
    :meth:`advance`, never during one. Equal arguments give equal bits, however the work is cut into calls.
    """

    def __init__(
        self, mdp: TabularMDP, algorithm: str, hyperparameters: Hyperparameters, streams: Streams
    ) -> None:
        self.mdp = mdp
        self.streams = streams
        self.q: FloatArray = np.full(mdp.pairs, hyperparameters.initial_q, dtype=np.float64)
        self.visits: IntArray = np.zeros(mdp.pairs, dtype=np.int64)
        self._tables = tables_of(mdp)
        self._position = new_position(start_state(self._tables, streams.world))
        self._log = new_episode_log(EPISODES_LOGGED)
        self._last = new_record()
        self._stop = Stop.DONE
        self.configure(hyperparameters)
        self.switch(algorithm)

    def configure(self, hyperparameters: Hyperparameters) -> None:
        """Take these hyper-parameters from the next step on; ``initial_q`` only counts in the constructor."""
        self.hyperparameters = hyperparameters
        self._rule = action_rule_of(hyperparameters)
        self._settings = settings_of(hyperparameters)

    def switch(self, algorithm: str) -> None:
        """Let another algorithm go on with the same estimates and visits; the rest of its memory is new.

        Raises KeyError if there is no algorithm of that id.
        """
        module = importlib.import_module(BY_ID[algorithm].module)
        self.algorithm = algorithm
        self._memory = module.new_memory(self.q, self.visits, self._tables)

    @property
    def step(self) -> int:
        """Steps taken."""
        return int(self._position.step[0])

    @property
    def episodes(self) -> int:
        """Finished episodes."""
        return int(self._position.episodes[0])

    @property
    def state(self) -> int:
        """The state in which the next step starts."""
        return int(self._position.state[0])

    @property
    def episode_step(self) -> int:
        """Steps taken in the episode under way."""
        return int(self._position.episode_step[0])

    @property
    def episode_return(self) -> float:
        """Undiscounted return so far in the episode under way."""
        return float(self._position.episode_return[0])

    @property
    def first_reward_episode(self) -> int:
        """The first episode (from 1) with a non-zero reward, 0 while there is none."""
        return int(self._position.first_reward_episode[0])

    @property
    def last_step(self) -> LastStep | None:
        """The last step with all its numbers, None before the first."""
        return read_record(self._last)

    @property
    def stop_reason(self) -> str:
        """Why the learner will not go on, as a sentence; empty while it will."""
        last = self.last_step
        if self._stop == Stop.DIVERGED and last is not None:
            pair = self._pair_name(last.updated_pair)
            return f"Q({pair}) left ±1e12 at step {last.step:,}: take a smaller step size or start again"
        if self._stop == Stop.ENDLESS_EPISODE and last is not None:
            return f"episode {last.episode:,} has not ended after 10,000,000 steps, at step {last.step:,}"
        return ""

    def advance(self, steps: int, episodes: int = UNLIMITED) -> Stop:
        """Take ``steps`` steps or finish ``episodes`` more episodes, whichever comes first.

        Stops early with ``Stop.EPISODES_FULL`` when :meth:`drain_episodes` is due, and for good on a runaway.
        """
        if self._stop in (Stop.DIVERGED, Stop.ENDLESS_EPISODE):
            return self._stop
        if self._log.finished[0] == EPISODES_LOGGED:
            return Stop.EPISODES_FULL
        self._stop = Stop(
            advance(
                self._memory,
                self._rule,
                self._settings,
                self._tables,
                self._position,
                self._log,
                self._last,
                self.streams.world,
                self.streams.learner,
                steps,
                episodes,
            )
        )
        return self._stop

    def warm_up(self) -> None:
        """Compile the loop, or read it from the cache, without taking a step."""
        self.advance(0)

    def drain_episodes(self) -> Episodes:
        """Return copies of the episodes finished since the last call, and forget them."""
        count = int(self._log.finished[0])
        self._log.finished[0] = 0
        return Episodes(
            self._log.returns[:count].copy(),
            self._log.lengths[:count].copy(),
            self._log.last_pairs[:count].copy(),
        )

    def checkpoint(self) -> LearnerState:
        """Return all there is to come back to; episodes must have been drained."""
        return LearnerState(
            self.algorithm,
            self.hyperparameters,
            tuple(array.copy() for array in self._memory),
            tuple(array.copy() for array in self._position),
            tuple(array.copy() for array in self._last),
            tuple(generator.bit_generator.state for generator in self.streams),
            self._stop,
        )

    def restore(self, state: LearnerState) -> None:
        """Go back to ``state``, bit for bit."""
        self.configure(state.hyperparameters)
        self.switch(state.algorithm)
        for arrays, kept in (
            (self._memory, state.memory),
            (self._position, state.position),
            (self._last, state.last),
        ):
            for array, copy in zip(arrays, kept, strict=True):
                array[...] = copy
        for generator, bits in zip(self.streams, state.streams, strict=True):
            generator.bit_generator.state = bits
        self._log.finished[0] = 0
        self._stop = state.stop

    def _pair_name(self, pair: int) -> str:
        state = self.mdp.state_names[int(self.mdp.pair_state[pair])]
        return f"{state}, {self.mdp.action_names[int(self.mdp.pair_action[pair])]}"
