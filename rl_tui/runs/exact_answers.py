"""Exact solutions of a world by γ."""

from __future__ import annotations

import math
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
    from rl_tui.runs.played_run import PlayedRun
    from rl_tui.runs.recipe import Recipe

AT_ONCE_STATES: Final = 200
# Starting from the values before an edit, this many states take less than the 8 ms that a thread would
# cost, or 50 ms at γ = 1.
EDITED_AT_ONCE: Final = 1_000
# Longer episodes take more than some milliseconds, even in a small world
LONGEST_AT_ONCE: Final = 1_000
LIVE_STATES: Final = 20_000
KEPT: Final = 64
_MOST_WORLDS: Final = 4  # one for each run
# An evaluation within a time limit visits every outcome once per step, about 10⁹ visits a second. Snapshots
# must not wait, so they leave out anything slower than this.
DEAREST_LIVE: Final = 2_000_000
# Without a time limit, solving linear equations costs about as much as this many visits.
UNLIMITED: Final = 100


def visits_of(mdp: TabularMDP) -> int:
    """Estimate the visits of an outcome in an exact evaluation."""
    return len(mdp.next_state) * (mdp.time_limit or UNLIMITED)


def is_quick(mdp: TabularMDP) -> bool:
    """Return True if policies can be evaluated in every frame."""
    return mdp.states <= AT_ONCE_STATES and mdp.time_limit <= LONGEST_AT_ONCE


class Answer(NamedTuple):
    """An exact solution or the reason why there is none, both empty while pending."""

    solution: Solution | None
    refused: str
    expected_return: float | None = None
    """Expected return of the greedy policy of the solution, or None if unknown or pending."""
    is_whole: bool = True
    """False while something is pending. The return arrives after the solution."""


NO_TABLE: Final = "this environment has no transition table"
PENDING: Final = Answer(None, "", is_whole=False)


Solve = Callable[[TabularMDP, float], Solution]


def _solve(mdp: TabularMDP, gamma: float, near: FloatArray | None = None) -> Solution:
    from rl_tui.agents.exact.solve import solve

    return solve(mdp, gamma, near)


def _with_return(mdp: TabularMDP, solution: Solution) -> Answer:
    from rl_tui.agents.exact.solve import greedy_return

    return Answer(solution, "", greedy_return(mdp, solution))


def exact_now(mdp: TabularMDP | None, gamma: float) -> Answer:
    """Solve a small world that changes after every step."""
    return Answer(None, NO_TABLE) if mdp is None else _with_return(mdp, _solve(mdp, gamma))


class _Worker:
    """A thread for several worlds, the latest request first."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._waiting: list[ExactAnswers] = []
        self._is_working = False

    def add(self, answers: ExactAnswers) -> None:
        with self._lock:
            self._waiting.append(answers)
            if not self._is_working:
                self._is_working = True
                threading.Thread(target=self._work, name="exact answers", daemon=True).start()

    def drop(self, answers: ExactAnswers) -> None:
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
    """Exact solutions of one world by γ: at once for a small world, else in a thread.

    Above 20,000 states there are none. `on_ready` is called in the thread for a solution, and again for its
    return.
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
        self.is_live = mdp is None or mdp.states <= LIVE_STATES
        """True if the world is small enough for answers during a run."""
        self._at_once = mdp is None or (mdp.states <= at_once_states and visits_of(mdp) <= DEAREST_LIVE)
        self._lock = threading.Lock()
        self._answers: OrderedDict[float, Answer] = OrderedDict()
        self._wanted: float | None = None
        self._working = False
        self._failure: BaseException | None = None

    def answer(self, gamma: float) -> Answer:
        """Return the solution for `gamma` if known, else request it."""
        if not self.is_live:
            return Answer(None, f"more than {LIVE_STATES:,} states: rl-tui solve computes the exact values")
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
        """Compute the latest requested γ until there is none."""
        while True:
            with self._lock:
                gamma, self._wanted = self._wanted, None
                # every frame in the meantime has repeated the request
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
    edited: EditedWorld
    recipe: Recipe
    solution: Solution


class RunAnswers:
    """Exact solutions of the most recent worlds, the newest first."""

    def __init__(self, on_ready: Callable[[], None]) -> None:
        self._on_ready = on_ready
        self._worker = _Worker()
        self._of_worlds: deque[ExactAnswers] = deque()
        self._last: _Solved | None = None
        self._newest: tuple[TabularMDP | None, float, Answer] = (None, math.nan, PENDING)

    def of(self, run: PlayedRun) -> Answer:
        """Return what is known for the current γ of `run`."""
        learner = run.learner
        gamma = learner.hyperparameters.gamma
        if learner.drifted:
            return exact_now(learner.mdp, gamma)
        mdp, asked, answer = self._newest
        if run.world.mdp is not mdp or gamma != asked or not answer.is_whole:
            answer = self.at(run.world.mdp, gamma, run)
            self._newest = run.world.mdp, gamma, answer
        if answer.solution is not None:
            self._last = _Solved(run.edited, run.recipe, answer.solution)
        return answer

    def at(self, mdp: TabularMDP | None, gamma: float, run: PlayedRun | None = None) -> Answer:
        """Return what is known for `gamma` in `mdp`.

        If `run` edited it, the solver starts from the solution before.
        """
        known = next((each for each in self._of_worlds if each.mdp is mdp), None)
        if known is None:
            from_before = None if run is None else self._from_before(run)
            at_once = AT_ONCE_STATES if from_before is None else EDITED_AT_ONCE
            known = ExactAnswers(mdp, self._on_ready, from_before or _solve, at_once, self._worker)
        else:
            self._of_worlds.remove(known)
        if known.is_live:  # a larger world has no answer and takes memory
            if len(self._of_worlds) == _MOST_WORLDS:
                self._worker.drop(self._of_worlds.pop())
            self._of_worlds.appendleft(known)
        return known.answer(gamma)

    def _from_before(self, run: PlayedRun) -> Solve | None:
        last, edited, recipe = self._last, run.edited, run.recipe
        if last is None or edited.draft is None or not _begin_alike(last.recipe, recipe):
            return None

        def solve(mdp: TabularMDP, gamma: float) -> Solution:
            before = edited.carried_from(last.edited, recipe).states
            return _solve(mdp, gamma, np.append(last.solution.v, 0.0)[before])  # 0 for new states

        return solve


def _begin_alike(one: Recipe, other: Recipe) -> bool:
    return one.scenario is other.scenario and one.seed == other.seed
