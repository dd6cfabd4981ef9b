"""What a program is to stop at, looked at after every step."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rl_tui.common.errors import UserError
from rl_tui.lab.live.stop_condition import is_optimal
from rl_tui.lab.live.until import Breakpoints, Event, Until
from rl_tui.lab.live_programs.progress import Progress, steps_between
from rl_tui.lab.programs.messages import NO_LIMIT

if TYPE_CHECKING:
    from rl_tui.lab.run.exact_answers import Answer
    from rl_tui.worlds.mdp.space import BoolArray


class ProgramStop:
    """Waits for ``until`` in the program whose newest moment is ``progress``.

    Raises UserError where it cannot happen: it lies behind, the pair or the exact answer is not there.
    """

    def __init__(self, until: Until, progress: Progress, answer: Answer) -> None:
        self.until = until
        self.steps = NO_LIMIT
        """After how many steps of the program it is over in any case."""
        self._progress = progress
        self._optimum = answer.solution
        self._episodes = NO_LIMIT
        space = progress.world.world.space
        match until.event:
            case Event.STEP:
                self.steps = until.number
                _check_ahead(
                    until.number > progress.step, f"step {until.number:,}", f"step {progress.step:,}"
                )
            case Event.EPISODE:
                self._episodes = until.number - 1
                here = f"episode {progress.episodes + 1:,}"
                _check_ahead(
                    self._episodes > progress.episodes, f"the start of episode {until.number:,}", here
                )
            case Event.EPISODE_END:
                self._episodes = progress.episodes + 1 + until.number
            case Event.VALUE if not 0 <= until.pair < space.pairs:
                raise UserError(f"there is no pair {until.pair} here")
            case Event.OPTIMAL:
                self._check_optimal(answer)
        self._best = self._best_pairs() if until.event in (Event.POLICY_CHANGE, Event.OPTIMAL) else None
        self._value = self._value_now()

    @property
    def looks_at_each_step(self) -> bool:
        """Whether it may be over after any step."""
        return self.until.event is not Event.STEP

    def is_over(self) -> bool:
        """Return whether it has happened with the last step; to be asked after each."""
        progress = self._progress
        match self.until.event:
            case Event.STEP | Event.EPISODE | Event.EPISODE_END:
                return progress.step >= self.steps or progress.episodes >= self._episodes
            case Event.REWARD:
                last = steps_between(progress.recording, progress.step - 1, progress.step)
                return bool((last.reward != 0.0).any())
            case Event.VALUE:
                before, now = self._value, self._value_now()
                self._value = now
                return min(before, now) < self.until.threshold <= max(before, now) or (
                    now == self.until.threshold and before != now
                )
        before_best, self._best = self._best, self._best_pairs()
        has_changed = before_best is None or not np.array_equal(before_best, self._best)
        return has_changed and (self.until.event is Event.POLICY_CHANGE or self._is_optimal())

    def _value_now(self) -> float:
        return float(self._progress.q[self.until.pair]) if self.until.event is Event.VALUE else 0.0

    def _best_pairs(self) -> BoolArray:
        from rl_tui.agents.exact.policies import best_pairs

        return best_pairs(self._progress.world.world.space, self._progress.q)

    def _check_optimal(self, answer: Answer) -> None:
        if self._progress.world.world.mdp is None or answer.refused:
            raise UserError(f"no policy can be told to be optimal: {answer.refused}")
        if answer.solution is None:
            raise UserError("the exact answer is still being worked out: try again in a moment")
        if self._is_optimal():
            raise UserError("the greedy policy is optimal already")

    def _is_optimal(self) -> bool:
        mdp = self._progress.world.world.mdp
        if mdp is None or self._optimum is None or self._progress.table is None:
            return False
        return is_optimal(mdp, self._progress.q, "random", self._optimum)


def met_breakpoint(breakpoints: Breakpoints, progress: Progress) -> str:
    """Return the breakpoint that the last step of ``progress`` met, in words; empty if none."""
    if not breakpoints or not progress.step:
        return ""
    world, space = progress.world, progress.world.world.space
    last = steps_between(progress.recording, progress.step - 1, progress.step)
    if not len(last.state):
        return ""
    pair = world.pair(int(last.state[0]), int(last.action[0]), int(last.episode_step[0]))
    if pair in breakpoints.pairs:
        return f"breakpoint: {space.pair_name(pair)}"
    state = world.landing(int(last.next_state[0]), float(last.reward[0]), terminated=bool(last.terminated[0]))
    return f"breakpoint: state {space.state_names[state]}" if state in breakpoints.states else ""


def _check_ahead(is_ahead: bool, wanted: str, here: str) -> None:
    if not is_ahead:
        raise UserError(f"{wanted} lies behind: this is {here}; b and g go back")
