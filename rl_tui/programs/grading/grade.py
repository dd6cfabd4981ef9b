"""Grading of submissions: their returns, compared with the best return."""

from __future__ import annotations

import math
import statistics
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from rl_tui.agents.exact.policy_evaluation import NoExactAnswer
from rl_tui.agents.exact.policy_figures import expected_return, greedy_policy, uniform_over, uniform_policy
from rl_tui.agents.exact.solve import best_expected_return, solve
from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line
from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.diagnosis.faults.choices import MOST_LUCK
from rl_tui.programs.evidence.code_places import program_code
from rl_tui.programs.evidence.verdict import RISKS, CodeFault, CodeFinding, SuspectedRisk
from rl_tui.programs.grading.agent_training import (
    agent_request,
    error_in_a_line,
    error_of_agent,
    estimates_of,
)
from rl_tui.programs.grading.submissions import Submission, agent_of
from rl_tui.programs.grading.watch_report import environment_of, error_of, finding_as_json
from rl_tui.programs.watched.program_log import ProgramEnvironment, ProgramLog
from rl_tui.programs.watched.program_process import TIME_LIMIT, ProgramRequest, watched_to_the_end
from rl_tui.programs.watched.program_world import world_of_program
from rl_tui.programs.watched.recording import Recording
from rl_tui.runs.figures import MOST_STATES
from rl_tui.runs.library import recipe_named
from rl_tui.runs.recipe import Recipe, begin
from rl_tui.runs.training.compile_or_interpret import cores
from rl_tui.runs.training.seeded_runs import Goal
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# Share of the best return


@dataclass(frozen=True, slots=True)
class Yardstick:
    """The scale of returns in a world: the share of the best is 1 − (best − return) / stake.

    The stake (> 0) is the sum of the absolute rewards in an episode of the best policy. With costs only, −17
    on a cliff of −13 gives 0.69. `of_optimal` is the return of the optimal policy for the world's γ, which
    may be below the best, because that does not discount.
    """

    best: float
    stake: float
    of_optimal: float | None = None

    def share(self, value: float | None) -> float | None:
        """Return the share of the best, if any."""
        return None if value is None else 1.0 - (self.best - value) / self.stake


def yardstick_of(mdp: TabularMDP, gamma: float) -> Yardstick | None:
    """Return the scale for `mdp`, if it has a best return.

    Without rewards in the optimal episodes, the loss of the random policy is the stake.
    """
    best = best_expected_return(mdp)
    if best is None:
        return None
    of_optimal, turnover = _of_optimal_policy(mdp, gamma)
    stake = max(abs(best), turnover or 0.0)
    if stake == 0.0:
        at_random = expected_return(mdp, uniform_policy(mdp))
        stake = best - at_random if at_random is not None and at_random < best else 1.0
    return Yardstick(best, stake, of_optimal)


def _of_optimal_policy(mdp: TabularMDP, gamma: float) -> tuple[float | None, float | None]:
    try:
        policy = uniform_over(mdp, solve(mdp, gamma).greedy)
    except NoExactAnswer:
        return None, None
    unsigned = replace(mdp, reward=np.abs(mdp.reward))
    return expected_return(mdp, policy), expected_return(unsigned, policy)


# Grades


_LONGEST_ERROR: Final = 400
_LONGEST_ID: Final = 80
_MOST_STEPS: Final = 1_000_000
"""Number of last steps stored for the diagnosis, because several submissions are in memory at once."""
_NO_TABLE: Final = "found no table of values in it"
_NOT_RUN: Final = "not run, because an earlier seed took too long"
_SAME_ARRAYS: Final = ("first_pair", "pair_action", "first_outcome", "next_state", "terminated")
_SAME_NUMBERS: Final = ("probability", "reward", "reward_std")
_WITH_TABLE: Final = "-table"
_TOLERANCE: Final = 1e-9


@dataclass(frozen=True, slots=True)
class GradingLimits:
    """Limits of one seed: `seconds`, and `memory` in bytes."""

    seconds: float = 60.0
    memory: int = 2048 * 2**20


@dataclass(frozen=True, slots=True)
class GradedRun:
    """One seed's return of the greedy policy and its share of the best, or its error. Both are None if the
    policy may never end.
    """

    seed: int
    expected_return: float | None = None
    share: float | None = None
    error: str = ""
    findings: tuple[CodeFinding, ...] = ()
    suspected: SuspectedRisk | None = None


@dataclass(frozen=True, slots=True)
class GradedSubmission:
    """All seeds of one submission."""

    name: str
    runs: tuple[GradedRun, ...]
    threshold: float

    @property
    def shares(self) -> list[float]:
        """Shares of the best that exist."""
        return [run.share for run in self.runs if run.share is not None]

    @property
    def mean_share(self) -> float | None:
        """Mean of `shares`, if any."""
        return statistics.fmean(self.shares) if self.shares else None

    @property
    def passed(self) -> bool:
        """True if all seeds have a return, and the mean share suffices."""
        mean = self.mean_share
        return mean is not None and len(self.shares) == len(self.runs) and mean >= self.threshold - _TOLERANCE

    @property
    def findings(self) -> list[tuple[CodeFinding, int]]:
        """Each fault, with the number of seeds that show it."""
        first, count = dict[CodeFault, CodeFinding](), dict[CodeFault, int]()
        for run in self.runs:
            for finding in run.findings:
                first.setdefault(finding.fault, finding)
                count[finding.fault] = count.get(finding.fault, 0) + 1
        found = [(finding, count[fault]) for fault, finding in first.items()]
        return found if self.passed or RISKS & count.keys() else [*found, *self._risks_of_all()]

    def _risks_of_all(self) -> list[tuple[CodeFinding, int]]:
        suspected = [run.suspected for run in self.runs if run.suspected is not None]
        if not suspected:
            return []
        luck, n, k = max(each.luck for each in suspected), len(self.runs), len(suspected)
        if sum(math.comb(n, j) * luck**j * (1.0 - luck) ** (n - j) for j in range(k, n + 1)) >= MOST_LUCK:
            return []
        finding = suspected[0].finding
        text = (
            f"{finding.text} This happened in {k:,} of {n:,} seeds. With random choices among equal "
            "values, the "
            f"probability of that is below {MOST_LUCK:g}."
        )
        return [(replace(finding, text=text), k)]


class Grading:
    """Grades submissions with consecutive seeds. Raises UserError without an exact solution.

    `episodes` are for the training of an agent, and `threshold` is the mean share of the best to pass.
    """

    def __init__(
        self,
        recipe: Recipe,
        seeds: int,
        episodes: int,
        threshold: float,
        limits: GradingLimits | None = None,
    ) -> None:
        self.recipe, self.seeds, self.threshold = recipe, seeds, threshold
        self._goal = Goal(episodes=episodes)
        self.mdp, self.yardstick = _measured(recipe)
        self._limits = limits or GradingLimits()

    def grade(
        self,
        submissions: Sequence[Submission],
        on_progress: Callable[[int, int], None],
        on_graded: Callable[[GradedSubmission], None] = lambda _: None,
    ) -> list[GradedSubmission]:
        """Grade submissions in order. A crash stops no others, and a slow submission skips its further seeds.

        `on_progress` receives (runs done, runs in all), one call at a time, and `on_graded` each result in
        order.
        """
        wanted, done = len(submissions) * self.seeds, 0

        counting, given_up = threading.Lock(), threading.Event()
        slow = {each: threading.Event() for each in submissions}

        def graded(submission: Submission, seed: int) -> GradedRun:
            nonlocal done
            if slow[submission].is_set():
                run = GradedRun(seed, error=_NOT_RUN)
            else:
                run = self._graded(submission, seed, given_up, slow[submission])
            with counting:
                done += 1
                on_progress(done, wanted)
            return run

        on_progress(0, wanted)
        first = self.recipe.seed
        pool = ThreadPoolExecutor(cores(), thread_name_prefix="grade")
        try:
            futures = [
                [pool.submit(graded, each, first + place) for place in range(self.seeds)]
                for each in submissions
            ]
            grades = []
            for each, runs in zip(submissions, futures, strict=True):
                results = tuple(future.result() for future in runs)
                grades.append(GradedSubmission(each.name, results, self.threshold))
                on_graded(grades[-1])
            return grades
        finally:
            given_up.set()  # before all are done only after an exception, such as ctrl+c
            pool.shutdown(wait=True, cancel_futures=True)

    def _graded(
        self, submission: Submission, seed: int, given_up: threading.Event, slow: threading.Event
    ) -> GradedRun:
        try:
            is_agent = agent_of(submission) is not None
            log = self._watched(submission, seed, given_up, is_agent=is_agent)
            verdict = verdict_of(log)
            findings = verdict.findings
            error = error_of_agent(log, self._goal) if is_agent else error_of(log)
            if error is not None:
                if error.type == TIME_LIMIT:
                    slow.set()
                said = error_in_a_line(submission.agent.path, error)
                return GradedRun(seed, error=said, findings=findings)
            q = self._q_of_agent(log) if is_agent else self._q_of_script(log)
        except (UserError, OSError) as fault:
            return GradedRun(seed, error=one_line(str(fault), _LONGEST_ERROR))
        except Exception as fault:  # a submission may send anything, and others follow
            said = f"its result cannot be read ({type(fault).__name__}: {fault})"
            return GradedRun(seed, error=one_line(said, _LONGEST_ERROR))
        value = expected_return(self.mdp, greedy_policy(self.mdp, q, "random"))
        share = self.yardstick.share(value)
        return GradedRun(seed, value, share, findings=findings, suspected=verdict.suspected)

    def _watched(
        self, submission: Submission, seed: int, given_up: threading.Event, *, is_agent: bool
    ) -> ProgramLog:
        request = ProgramRequest(submission.agent.path, seed=seed, memory=self._limits.memory)
        if is_agent:
            recipe = replace(self.recipe, seed=seed)
            request = agent_request(submission.agent, recipe, {}, self._goal, self._limits.memory)
            request = replace(request, scenario_seed=self.recipe.seed)  # all seeds use the same world

        def check(_: ProgramLog) -> None:
            if given_up.is_set():
                raise UserError("given up")

        return watched_to_the_end(request, check, self._limits.seconds, ProgramLog(Recording(_MOST_STEPS)))

    def _q_of_agent(self, log: ProgramLog) -> FloatArray:
        q = estimates_of(log, self.mdp)
        if q is None and log.table is None and program_code(log).lacks_update:
            return np.zeros(self.mdp.pairs)  # a dict that is never written
        if q is None:
            raise UserError(_NO_TABLE)
        return q

    def _q_of_script(self, log: ProgramLog) -> FloatArray:
        environment = environment_of(log)
        if environment is None:
            raise UserError("the script created no environment that can be watched")
        known, id_ = world_of_program(environment), self.recipe.scenario.id
        if not _is_same(known.world.mdp, self.mdp):
            raise UserError(
                f"the script learns in {_as_made(environment)}, whose transitions differ from those of {id_}"
            )
        if log.recording.initial is None:
            raise UserError(_NO_TABLE)
        return known.q_of(log.recording.table_at(log.recording.count))


def grade_report(grading: Grading, graded: Sequence[GradedSubmission]) -> dict[str, Any]:
    """Return the grades as JSON data."""
    return {
        "scenario": grading.recipe.scenario.id,
        "seeds": grading.seeds,
        "threshold": grading.threshold,
        "best_expected_return": grading.yardstick.best,
        "submissions": [
            {
                "file": each.name,
                "passed": each.passed,
                "share_of_best": {"mean": each.mean_share, "min": min(each.shares, default=None)},
                "runs": [
                    {"seed": run.seed, "expected_return": run.expected_return, "error": run.error or None}
                    for run in each.runs
                ],
                "findings": [{**finding_as_json(found), "seeds": seeds} for found, seeds in each.findings],
            }
            for each in graded
        ],
    }


def _measured(recipe: Recipe) -> tuple[TabularMDP, Yardstick]:
    mdp, id_ = begin(recipe).world.mdp, recipe.scenario.id
    if mdp is None or mdp.drift_std > 0.0:
        said = f"{id_} cannot be used for grading: it has no fixed transition table, and so no exact values"
        raise UserError(f"{said}; {id_}{_WITH_TABLE} has one" if _has_table_twin(id_) else said)
    if mdp.states > MOST_STATES:
        raise UserError(
            f"{id_} cannot be used for grading: there are no exact values above {MOST_STATES:,} states"
        )
    measured = yardstick_of(mdp, recipe.hyperparameters.gamma)
    if measured is None:
        raise UserError(f"{id_} cannot be used for grading: no policy has a best return")
    return mdp, measured


def _has_table_twin(id_: str) -> bool:
    try:
        recipe_named(f"{id_}{_WITH_TABLE}")
    except UserError:
        return False
    return True


def _as_made(environment: ProgramEnvironment) -> str:
    made = ", ".join(f"{name}={value!r}" for name, value in (environment.kwargs or {}).items())
    return one_line(f"{environment.id} with {made}" if made else environment.id, _LONGEST_ID)


def _is_same(found: TabularMDP | None, wanted: TabularMDP) -> bool:
    if found is None or (found.states, found.pairs) != (wanted.states, wanted.pairs):
        return False
    return all(np.array_equal(getattr(found, name), getattr(wanted, name)) for name in _SAME_ARRAYS) and all(
        np.allclose(getattr(found, name), getattr(wanted, name), rtol=0.0, atol=_TOLERANCE)
        for name in _SAME_NUMBERS
    )
