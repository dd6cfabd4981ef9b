"""The last step of a watched program, in the form of a built-in agent's last step."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from rl_tui.agents.last_step import NOTHING, LastStep
from rl_tui.agents.learner_counters import Counters
from rl_tui.programs.diagnosis.step_story import StepUpdate, update_of_step
from rl_tui.programs.evidence.verdict import UpdateFound
from rl_tui.programs.watched.program_history import ProgramState, steps_between
from rl_tui.runs.timeline.trail import MOST_STEPS, Trail, TrailStep
from rl_tui.worlds.mdp.tabular_mdp import UNKNOWN_ACTION

if TYPE_CHECKING:
    from rl_tui.programs.watched.recording import StepColumns
    from rl_tui.worlds.mdp.space import FloatArray, IntArray

_MOST_REWARDS: Final = 256
_NO_CHANGE: Final = (NOTHING, 0.0, 0.0)


class ProgramSteps:
    """The last step before `progress`, with its episode.

    Args:
        progress: Moment of the program.
        update: What is known about the update rule.
        gamma: Discount for the rewards of the episode.
    """

    def __init__(self, progress: ProgramState, update: UpdateFound, gamma: float) -> None:
        self._progress = progress
        self._update = update
        self._gamma = gamma
        self._world = progress.world
        here = progress.step
        self._last = steps_between(progress.recording, here - 1, here) if here else None
        if self._last is not None and not len(self._last.state):
            self._last = None
        self._episode = None if self._last is None else self._steps_of_episode(self._last)

    @property
    def counters(self) -> Counters:
        """Steps, episodes and last step of the program."""
        progress, steps = self._progress, self._episode
        if steps is None or self._last is None:
            start = self._start()
            return Counters(state=start, step_from=start, step=progress.step, episodes=progress.episodes)
        place = len(steps.state) - 1
        state = self._landing(steps, place)
        ended = bool(steps.terminated[place] or steps.truncated[place])
        length = int(steps.episode_step[place]) + 1
        rewards, (errors, pairs) = steps.reward, self._td_errors()
        return Counters(
            state=state,
            step_from=self._start() if ended else state,
            step=progress.step,
            episodes=progress.episodes,
            episode_step=0 if ended else length,
            episode_return=0.0 if ended else float(sum(rewards.tolist())),
            rewards=rewards[-_MOST_REWARDS:].copy(),
            discounted_return=float(sum(rewards * self._gamma ** np.arange(len(rewards)))),
            td_errors=errors,
            updated_pairs=pairs,
            last_step=self._last_step(steps, place, ended=ended),
        )

    @property
    def trail(self) -> Trail:
        """Last steps of the episode, oldest first."""
        steps = self._episode
        if steps is None:
            return ()
        count, found = len(steps.state), []
        for place in range(max(0, count - MOST_STEPS), count):
            action = int(steps.action[place])
            number = self._progress.step - (count - 1 - place)
            found.append(
                TrailStep(
                    number,
                    self._world.state(int(steps.state[place]), int(steps.episode_step[place])),
                    action,
                    UNKNOWN_ACTION,
                    self._landing(steps, place),
                )
            )
        return tuple(found)

    def _steps_of_episode(self, last: StepColumns) -> StepColumns:
        """Return the recorded steps of the last step's episode, including that step."""
        here, length = self._progress.step, int(last.episode_step[0]) + 1
        steps = steps_between(self._progress.recording, here - length, here)
        same = steps.episode == last.episode[0]
        if not same.all():  # steps of two environments alternate
            first = max(self._progress.recording.first, 0)
            steps = steps_between(self._progress.recording, max(first, here - 4 * length), here)
            same = steps.episode == last.episode[0]
        return type(steps)._make(column[same] for column in steps)

    def _landing(self, steps: StepColumns, place: int) -> int:
        return self._world.landing(
            int(steps.next_state[place]),
            float(steps.reward[place]),
            terminated=bool(steps.terminated[place]),
        )

    def _start(self) -> int:
        mdp = self._world.world.mdp
        return 0 if mdp is None else int(mdp.start_state[0])

    def _last_step(self, steps: StepColumns, place: int, *, ended: bool) -> LastStep | None:
        observation, action = int(steps.state[place]), int(steps.action[place])
        count = int(steps.episode_step[place])
        pair = self._world.pair(observation, action, count)
        if pair == NOTHING:
            return None  # screens take a step without a pair for a planner's
        own_cell = observation * self._progress.recording.actions + action
        next_state, update, explained = self._landing(steps, place), self.update, self.is_explained
        if explained or not update.moved:
            cell, before, after = (update.cell, update.before, update.after) if explained else _NO_CHANGE
        else:
            own = (each for each in update.moved if each.cell == own_cell)
            cell, before, after = next(own, update.moved[0])
        moved = self._pair_of(cell, own_cell, pair)
        others = 0 if explained or moved == NOTHING else len({each.cell for each in update.moved}) - 1
        return LastStep(
            step=self._progress.step,
            episode=self._progress.episodes + (not ended),
            state=self._world.state(observation, count),
            pair=pair,
            explored=False,
            epsilon=0.0,
            outcome=self._outcome(pair, next_state, float(steps.reward[place])),
            reward=float(steps.reward[place]),
            next_state=next_state,
            terminated=bool(steps.terminated[place]),
            truncated=bool(steps.truncated[place]),
            updated_pair=moved,
            others=others,
            table=0,
            before=before,
            step_size=1.0 if update.step_size is None else update.step_size,
            gamma=self._gamma,
            gathered=after if update.gathered is None else update.gathered,
            discount=update.discount or 0.0,
            bootstrap=update.bootstrap or 0.0,
            after=after,
            episode_step=count + 1,
            bootstrap_state=NOTHING if update.bootstrap_state == NOTHING else next_state,
        )

    @property
    def is_explained(self) -> bool:
        """True if the update rule found explains the last step. Else its target is the new estimate."""
        return self.update.explained

    @cached_property
    def update(self) -> StepUpdate:
        """The effect of the last step on the table, part by part as far as known."""
        progress, step = self._progress, self._progress.step - 1
        if self._last is None or progress.table is None or progress.step <= progress.recording.found_at:
            return StepUpdate(step, ())
        changes = progress.recording.changes
        begin, end = np.searchsorted(changes.step, (step, step + 1))
        table = progress.table.copy()
        table[changes.cell[begin:end][::-1]] = changes.before[begin:end][::-1]
        return update_of_step(progress.recording, self._update, step, table)

    def _pair_of(self, cell: int, own_cell: int, own_pair: int) -> int:
        """Return our pair for `cell`. If several pairs share it, the pair that was taken."""
        if cell in (NOTHING, own_cell):
            return own_pair if cell == own_cell else NOTHING
        return int(self._world.pair_of_cell[cell])

    def _td_errors(self) -> tuple[FloatArray, IntArray]:
        update, changes = self._update, self._progress.recording.changes
        if not update.alpha:
            return np.empty(0), np.empty(0, np.int64)
        end = int(np.searchsorted(changes.step, self._progress.step))
        last = slice(max(0, end - _MOST_REWARDS), end)
        pairs = self._world.pair_of_cell[changes.cell[last]]
        errors = (changes.after[last] - np.nan_to_num(changes.before[last])) / update.alpha
        return errors[pairs >= 0], pairs[pairs >= 0]

    def _outcome(self, pair: int, next_state: int, reward: float) -> int:
        """Return the matching outcome in the transition table, or −1 if several or none match."""
        mdp = self._world.world.mdp
        if mdp is None:
            return UNKNOWN_ACTION
        first, last = int(mdp.first_outcome[pair]), int(mdp.first_outcome[pair + 1])
        fits = (mdp.next_state[first:last] == next_state) & (mdp.reward[first:last] == reward)
        return first + int(np.argmax(fits)) if np.count_nonzero(fits) == 1 else UNKNOWN_ACTION
