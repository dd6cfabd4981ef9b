"""The way that the agent went in its episode, as far as it is known, and finding out the rest."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Final, NamedTuple

from rl_tui.worlds.mdp.tabular_mdp import UNKNOWN_ACTION

if TYPE_CHECKING:
    from rl_tui.agents.last_step import LastStep
    from rl_tui.runs.recipe import JournalEntry
    from rl_tui.runs.run import Run
    from rl_tui.worlds.world import World

MOST_STEPS: Final = 128
"""So many steps of an episode are kept, the last ones."""
MOST_PAIRS: Final = 1_000_000
"""A larger world has no trail but what was recorded: to replay it takes as much memory again."""
FEW_STEPS: Final = 8
"""So many steps at a time are recorded, one by one: more than fall due at once at 30 a second."""
LONGEST: Final = 1.0
"""After so many seconds a replay is given up."""
_QUICK: Final = 0.002  # seconds; a piece of a replay that takes less is followed by a larger one


class TrailStep(NamedTuple):
    """One step of a trail."""

    step: int
    """Its number in the run, from 1."""
    state: int
    """Where the agent was."""
    action: int
    """The action that it chose."""
    happened: int
    """The action that really happened; −1 where that is not known."""
    next_state: int
    """Where the step led."""

    @property
    def slipped(self) -> bool:
        """Whether another action happened than was chosen."""
        return self.happened not in (UNKNOWN_ACTION, self.action)


Trail = tuple[TrailStep, ...]
"""Consecutive steps of one episode, oldest first."""


class TrailRecorder:
    """Keeps the last steps of the episode of a run, of those that it is told of.

    ``given_up`` is the step for which the rest could not be found out.
    """

    def __init__(self) -> None:
        self.given_up = -1
        self._steps: deque[TrailStep] = deque(maxlen=MOST_STEPS)

    def note(self, last: LastStep | None, world: World) -> None:
        """Take in the step that was taken last in ``world``; what does not lead up to it is forgotten."""
        newest = self._steps[-1] if self._steps else None
        if last is None or last.planned:
            self._steps.clear()
            return
        if newest is not None and newest.step == last.step:
            return
        follows = newest is not None and (newest.step + 1, newest.next_state) == (last.step, last.state)
        if not follows or last.episode_step == 1:
            self._steps.clear()
        mdp, action = world.mdp, int(world.space.pair_action[last.pair])
        known = mdp is not None and last.outcome != UNKNOWN_ACTION
        happened = int(mdp.outcome_action[last.outcome]) if mdp is not None and known else UNKNOWN_ACTION
        self._steps.append(TrailStep(last.step, last.state, action, happened, last.next_state))

    def up_to(self, last: LastStep | None) -> Trail:
        """Return what is known of the steps that lead up to ``last``, that one included."""
        is_there = last is not None and len(self._steps) > 0 and self._steps[-1].step == last.step
        return tuple(self._steps) if is_there else ()

    def go_back(self, step: int) -> None:
        """Forget what came after ``step``."""
        while self._steps and self._steps[-1].step > step:
            self._steps.pop()

    def forget(self) -> None:
        """Forget everything."""
        self._steps.clear()


class TrailReplay:
    """A replay of the last steps of an episode by ``run``, a spare one, from somewhere before them.

    It ends at the step ``last``; ``recorder`` is told of those after ``first``.
    """

    def __init__(
        self, run: Run, journal: Sequence[JournalEntry], first: int, last: int, recorder: TrailRecorder
    ) -> None:
        self.run = run
        """The spare run."""
        self.last = last
        """The step at which it ends."""
        self._journal = journal
        self._first = first
        self._recorder = recorder
        self._spent = 0.0
        self._piece = 1
        run.learner.watch(None)
        recorder.forget()

    def go_on(self, seconds: float, clock: Callable[[], float]) -> bool:
        """Replay for about ``seconds``, infinity for as long as it takes; return whether that was all.

        In pieces it is given up once it has taken too long.
        """
        start, run = clock(), self.run
        until, now = start + seconds, start
        while run.step < self.last and now < until:
            before = run.step
            if before < self._first:
                run.follow(self._journal, min(self._first, before + self._piece))
                self._piece *= 4 if clock() - now < _QUICK else 1
            else:
                run.follow(self._journal, before + 1)
                self._recorder.note(run.learner.last_step, run.world)
            if run.step == before:
                break
            now = clock()
        self._spent += now - start
        if run.step == self.last:
            return True
        is_stuck = now < until
        if is_stuck or self._spent > LONGEST:
            self._recorder.given_up = self.last
            return True
        return False
