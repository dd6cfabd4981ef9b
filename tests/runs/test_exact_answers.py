from __future__ import annotations

import threading
from dataclasses import replace

import pytest
from edited_worlds import edit, large_map, small_map
from playing import begin as begin_playing
from playing import do
from recipes import recipe

from rl_tui.agents.exact.policy_evaluation import NoExactAnswer, Solution
from rl_tui.agents.exact.solve import greedy_return, solve
from rl_tui.live.commands import AddBranch, ChooseLane, DrawWorld, GoTo, Step, Train
from rl_tui.runs import exact_answers
from rl_tui.runs.exact_answers import PENDING, Answer, ExactAnswers, RunAnswers
from rl_tui.runs.recipe import begin
from rl_tui.runs.run import Run
from rl_tui.worlds.editing.carried import NEW
from rl_tui.worlds.editing.edit import read_edits
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

STUDENT = begin(recipe("student")).world.space


def nobody() -> None:
    """A listener that does nothing."""


def test_small_worlds_are_answered_at_once_and_remembered() -> None:
    asked: list[float] = []

    def counted(mdp: TabularMDP, gamma: float) -> Solution:
        asked.append(gamma)
        return solve(mdp, gamma)

    answers = ExactAnswers(STUDENT, nobody, counted)
    first = answers.answer(0.9).solution
    assert first.v[0] == pytest.approx(5.2 / 0.82, abs=1e-9)
    assert answers.answer(0.5).solution is not None
    assert answers.answer(0.9).solution is first
    assert asked == [0.9, 0.5]


def test_a_refusal_is_kept_as_text() -> None:
    def refusing(mdp: TabularMDP, gamma: float) -> Solution:
        raise NoExactAnswer("a loop gains for ever")

    assert ExactAnswers(STUDENT, nobody, refusing).answer(1.0) == Answer(None, "a loop gains for ever")


def test_larger_worlds_are_answered_later_and_overtaken_questions_skipped() -> None:
    begun, go_on, ready = threading.Event(), threading.Event(), threading.Semaphore(0)
    asked: list[float] = []

    def slowly(mdp: TabularMDP, gamma: float) -> Solution:
        asked.append(gamma)
        begun.set()
        go_on.wait()
        return solve(mdp, gamma)

    answers = ExactAnswers(STUDENT, lambda: ready.release(), slowly, at_once_states=0)
    assert answers.answer(0.1) == PENDING
    begun.wait()
    for gamma in (0.2, 0.3, 0.4):
        assert answers.answer(gamma) == PENDING
    go_on.set()
    for _ in range(4):  # the exact values of each, and the returns
        ready.acquire()
    assert asked == [0.1, 0.4]
    assert answers.answer(0.4).solution is not None
    assert answers.answer(0.1).solution is not None


def test_an_answer_does_not_wait_for_what_it_earns(monkeypatch: pytest.MonkeyPatch) -> None:
    ready, go_on = threading.Semaphore(0), threading.Event()

    def slowly(mdp: TabularMDP, solution: Solution) -> float | None:
        go_on.wait()
        return greedy_return(mdp, solution)

    monkeypatch.setattr("rl_tui.agents.exact.solve.greedy_return", slowly)
    answers = ExactAnswers(STUDENT, lambda: ready.release(), at_once_states=0)
    assert answers.answer(0.9) == PENDING
    ready.acquire()
    first = answers.answer(0.9)
    assert first.solution is not None
    assert (first.expected_return, first.is_whole) == (None, False)
    go_on.set()
    ready.acquire()
    whole = answers.answer(0.9)
    assert (whole.solution, whole.is_whole) == (first.solution, True)
    assert whole.expected_return == pytest.approx(7.5, abs=1e-12)


def test_a_small_world_with_a_long_time_limit_does_not_keep_the_run_waiting() -> None:
    ready = threading.Event()
    answers = ExactAnswers(replace(STUDENT, time_limit=1_000_000), ready.set, lambda _, g: solve(STUDENT, g))
    assert answers.answer(0.9) == PENDING
    ready.wait()
    assert answers.answer(0.9).solution is not None


def test_an_answer_under_way_is_worked_out_once_however_often_it_is_asked_for() -> None:
    begun, go_on, ready = threading.Event(), threading.Event(), threading.Event()
    asked: list[float] = []

    def slowly(mdp: TabularMDP, gamma: float) -> Solution:
        asked.append(gamma)
        begun.set()
        go_on.wait()
        return solve(mdp, gamma)

    answers = ExactAnswers(STUDENT, ready.set, slowly, at_once_states=0)
    assert answers.answer(0.5) == PENDING
    begun.wait()
    assert answers.answer(0.5) == PENDING
    worker = next(thread for thread in threading.enumerate() if thread.name == "exact answers")
    go_on.set()
    ready.wait()
    worker.join()
    assert asked == [0.5]
    assert answers.answer(0.5).solution is not None


def test_the_answers_of_two_worlds_in_turn_are_worked_out_once() -> None:
    answers, worlds = RunAnswers(nobody), [replace(STUDENT, time_limit=limit) for limit in (50, 60)]
    first = [answers.at(world, 0.9).solution for world in worlds]
    assert None not in first
    assert [answers.at(world, 0.9).solution for world in worlds] == first
    for limit in (70, 80, 90, 100):
        answers.at(replace(STUDENT, time_limit=limit), 0.9)
    assert answers.at(worlds[0], 0.9).solution is not first[0], "a world left long ago is forgotten"


def test_of_many_worlds_that_follow_one_another_the_newest_is_worked_out_next(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    begun, go_on, ready = threading.Event(), threading.Event(), threading.Semaphore(0)
    solved: list[int] = []

    def slowly(mdp: TabularMDP, gamma: float, near: FloatArray | None) -> Solution:
        solved.append(worlds.index(mdp))
        begun.set()
        go_on.wait()
        return solve(STUDENT, gamma)

    monkeypatch.setattr("rl_tui.agents.exact.solve.solve", slowly)
    monkeypatch.setattr("rl_tui.agents.exact.solve.greedy_return", lambda mdp, solution: 0.0)
    answers = RunAnswers(lambda: ready.release())
    worlds = [replace(STUDENT, time_limit=1_000_000 - each) for each in range(7)]
    assert answers.at(worlds[0], 0.9) == PENDING
    begun.wait()
    for world in worlds[1:]:
        assert answers.at(world, 0.9) == PENDING
    go_on.set()
    for _ in range(2 * 5):  # each solution, and then its return
        ready.acquire()
    assert solved == [0, 6, 5, 4, 3], "one at a time, and what was left long ago never"
    assert answers.at(worlds[6], 0.9).solution is not None


def test_an_unexpected_failure_is_raised_when_asked_again() -> None:
    ready = threading.Event()

    def failing(mdp: TabularMDP, gamma: float) -> Solution:
        raise ZeroDivisionError

    answers = ExactAnswers(STUDENT, ready.set, failing, at_once_states=0)
    assert answers.answer(0.9) == PENDING
    ready.wait()
    with pytest.raises(ZeroDivisionError):
        answers.answer(0.9)


def test_huge_worlds_are_refused_in_words(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exact_answers, "LIVE_STATES", 3)
    assert "rl-tui solve" in ExactAnswers(STUDENT, nobody).answer(0.9).refused


def test_answers_are_kept_within_bounds() -> None:
    asked: list[float] = []

    def counted(mdp: TabularMDP, gamma: float) -> Solution:
        asked.append(gamma)
        return solve(mdp, 0.5)

    answers = ExactAnswers(STUDENT, nobody, counted)
    for index in range(exact_answers.KEPT + 1):
        answers.answer(index / 1000)
    answers.answer(0.0)
    assert asked.count(0.0) == 2


def test_runs_side_by_side_in_two_worlds_have_each_its_answer_worked_out_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    solved = []

    def counting(mdp: TabularMDP, gamma: float, near: FloatArray | None) -> Solution:
        solved.append(mdp)
        return solve(mdp, gamma, near)

    monkeypatch.setattr("rl_tui.agents.exact.solve.solve", counting)
    playback = begin_playing(recipe("frozenlake"))
    do(playback, Train(20), DrawWorld(read_edits("world.cell[1,1]=.")), Train(5), GoTo(10))
    do(playback, DrawWorld(read_edits("world.cell[0,1]=H")), AddBranch(0))
    before = len(solved)
    shown = do(playback, Train(20), Step(), Step(), ChooseLane(1), Step())
    assert shown.world is not shown.beside.world
    assert shown.exact_answer.solution is not shown.beside.exact_answer.solution
    assert len(solved) - before <= 1, "in a branch that goes on into its own change"


@pytest.fixture
def nears(monkeypatch: pytest.MonkeyPatch) -> list[FloatArray | None]:
    nears: list[FloatArray | None] = []

    def noting(mdp: TabularMDP, gamma: float, near: FloatArray | None) -> Solution:
        nears.append(near)
        return solve(mdp, gamma, near)

    monkeypatch.setattr("rl_tui.agents.exact.solve.solve", noting)
    return nears


def test_the_answer_of_an_edited_world_is_sought_near_the_one_before(
    nears: list[FloatArray | None], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(exact_answers, "AT_ONCE_STATES", 1_000)
    answers, run = RunAnswers(nobody), Run(large_map())
    before = answers.of(run).solution
    assert nears == [None]
    for change in (edit("rows=+1@3"), edit("cell[12,6]=#;cell[5,5]=H"), edit("noise=0.1;columns=-1@4")):
        assert before is not None
        edited = run.edited
        run.apply(change)
        mdp = run.world.mdp
        assert mdp is not None
        found = answers.of(run).solution
        near, carried = nears[-1], run.edited.carried_from(edited, run.recipe).states
        assert near.tolist() == [0.0 if old == NEW else before.v[old] for old in carried]
        alone = solve(mdp, found.gamma)
        assert found.v == pytest.approx(alone.v, abs=1e-9)
        assert found.greedy.tolist() == alone.greedy.tolist()
        before = found


def test_of_another_seed_nothing_is_taken_over(nears: list[FloatArray | None]) -> None:
    answers, first = RunAnswers(nobody), small_map()
    answers.of(Run(first))
    other = Run(replace(first, seed=first.seed + 1))
    other.apply(edit("cell[1,1]=#"))
    assert answers.of(other).solution is not None
    assert nears == [None, None]
