"""What a program is to stop at: as it is asked to, and whether that was it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rl_tui.common.errors import UserError
from rl_tui.lab.live.stop_condition import is_optimal
from rl_tui.lab.live.until import Breakpoints, Event, Until
from rl_tui.lab.live_programs.progress import ProgramState, steps_between
from rl_tui.lab.programs.messages import NO_LIMIT

if TYPE_CHECKING:
    from rl_tui.lab.programs.program_world import ProgramWorld
    from rl_tui.lab.run.exact_answers import Answer


class ProgramStop:
    """Waits for ``until`` in the program whose newest moment is ``progress``.

    Raises UserError where it cannot happen: it lies behind, the pair or the exact answer is not there.
    """

    def __init__(self, until: Until, progress: ProgramState, answer: Answer) -> None:
        self.until = until
        self.steps = NO_LIMIT
        """After how many steps of the program it is over in any case."""
        self._asked: dict[str, Any] = {}
        self._episodes: int | None = None  # how many are to have ended
        self._progress = progress
        self._optimum = answer.solution
        world = progress.world
        match until.event:
            case Event.STEP:
                self.steps = until.number
                here = f"step {progress.step:,}"
                _check_ahead(until.number > progress.step, f"step {until.number:,}", here)
            case Event.EPISODE:
                left, here = until.number - 1 - progress.episodes, f"episode {progress.episodes + 1:,}"
                _check_ahead(left > 0, f"the start of episode {until.number:,}", here)
                self._episodes = until.number - 1
            case Event.EPISODE_END:
                self._episodes = progress.episodes + 1 + until.number
            case Event.REWARD:
                self._asked = {"reward": True}
            case Event.POLICY_CHANGE:
                self._asked = {"policy": True}
            case Event.VALUE:
                if not 0 <= until.pair < world.world.space.pairs:
                    raise UserError(f"there is no pair {until.pair} here")
                self._asked = {"value": [int(world.cell_of_pair[until.pair]), until.threshold]}
            case Event.OPTIMAL:
                self._check_optimal(answer)
                self._asked = {"policy": True}

    @property
    def asked(self) -> dict[str, Any]:
        """What the program, which is at rest, is asked to stop at, as messages.py has it."""
        if self._episodes is None:
            return self._asked
        return {"episode_ends": max(1, self._episodes - self._progress.episodes)}

    @property
    def is_over(self) -> bool:
        """Whether what the program stopped at is what was waited for."""
        return self.until.event is not Event.OPTIMAL or self._is_optimal()

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


def asked_for(breakpoints: Breakpoints, world: ProgramWorld) -> dict[str, Any]:
    """Return what a program is asked to stop at for ``breakpoints``, as messages.py has it."""
    asked: dict[str, Any] = {}
    if breakpoints.states:
        states = np.array(sorted(breakpoints.states))
        seen = np.isin(world.state_of, states) | np.isin(world.first_state_of, states)
        asked["states"] = np.flatnonzero(seen).tolist()
    if breakpoints.pairs:
        asked["cells"] = sorted({int(world.cell_of_pair[pair]) for pair in breakpoints.pairs})
    return asked


def met_breakpoint(breakpoints: Breakpoints, progress: ProgramState) -> str:
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
