"""States whose optimal actions were changed by an edit."""

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
    solution: Solution
    space: FiniteSpace
    carried: Carried


class TurnedStates:
    """Compares the optimal actions before and after the last edits."""

    def __init__(self) -> None:
        self._world: EditedWorld | None = None
        self._answer: Solution | None = None
        self._before: _Before | None = None
        self._turned: tuple[Solution, frozenset[int]] | None = None

    def of(self, run: Run, answer: Solution | None) -> frozenset[int]:
        """Return the old states whose optimal actions changed, once both solutions are known for one γ."""
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
    if before.draft is None:
        return now.done is not None and now.done.further is None
    return any(way is not None and way.draft is before.draft for way in (now.done, now.undone))


def _through(now: IntArray, was: IntArray) -> IntArray:
    return np.where(now == NEW, NEW, was[now])


def _turned(before: _Before, after: Solution, space: FiniteSpace) -> frozenset[int]:
    was = before.space, before.solution.greedy
    return frozenset(np.flatnonzero(differing_choices(was, (space, after.greedy), before.carried)).tolist())
