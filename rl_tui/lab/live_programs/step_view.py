"""The last step of a program, and the episode that it belongs to, as screens know them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from rl_tui.agents.counters import Counters
from rl_tui.agents.last_step import NOTHING, LastStep
from rl_tui.lab.live_programs.progress import Progress, steps_between
from rl_tui.lab.timeline.trail import MOST_STEPS, Trail, TrailStep
from rl_tui.worlds.mdp.tabular_mdp import UNKNOWN_ACTION

if TYPE_CHECKING:
    from rl_tui.lab.programs.recording import Steps
    from rl_tui.worlds.mdp.space import BoolArray, FloatArray

_MOST_REWARDS: Final = 256


class StepView:
    """The step that led to where ``progress`` stands; ``gamma`` discounts the rewards of its episode."""

    def __init__(self, progress: Progress, gamma: float) -> None:
        self._progress = progress
        self._gamma = gamma
        self._world = progress.world
        here = progress.step
        self._last = steps_between(progress.recording, here - 1, here) if here else None
        if self._last is not None and not len(self._last.state):
            self._last = None
        self._episode = None if self._last is None else self._steps_of_episode(self._last)

    @property
    def counters(self) -> Counters:
        """How far the program has come."""
        progress, steps = self._progress, self._episode
        if steps is None or self._last is None:
            start = self._start()
            return Counters(state=start, step_from=start, step=progress.step, episodes=progress.episodes)
        place = len(steps.state) - 1
        state = self._landing(steps, place)
        ended = bool(steps.terminated[place] or steps.truncated[place])
        length = int(steps.episode_step[place]) + 1
        rewards = steps.reward
        return Counters(
            state=state,
            step_from=self._start() if ended else state,
            step=progress.step,
            episodes=progress.episodes,
            episode_step=0 if ended else length,
            episode_return=0.0 if ended else float(sum(rewards.tolist())),
            rewards=rewards[-_MOST_REWARDS:].copy(),
            discounted_return=float(sum(rewards * self._gamma ** np.arange(len(rewards)))),
            last_step=self._last_step(steps, place, ended=ended),
        )

    @property
    def trail(self) -> Trail:
        """The last steps of its episode, oldest first."""
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

    def _steps_of_episode(self, last: Steps) -> Steps:
        """Return the steps of the episode of the last one, that one included, as far as they are kept."""
        here, length = self._progress.step, int(last.episode_step[0]) + 1
        steps = steps_between(self._progress.recording, here - length, here)
        same = steps.episode == last.episode[0]
        if not same.all():  # two environments take turns
            first = max(self._progress.recording.first, 0)
            steps = steps_between(self._progress.recording, max(first, here - 4 * length), here)
            same = steps.episode == last.episode[0]
        return type(steps)._make(column[same] for column in steps)

    def _landing(self, steps: Steps, place: int) -> int:
        return self._world.landing(
            int(steps.next_state[place]),
            float(steps.reward[place]),
            terminated=bool(steps.terminated[place]),
        )

    def _start(self) -> int:
        """Return where an episode begins, as far as that is known."""
        mdp = self._world.world.mdp
        return 0 if mdp is None else int(mdp.start_state[0])

    def _last_step(self, steps: Steps, place: int, *, ended: bool) -> LastStep | None:
        observation, action = int(steps.state[place]), int(steps.action[place])
        count = int(steps.episode_step[place])
        pair = self._world.pair(observation, action, count)
        if pair == NOTHING:
            return None  # for screens a step without a pair is a planner's
        next_state = self._landing(steps, place)
        moved, others, before, after = self._moved(observation, action)
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
            step_size=1.0,
            gamma=self._gamma,
            gathered=after,
            discount=0.0,
            bootstrap=0.0,
            after=after,
            episode_step=count + 1,
        )

    def _moved(self, observation: int, action: int) -> tuple[int, int, float, float]:
        """Return the pair that moved with the last step, how many others did, and its value before and after.

        Of several it is the one that was taken, else the first; −1 where none moved.
        """
        recording, here = self._progress.recording, self._progress.step
        changes = recording.changes
        begin, end = np.searchsorted(changes.step, (here - 1, here))
        before, after = changes.before[begin:end], changes.after[begin:end]
        cells = changes.cell[begin:end]
        pairs = self._world.pair_of_cell[cells]
        known = np.flatnonzero((pairs >= 0) & ~_same(before, after))
        if not len(known):
            return NOTHING, 0, 0.0, 0.0
        own = known[cells[known] == observation * recording.actions + action]
        place = int(own[-1] if len(own) else known[0])
        others = len(np.unique(cells[known])) - 1
        return int(pairs[place]), others, float(np.nan_to_num(before[place])), float(after[place])

    def _outcome(self, pair: int, next_state: int, reward: float) -> int:
        """Return the outcome of the table that happened, −1 where several, or none, may have."""
        mdp = self._world.world.mdp
        if mdp is None:
            return UNKNOWN_ACTION
        first, last = int(mdp.first_outcome[pair]), int(mdp.first_outcome[pair + 1])
        fits = (mdp.next_state[first:last] == next_state) & (mdp.reward[first:last] == reward)
        return first + int(np.argmax(fits)) if np.count_nonzero(fits) == 1 else UNKNOWN_ACTION


def _same(before: FloatArray, after: FloatArray) -> BoolArray:
    return np.asarray((before == after) | (np.isnan(before) & np.isnan(after)))
