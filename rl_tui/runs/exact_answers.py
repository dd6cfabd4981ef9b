"""The exact answers of one world, for whatever γ is in force."""

from __future__ import annotations

import threading
from collections import OrderedDict, deque
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from rl_tui.agents.exact.policy_evaluation import NoExactAnswer, Solution
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

if TYPE_CHECKING:
    from rl_tui.runs.edited_world import EditedWorld
    from rl_tui.runs.recipe import Recipe
    from rl_tui.runs.run import Run

AT_ONCE_STATES: Final = 200
# From the values before an edit, so many take less than the frame that a thread would cost: 8 ms, and 50 at
# γ = 1
EDITED_AT_ONCE: Final = 1_000
# Up to so many steps an episode of a small world is worked out in some milliseconds
LONGEST_AT_ONCE: Final = 1_000
LIVE_STATES: Final = 20_000
KEPT: Final = 64
_MOST_WORLDS: Final = 4  # as many as runs side by side may be in
# An evaluation within a time limit visits every outcome once for every step of it, some 10⁹ a second. One
# that costs more than this is left out of snapshots, which must not wait.
DEAREST_LIVE: Final = 2_000_000
# Without a time limit linear equations are solved instead; they are charged as so many visits.
UNLIMITED: Final = 100


def visits_of(mdp: TabularMDP) -> int:
    """Return about how often an exact evaluation visits an outcome: what it costs."""
    return len(mdp.next_state) * (mdp.time_limit or UNLIMITED)


def is_quick(mdp: TabularMDP) -> bool:
    """Return whether a policy of ``mdp`` is evaluated quickly enough to be asked for in every frame."""
    return mdp.states <= AT_ONCE_STATES and mdp.time_limit <= LONGEST_AT_ONCE


class Answer(NamedTuple):
    """The exact answer, or why there is none; both empty while it is worked out."""

    solution: Solution | None
    refused: str
    expected_return: float | None = None
    """What the greedy policy of the solution earns; None where that has no answer, or none yet."""
    is_whole: bool = True
    """Whether nothing of it is still being worked out. What it earns comes after the solution."""


NO_TABLE: Final = "this environment has no transition table to work it out from"
PENDING: Final = Answer(None, "", is_whole=False)


Solve = Callable[[TabularMDP, float], Solution]


def _solve(mdp: TabularMDP, gamma: float, near: FloatArray | None = None) -> Solution:
    from rl_tui.agents.exact.solve import solve

    return solve(mdp, gamma, near)


def _with_return(mdp: TabularMDP, solution: Solution) -> Answer:
    from rl_tui.agents.exact.solve import greedy_return

    return Answer(solution, "", greedy_return(mdp, solution))


def exact_now(mdp: TabularMDP | None, gamma: float) -> Answer:
    """Return the exact answer of a small world that is another one after every step."""
    return Answer(None, NO_TABLE) if mdp is None else _with_return(mdp, _solve(mdp, gamma))


class _Worker:
    """A thread for answers of one world after another, that of the world asked for last first."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._waiting: list[ExactAnswers] = []
        self._is_working = False

    def add(self, answers: ExactAnswers) -> None:
        """Let it work ``answers`` out next."""
        with self._lock:
            self._waiting.append(answers)
            if not self._is_working:
                self._is_working = True
                threading.Thread(target=self._work, name="exact answers", daemon=True).start()

    def drop(self, answers: ExactAnswers) -> None:
        """Leave ``answers`` out, unless they are worked out already: nobody asks for them any more."""
        with self._lock:
            if answers in self._waiting:
                self._waiting.remove(answers)

    def _work(self) -> None:
        while True:
            with self._lock:
                if not self._waiting:
                    self._is_working = False
                    return
                newest = self._waiting.pop()
            newest.work_out()


class ExactAnswers:
    """Exact answers by γ: small worlds at once, others in a thread, none above 20,000 states.

    A world is small if it has few states and its time limit does not make an evaluation dear. ``on_ready`` is
    called, in that thread, when an answer that was asked for has come, and again when what it earns has.
    ``worker`` is the thread, where others share it.
    """

    def __init__(
        self,
        mdp: TabularMDP | None,
        on_ready: Callable[[], None],
        solve: Solve = _solve,
        at_once_states: int = AT_ONCE_STATES,
        worker: _Worker | None = None,
    ) -> None:
        self.mdp = mdp
        self._on_ready = on_ready
        self._solve = solve
        self._worker = worker or _Worker()
        self._at_once = mdp is None or (mdp.states <= at_once_states and visits_of(mdp) <= DEAREST_LIVE)
        self._lock = threading.Lock()
        self._answers: OrderedDict[float, Answer] = OrderedDict()
        self._wanted: float | None = None
        self._working = False
        self._failure: BaseException | None = None

    def answer(self, gamma: float) -> Answer:
        """Return the answer for ``gamma`` if it is known, and see to it that it will be."""
        if self.mdp is not None and self.mdp.states > LIVE_STATES:
            return Answer(None, f"more than {LIVE_STATES:,} states: rl-tui solve has the exact answer")
        with self._lock:
            if self._failure is not None:
                raise self._failure
            known = self._answers.get(gamma)
            if known is not None:
                self._answers.move_to_end(gamma)
                return known
            if self._at_once:
                *_, whole = self._parts(gamma)
                return self._keep(gamma, whole)
            self._wanted = gamma
            if not self._working:
                self._working = True
                self._worker.add(self)
        return PENDING

    def work_out(self) -> None:
        """Work out the newest γ that was asked for until none is left; those overtaken are skipped."""
        while True:
            with self._lock:
                gamma, self._wanted = self._wanted, None
                # Every picture drawn meanwhile has asked again for the answer that has just come
                if gamma is None or gamma in self._answers:
                    self._working = False
                    return
            try:
                for answer in self._parts(gamma):
                    with self._lock:
                        self._keep(gamma, answer)
                    self._on_ready()
            except BaseException as error:
                with self._lock:
                    self._failure, self._working = error, False
                self._on_ready()
                return

    def _parts(self, gamma: float) -> Iterator[Answer]:
        """Yield the answer as soon as it is there, and then again with what it earns."""
        if self.mdp is None:
            yield Answer(None, NO_TABLE)
            return
        try:
            solution = self._solve(self.mdp, gamma)
        except NoExactAnswer as refusal:
            yield Answer(None, str(refusal))
            return
        yield Answer(solution, "", is_whole=False)
        yield _with_return(self.mdp, solution)

    def _keep(self, gamma: float, answer: Answer) -> Answer:
        self._answers[gamma] = answer
        while len(self._answers) > KEPT:
            self._answers.popitem(last=False)
        return answer


class _Solved(NamedTuple):
    """The last answer there was, and of which world."""

    edited: EditedWorld
    recipe: Recipe
    solution: Solution


class RunAnswers:
    """The exact answers of runs in the worlds asked for last; ``on_ready`` as for :class:`ExactAnswers`.

    Runs side by side may each be in a world of its own. One is worked out at a time, the newest first, so
    that strokes that follow one another quickly do not keep each other waiting.
    """

    def __init__(self, on_ready: Callable[[], None]) -> None:
        self._on_ready = on_ready
        self._worker = _Worker()
        self._of_worlds: deque[ExactAnswers] = deque()
        self._last: _Solved | None = None

    def of(self, run: Run) -> Answer:
        """Return the exact answer for the γ in force in ``run``, as far as it is known."""
        learner = run.learner
        gamma = learner.hyperparameters.gamma
        if learner.drifted:
            return exact_now(learner.mdp, gamma)
        answer = self.at(run.world.mdp, gamma, run)
        if answer.solution is not None:
            self._last = _Solved(run.edited, run.recipe, answer.solution)
        return answer

    def at(self, mdp: TabularMDP | None, gamma: float, run: Run | None = None) -> Answer:
        """Return the exact answer for ``gamma`` in the world of ``mdp``, as far as it is known.

        Where an edit made that world for ``run``, it is worked out from the answer before the edit.
        """
        known = next((each for each in self._of_worlds if each.mdp is mdp), None)
        if known is None:
            from_before = None if run is None else self._from_before(run)
            at_once = AT_ONCE_STATES if from_before is None else EDITED_AT_ONCE
            known = ExactAnswers(mdp, self._on_ready, from_before or _solve, at_once, self._worker)
        else:
            self._of_worlds.remove(known)
        if mdp is None or mdp.states <= LIVE_STATES:  # of a larger one nothing is known, and it takes memory
            if len(self._of_worlds) == _MOST_WORLDS:
                self._worker.drop(self._of_worlds.pop())
            self._of_worlds.appendleft(known)
        return known.answer(gamma)

    def _from_before(self, run: Run) -> Solve | None:
        """Return what solves the edited world of ``run`` from the last answer; None where there is none."""
        last, edited, recipe = self._last, run.edited, run.recipe
        if last is None or edited.draft is None or not _begin_alike(last.recipe, recipe):
            return None

        def solve(mdp: TabularMDP, gamma: float) -> Solution:
            before = edited.carried_from(last.edited, recipe).states
            return _solve(mdp, gamma, np.append(last.solution.v, 0.0)[before])  # 0 where it is NEW

        return solve


def _begin_alike(one: Recipe, other: Recipe) -> bool:
    return one.scenario is other.scenario and one.seed == other.seed
