"""States whose optimal actions were changed by an edit of the world."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rl_tui.worlds.editing.carried import NEW, Carried, differing_choices

if TYPE_CHECKING:
    from rl_tui.agents.exact.policy_evaluation import Solution
    from rl_tui.runs.edited_world import EditedWorld
    from rl_tui.runs.run import Run
    from rl_tui.worlds.mdp.space import FiniteSpace, IntArray


@dataclass(frozen=True, slots=True, eq=False)
class _Before:
    """The last known solution of an earlier world, and how its states map to the current one."""

    solution: Solution
    space: FiniteSpace
    carried: Carried


class TurnedStates:
    """Compares the optimal actions before and after the last edit. Edits that follow before a solution has
    arrived count as one.
    """

    def __init__(self) -> None:
        self._world: EditedWorld | None = None
        self._answer: Solution | None = None
        self._before: _Before | None = None
        self._turned: tuple[Solution, frozenset[int]] | None = None

    def of(self, run: Run, answer: Solution | None) -> frozenset[int]:
        """Return the states of `run` whose optimal actions changed with the last edit.

        Args:
            run: Run in the edited world.
            answer: Solution of the current world for the current γ, or None while unknown.

        Returns:
            State numbers without new states. Empty until both solutions are known for the same γ.
        """
        if run.edited is not self._world:
            self._before = self._remembered(run)
            self._world, self._answer, self._turned = run.edited, None, None
        self._answer = answer or self._answer
        if self._before is None or answer is None or answer.gamma != self._before.solution.gamma:
            return frozenset()
        if self._turned is None or self._turned[0] is not answer:
            self._turned = answer, _turned(self._before, answer, run.world.space)
        return self._turned[1]

    def _remembered(self, run: Run) -> _Before | None:
        """Return the earlier world if one edit leads from it to the world of `run`, else None."""
        before, between = self._world, self._before
        if before is None or not _follows(run.edited, before):
            return None
        if self._answer is not None:
            now = run.edited.carried_from(before, run.recipe)
            return _Before(self._answer, before.world.space, now)
        if between is None:
            return None
        now, was = run.edited.carried_from(before, run.recipe), between.carried
        carried = Carried(_through(now.states, was.states), _through(now.pairs, was.pairs))
        return _Before(between.solution, between.space, carried)


def _follows(now: EditedWorld, before: EditedWorld) -> bool:
    """Return True if one edit, undo or redo turns `before` into `now`."""
    if before.draft is None:
        return now.done is not None and now.done.further is None
    return any(way is not None and way.draft is before.draft for way in (now.done, now.undone))


def _through(now: IntArray, was: IntArray) -> IntArray:
    """Compose two maps of numbers: `now` into a world in between, `was` from there to the first one."""
    return np.where(now == NEW, NEW, was[now])


def _turned(before: _Before, after: Solution, space: FiniteSpace) -> frozenset[int]:
    was = before.space, before.solution.greedy
    return frozenset(np.flatnonzero(differing_choices(was, (space, after.greedy), before.carried)).tolist())
