"""The flips of a world during a run."""

from __future__ import annotations

import json
import pickle
import subprocess
import threading
from collections.abc import Iterator
from typing import Final

import numpy as np
import pytest
from click.testing import CliRunner
from playing import begin, do
from recipes import recipe

from rl_tui.agents.exact.flips import flips
from rl_tui.agents.exact.policy_evaluation import NoExactAnswer
from rl_tui.agents.exact.solve import solve
from rl_tui.commands.main import program
from rl_tui.commands.reports.flip_points import flips_document
from rl_tui.live.commands import AskFlips
from rl_tui.runs.answers import flip_answers
from rl_tui.runs.answers.flip_answer import FlipAnswer, FlipState, beyond, optimal_value_curves, worked_out
from rl_tui.runs.answers.flip_answers import FlipAnswers, at_once
from rl_tui.runs.background import background
from rl_tui.runs.recipe import begin as begin_run
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp

LONGEST: Final = 60.0  # seconds for a process to answer
WORLDS: Final = ("student", "frozenlake-slippery", "discount")


def table(scenario: str) -> TabularMDP:
    mdp = begin_run(recipe(scenario)).world.mdp
    assert mdp is not None
    return mdp


@pytest.fixture(scope="module")
def known() -> dict[str, tuple[TabularMDP, FlipAnswer]]:
    return {name: (mdp, worked_out(mdp)) for name, mdp in ((name, table(name)) for name in WORLDS)}


@pytest.mark.parametrize("scenario", WORLDS)
def test_a_snapshot_tells_what_the_command_prints(scenario: str) -> None:
    playback = begin(recipe(scenario))
    assert playback.snapshot().answers.flips.state is FlipState.NOT_ASKED
    snapshot = do(playback, AskFlips())
    told = flips_document(snapshot.world.space, snapshot.answers.flips.flips)
    printed = CliRunner().invoke(program, ["solve", scenario, "--flips", "--json"])
    assert told == json.loads(printed.stdout)["flips"]
    assert told


def test_q_by_gamma_is_what_solve_finds(known: dict[str, tuple[TabularMDP, FlipAnswer]]) -> None:
    for mdp, answer in known.values():
        curves = answer.curves
        assert (curves.gamma[0], curves.gamma[-1]) == (0.0, 1.0)
        for place in (0, 57, 181, 200):
            exact = solve(mdp, float(curves.gamma[place]))
            assert np.abs(curves.q[place] - exact.q).max() < 1e-9


def test_q_by_gamma_ends_before_1_where_1_has_no_answer() -> None:
    for_ever = tabular_mdp(("loop",), ("stay",), [Transition(0, 0, (Outcome(1.0, 0, 1.0, False),))], {0: 1.0})
    curves = optimal_value_curves(for_ever)
    assert curves.gamma[-1] == 0.995
    assert curves.q[-1, 0] == pytest.approx(200.0)


def test_of_very_many_actions_q_by_gamma_still_fits_into_a_message() -> None:
    pairs = 6_000
    one = [Transition(0, pair, (Outcome(1.0, 1, float(pair), True),)) for pair in range(pairs)]
    curves = optimal_value_curves(
        tabular_mdp(("s", "end"), [str(pair) for pair in range(pairs)], one, {0: 1.0})
    )
    assert curves.q.shape == (51, pairs)
    answer = FlipAnswer(FlipState.KNOWN, curves=curves)
    assert len(pickle.dumps(answer)) < background.LONGEST


def test_beyond_a_flip_its_other_actions_are_best(known: dict[str, tuple[TabularMDP, FlipAnswer]]) -> None:
    for mdp, answer in known.values():
        for flip in answer.flips:
            for is_above in (False, True):
                gamma = beyond(answer, flip, is_above=is_above)
                assert (gamma > flip.gamma) is is_above
                best = solve(mdp, gamma).best
                for turn in flip.turns:
                    there = tuple(pair for pair in mdp.pairs_of(turn.state) if best[pair])
                    assert there == (turn.after if is_above else turn.before)


def test_beyond_a_flip_is_a_round_number(known: dict[str, tuple[TabularMDP, FlipAnswer]]) -> None:
    _, lake = known["frozenlake-slippery"]
    _, student = known["student"]
    assert [beyond(lake, flip, is_above=True) for flip in lake.flips] == [0.81, 0.98]
    assert [beyond(lake, flip, is_above=False) for flip in lake.flips] == [0.8, 0.97]
    assert [beyond(student, student.flips[0], is_above=each) for each in (False, True)] == [0.24, 0.26]


def test_where_there_is_nothing_to_work_out_that_is_known_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    bandit = at_once(table("bandit"))
    assert bandit.is_idle
    assert bandit.flips == ()
    large = at_once(table("taxi"))
    assert large.state is FlipState.REFUSED
    with pytest.raises(NoExactAnswer) as refusal:
        flips(table("taxi"))
    assert large.reason == str(refusal.value)
    assert "400" in large.reason
    assert at_once(table("student")) is None
    monkeypatch.setattr(flip_answers, "in_kiosk", lambda: True)
    in_kiosk = at_once(table("student"))
    assert in_kiosk.state is FlipState.REFUSED


def test_without_a_table_there_are_none() -> None:
    answers = FlipAnswers(lambda: None, automatic=False)
    answers.begin(None)
    assert answers.of(None).state is FlipState.REFUSED


# In its own process


class Beside:
    def __init__(self, processes: list[subprocess.Popen[bytes]]) -> None:
        self.processes = processes
        self.has_news = threading.Event()
        self.answers = FlipAnswers(self.has_news.set, automatic=True)

    def work_out(self, mdp: TabularMDP) -> FlipAnswer:
        self.has_news.clear()
        self.answers.begin(mdp)
        while self.answers.of(mdp).state is FlipState.PENDING:
            assert self.has_news.wait(LONGEST)
            self.has_news.clear()
        return self.answers.of(mdp)


@pytest.fixture
def beside(processes: list[subprocess.Popen[bytes]]) -> Iterator[Beside]:
    made = Beside(processes)
    yield made
    made.answers.close()


@pytest.mark.process
def test_a_player_that_goes_on_by_itself_has_it_worked_out_beside(beside: Beside) -> None:
    student, lake = table("student"), table("frozenlake-slippery")
    told, expected = beside.work_out(student), worked_out(student)
    assert (told.reason, told.flips) == ("", expected.flips)
    assert np.array_equal(told.curves.q, expected.curves.q)
    assert np.array_equal(told.curves.gamma, expected.curves.gamma)
    assert beside.answers.of(lake).state is FlipState.NOT_ASKED
    assert len(beside.work_out(lake).flips) == 2
    assert beside.answers.of(student).state is FlipState.KNOWN, "what was worked out is kept"
    beside.answers.begin(student)
    assert len(beside.processes) == 2


@pytest.mark.process
def test_its_process_ends_when_it_is_closed(beside: Beside) -> None:
    mdp = table("frozenlake-8x8-slippery")
    beside.answers.begin(mdp)
    assert beside.answers.of(mdp).state is FlipState.PENDING
    beside.answers.close()
    assert beside.has_news.wait(LONGEST)
    assert beside.answers.of(mdp).state is FlipState.REFUSED
    assert beside.processes[0].poll() is not None
    beside.answers.begin(table("student"))
    assert len(beside.processes) == 1


@pytest.mark.process
def test_where_no_process_can_be_started_the_reason_is_told(
    beside: Beside, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object) -> None:
        raise OSError("none left")

    monkeypatch.setattr(background, "python_process", fails)
    mdp = table("student")
    beside.answers.begin(mdp)
    assert beside.answers.of(mdp).state is FlipState.REFUSED
    assert "none left" in beside.answers.of(mdp).reason
