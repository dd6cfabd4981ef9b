"""Exact values are hidden as the scenario says."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from playing import begin, do
from recipes import recipe

from rl_tui.live.commands import AddLane, HideAnswer, Restart, Step
from rl_tui.live.playback import Playback
from rl_tui.live.record import Record
from rl_tui.runs.recipe import SetParameter
from rl_tui.runs.timeline.branches import FIRST, RunRecord
from rl_tui.worlds.files.scenario import scenario_of

BANDIT = "[bandit]\narms = 3\n"
GRID = '[grid]\nmap = "S.G"\n'


@pytest.mark.parametrize(
    ("text", "hidden"),
    [
        (BANDIT, True),
        (GRID, False),
        (f'answer = "shown"\n{BANDIT}', False),
        (f'answer = "hidden"\n{GRID}', True),
        (f'answer = "hidden"\n{BANDIT}', True),
        (f'answer = "shown"\n{GRID}', False),
    ],
)
def test_a_bandit_hides_its_answer_and_others_show_it_unless_the_file_says_otherwise(
    text: str, hidden: bool
) -> None:
    assert scenario_of(text, Path("mine.toml")).hides_answer is hidden


@pytest.mark.parametrize(("scenario", "hidden"), [("student", True), ("frozenlake", False), ("bandit", True)])
def test_it_is_hidden_from_the_first_picture_on(scenario: str, hidden: bool) -> None:
    made = Playback(recipe(scenario), speed=None, automatic=False, clock=lambda: 0.0, on_exact=lambda: None)
    made.work()
    assert made.snapshot().answers.is_hidden is hidden
    while made.on_the_way:
        made.work()
    assert made.snapshot().answers.is_hidden is hidden


def test_a_person_decides_for_all_lanes() -> None:
    playback = begin(recipe("frozenlake"))
    do(playback, AddLane((SetParameter("alpha", 0.5),)))
    hidden = do(playback, HideAnswer(is_hidden=True))
    assert hidden.answers.is_hidden
    assert hidden.beside.answers.is_hidden
    assert not do(playback, Step(), HideAnswer(is_hidden=False)).answers.is_hidden


def test_it_is_worth_keeping_and_comes_back() -> None:
    playback = begin(recipe("student"))
    assert playback.record.answer_is_hidden is None
    assert not playback.touched
    do(playback, HideAnswer(is_hidden=False))
    assert playback.touched
    assert playback.record.answer_is_hidden is False
    kept = Record((RunRecord(recipe("student"), (FIRST,)),), answer_is_hidden=False)
    assert not begin(recipe("student"), kept).snapshot().answers.is_hidden


def test_a_restart_in_the_same_world_keeps_it() -> None:
    student = recipe("student")
    playback = begin(student)
    do(playback, HideAnswer(is_hidden=False))
    assert not do(playback, Restart(replace(student, seed=5))).answers.is_hidden


def test_arms_that_are_drawn_anew_are_hidden_again() -> None:
    playback = begin(recipe("bandit"))
    assert not do(playback, HideAnswer(is_hidden=False)).answers.is_hidden
    assert do(playback, Restart(recipe("bandit", seed=5))).answers.is_hidden


def test_what_a_person_hides_stays_hidden_on_another_map() -> None:
    playback = begin(recipe("frozenlake-random"))
    do(playback, HideAnswer(is_hidden=True))
    assert do(playback, Restart(recipe("frozenlake-random", seed=5))).answers.is_hidden
