"""A watched program in the form of a built-in agent."""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import suppress
from functools import cached_property
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from rl_tui.agents.catalogue import OWN_PROGRAM
from rl_tui.agents.kernels.watch import NOTHING_NOTICED
from rl_tui.agents.last_step import NOTHING, Author, LastStep
from rl_tui.agents.learner_counters import Counters
from rl_tui.common.errors import UserError
from rl_tui.programs.diagnosis.step_story import StepUpdate, update_of_step
from rl_tui.programs.evidence.code_names import DISCOUNTS, declared
from rl_tui.programs.evidence.verdict import MovedCell, Rule, UpdateFound
from rl_tui.programs.watched.program_history import ProgramState, steps_between
from rl_tui.runs.recipe import changed_parameter
from rl_tui.runs.timeline.trail import MOST_STEPS, Trail, TrailStep
from rl_tui.worlds.mdp.tabular_mdp import UNKNOWN_ACTION

if TYPE_CHECKING:
    from rl_tui.agents.hyperparameters import Hyperparameters
    from rl_tui.programs.watched.recording import StepColumns
    from rl_tui.worlds.mdp.space import FloatArray, IntArray

# What is known about its learning


_BUILT_IN: Final[Mapping[Rule, str]] = {
    Rule.Q_LEARNING: "q-learning",
    Rule.SARSA: "sarsa",
    Rule.EXPECTED_SARSA: "expected-sarsa",
}


class Found(NamedTuple):
    """The known algorithm and settings of a program."""

    algorithm: str
    hyperparameters: Hyperparameters
    gamma_source: str


def found_of(update: UpdateFound, numbers: Mapping[str, float], usual: Hyperparameters) -> Found:
    """Combine update, `numbers` in the code and `usual` defaults, in this order."""
    written = declared(numbers, DISCOUNTS)
    gamma, source = update.gamma, "found"
    if written is not None and not gamma:  # with γ = 0 the target has no next state
        gamma, source = written[1], "declared"
    elif gamma is None:
        gamma, source = usual.gamma, "usual"
    values = usual
    for name, value in (("gamma", gamma), ("alpha", update.alpha), ("epsilon", update.epsilon)):
        if value is not None and math.isfinite(value):
            with suppress(UserError):  # the program's value may be outside our ranges
                values = changed_parameter(values, name, value)
    is_plain = update.place is MovedCell.TAKEN and update.alpha is not None
    algorithm = _BUILT_IN.get(update.rule, OWN_PROGRAM.id) if is_plain else OWN_PROGRAM.id
    return Found(algorithm, values, source)


# Its agent


_MOST_REWARDS: Final = 256
_NO_CHANGE: Final = (NOTHING, 0.0, 0.0)


class ProgramLearner:
    """The program's agent at one moment: a `PlayedAgent`."""

    converged = False
    drifted = None
    phase = None
    planning = ""

    def __init__(self, progress: ProgramState, update: UpdateFound, found: Found) -> None:
        self.algorithm, self.hyperparameters = found.algorithm, found.hyperparameters
        self.visits, self.episodes = progress.visits, progress.episodes
        self.begins_episode = progress.ended_at == progress.step
        self.noticed = NOTHING_NOTICED
        self.mdp = progress.world.world.mdp
        self._progress, self._world, self._update = progress, progress.world, update

    @property
    def q(self) -> FloatArray:
        """Estimates, `[P]`, or 0."""
        return self._progress.q

    @property
    def author(self) -> Author | None:
        """The program itself after an unexplained step."""
        return None if self.update.explained else Author(OWN_PROGRAM.id, self.hyperparameters)

    def remembered(self, *_: str) -> tuple[FloatArray, ...]:
        """Return nothing: no other memory is known."""
        return ()

    def set_time_budget(self, _: float) -> None:
        """Do nothing: a program is only waited for."""

    # Its episode

    @cached_property
    def _steps(self) -> StepColumns | None:
        here, recording = self._progress.step, self._progress.recording
        last = steps_between(recording, here - 1, here)
        if not len(last.state):
            return None
        length = int(last.episode_step[0]) + 1
        steps = steps_between(recording, here - length, here)
        same = steps.episode == last.episode[0]
        if not same.all():  # steps of two environments alternate
            steps = steps_between(recording, here - 4 * length, here)
            same = steps.episode == last.episode[0]
        return type(steps)._make(column[same] for column in steps)

    @cached_property
    def counters(self) -> Counters:
        """Steps, episodes, state, last step."""
        progress, steps = self._progress, self._steps
        start = 0 if self.mdp is None else int(self.mdp.start_state[0])
        if steps is None:
            return Counters(state=start, step_from=start, step=progress.step, episodes=progress.episodes)
        terminated, reward = bool(steps.terminated[-1]), float(steps.reward[-1])
        state = self._world.landing(int(steps.next_state[-1]), reward, terminated=terminated)
        ended = terminated or bool(steps.truncated[-1])
        rewards, (errors, pairs) = steps.reward, self._td_errors()
        return Counters(
            state=state,
            step_from=start if ended else state,
            step=progress.step,
            episodes=progress.episodes,
            episode_step=0 if ended else int(steps.episode_step[-1]) + 1,
            episode_return=0.0 if ended else float(sum(rewards.tolist())),
            rewards=rewards[-_MOST_REWARDS:].copy(),
            discounted_return=float(sum(rewards * self.hyperparameters.gamma ** np.arange(len(rewards)))),
            td_errors=errors,
            updated_pairs=pairs,
            last_step=self._last_step(steps, state, ended=ended),
        )

    @property
    def trail(self) -> Trail:
        """Last steps of the episode."""
        if self._steps is None:
            return ()
        steps = type(self._steps)._make(column[-MOST_STEPS:] for column in self._steps)
        first = self._progress.step - len(steps.state) + 1
        return tuple(
            TrailStep(
                first + place,
                self._world.state(int(steps.state[place]), int(steps.episode_step[place])),
                int(steps.action[place]),
                UNKNOWN_ACTION,
                self._world.landing(
                    int(steps.next_state[place]),
                    float(steps.reward[place]),
                    terminated=bool(steps.terminated[place]),
                ),
            )
            for place in range(len(steps.state))
        )

    def _last_step(self, steps: StepColumns, next_state: int, *, ended: bool) -> LastStep | None:
        progress, update, explained = self._progress, self.update, self.update.explained
        observation, action = int(steps.state[-1]), int(steps.action[-1])
        count, reward = int(steps.episode_step[-1]), float(steps.reward[-1])
        pair = self._world.pair(observation, action, count)
        if pair == NOTHING:
            return None  # screens take a step without a pair for a planner's
        own_cell = observation * progress.recording.actions + action
        if explained or not update.moved:
            cell, before, after = (update.cell, update.before, update.after) if explained else _NO_CHANGE
        else:
            own = (each for each in update.moved if each.cell == own_cell)
            cell, before, after = next(own, update.moved[0])
        # several pairs may share a cell; the taken one counts
        moved = pair if cell == own_cell else NOTHING if cell == NOTHING else self._world.pair_of_cell[cell]
        others = 0 if explained or moved == NOTHING else len({each.cell for each in update.moved}) - 1
        return LastStep(
            step=progress.step,
            episode=progress.episodes + (not ended),
            state=self._world.state(observation, count),
            pair=pair,
            explored=False,
            epsilon=0.0,
            outcome=self._outcome(pair, next_state, reward),
            reward=reward,
            next_state=next_state,
            terminated=bool(steps.terminated[-1]),
            truncated=bool(steps.truncated[-1]),
            updated_pair=int(moved),
            others=others,
            table=0,
            before=before,
            step_size=1.0 if update.step_size is None else update.step_size,
            gamma=self.hyperparameters.gamma,
            gathered=after if update.gathered is None else update.gathered,
            discount=update.discount or 0.0,
            bootstrap=update.bootstrap or 0.0,
            after=after,
            episode_step=count + 1,
            bootstrap_state=NOTHING if update.bootstrap_state == NOTHING else next_state,
        )

    @cached_property
    def update(self) -> StepUpdate:
        """Effect of the last step."""
        progress, step = self._progress, self._progress.step - 1
        if self._steps is None or progress.table is None or progress.step <= progress.recording.found_at:
            return StepUpdate(step, ())
        changes = progress.recording.changes
        begin, end = np.searchsorted(changes.step, (step, step + 1))
        table = progress.table.copy()
        table[changes.cell[begin:end][::-1]] = changes.before[begin:end][::-1]
        return update_of_step(progress.recording, self._update, step, table)

    def _td_errors(self) -> tuple[FloatArray, IntArray]:
        if not self._update.alpha:
            return np.empty(0), np.empty(0, np.int64)
        changes = self._progress.recording.changes
        end = int(np.searchsorted(changes.step, self._progress.step))
        last = slice(max(0, end - _MOST_REWARDS), end)
        pairs = self._world.pair_of_cell[changes.cell[last]]
        errors = (changes.after[last] - np.nan_to_num(changes.before[last])) / self._update.alpha
        if self._progress.recording.initial_pair is not None:
            errors *= 2.0  # the mean of two tables moves half as far as one of them
        return errors[pairs >= 0], pairs[pairs >= 0]

    def _outcome(self, pair: int, next_state: int, reward: float) -> int:
        if self.mdp is None:
            return UNKNOWN_ACTION
        first, last = int(self.mdp.first_outcome[pair]), int(self.mdp.first_outcome[pair + 1])
        fits = (self.mdp.next_state[first:last] == next_state) & (self.mdp.reward[first:last] == reward)
        return first + int(np.argmax(fits)) if np.count_nonzero(fits) == 1 else UNKNOWN_ACTION
