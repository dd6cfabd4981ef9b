from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from recipes import recipe

from rl_tui.agents.hyperparameters import Ties
from rl_tui.runs import evaluation
from rl_tui.runs.evaluation import Evaluation, GreedyReturn
from rl_tui.runs.recipe import begin
from rl_tui.runs.run import Run
from rl_tui.worlds.mdp.space import FloatArray

STUDENT = begin(recipe("student")).world.space


class Counted(GreedyReturn):
    """Returns 0, 1, 2, ... to identify each draw."""

    calls = 0

    def __call__(self, q: FloatArray, ties: Ties) -> float | None:
        self.calls += 1
        return float(self.calls - 1)


def after(marks: int, most: int) -> Evaluation:
    taken = Evaluation(STUDENT, Counted(lambda: STUDENT), most)
    for _ in range(marks):
        assert taken.next_step is not None
        taken.mark(taken.next_step // 2, np.zeros(5), "random")
    return taken


def test_marks_start_at_step_0_and_follow_every_16_steps() -> None:
    marks = after(3, most=8).marks()
    assert marks.step.tolist() == [0, 16, 32]
    assert marks.episode.tolist() == [0, 8, 16]
    assert marks.expected_return.tolist() == [0.0, 1.0, 2.0]


def test_many_marks_are_thinned_out_and_their_spacing_doubles() -> None:
    taken = after(8, most=8)
    assert taken.marks().step.tolist() == [0, 32, 64, 96]
    assert taken.marks().expected_return.tolist() == [0.0, 2.0, 4.0, 6.0]
    assert taken.next_step == 128
    assert after(12, most=8).marks().step.tolist() == [0, 64, 128, 192]


def test_a_restored_evaluation_goes_on_alike() -> None:
    taken, other = after(5, most=8), after(0, most=8)
    other.restore(taken.checkpoint())
    assert other.next_step == taken.next_step == 80
    assert other.marks().step.tolist() == taken.marks().step.tolist()


def test_dear_evaluations_are_rare_from_the_start() -> None:
    lake = begin(recipe("frozenlake-8x8-slippery")).world.space
    spacing = 16
    while spacing * evaluation.VISITS_A_STEP < len(lake.next_state) * 200:
        spacing *= 2
    taken = Evaluation(lake, GreedyReturn(lambda: lake))
    taken.mark(0, np.zeros(lake.pairs), "random")
    assert taken.next_step == spacing > 16


def test_huge_worlds_have_no_marks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(evaluation, "MOST_STATES", 3)
    assert Evaluation(STUDENT, GreedyReturn(lambda: STUDENT)).next_step is None


def test_the_greedy_return_of_the_student_is_the_one_worked_out_by_hand() -> None:
    greedy_return = GreedyReturn(lambda: STUDENT)
    names = [STUDENT.action_names[action] for action in STUDENT.pair_action]
    study = np.array([1.0 if name in ("study", "quit", "sleep") else 0.0 for name in names])
    # −2 for each of 1 / 0.8 attempts, then +10. The limit of 100 steps removes less than 1e-60
    assert greedy_return(study, "random") == pytest.approx(7.5)
    assert greedy_return(study * 2, "first") == pytest.approx(7.5)
    drift = np.array([1.0 if name in ("check phone", "quit") else 0.0 for name in names])
    assert greedy_return(drift, "random") == 0.0


def test_where_the_greedy_policy_has_no_return_it_is_told_how_likely_it_ends() -> None:
    cliff = begin(recipe("cliff")).world.space
    greedy_return = GreedyReturn(lambda: cliff)
    upwards = np.array([1.0 if cliff.action_names[action] == "↑" else 0.0 for action in cliff.pair_action])
    assert greedy_return.figures(upwards, "first", None)[:2] == (None, 0.0)
    earned, ends, _ = greedy_return.figures(np.zeros(cliff.pairs), "random", None)
    assert earned is not None
    assert ends is None


def test_the_figures_of_a_run_tell_that_its_greedy_policy_never_ends() -> None:
    run = Run(recipe("cliff", ties="first"))
    assert run.results.greedy_return is None
    assert run.results.greedy_ends == 0.0
    assert Run(recipe("cliff")).results.greedy_ends is None


def test_figures_work_out_only_what_is_not_known(monkeypatch: pytest.MonkeyPatch) -> None:
    called = list[str]()

    def counted(name: str) -> Callable[..., float | None]:
        work_out = getattr(evaluation, name)

        def work_out_and_count(*args: Any) -> float | None:
            called.append(name)
            answer: float | None = work_out(*args)
            return answer

        return work_out_and_count

    for name in ("expected_return", "chance_of_ending"):
        monkeypatch.setattr(evaluation, name, counted(name))
    cliff = begin(recipe("cliff")).world.space
    upwards = np.array([1.0 if cliff.action_names[action] == "↑" else 0.0 for action in cliff.pair_action])
    greedy_return = GreedyReturn(lambda: cliff)
    assert greedy_return.figures(upwards, "first", 0.0) == (None, 0.0, None)
    assert called == ["expected_return", "chance_of_ending"]
    assert greedy_return.figures(upwards, "first", 0.1)[:2] == (None, 0.0)
    assert called == ["expected_return", "chance_of_ending", "expected_return"]
    earned = greedy_return.figures(np.zeros(cliff.pairs), "random", 0.0)
    assert earned.softened == earned.expected_return is not None
