"""t y explains why nothing is learned."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import pytest
from click.testing import CliRunner
from conftest import MakeApp
from drawn_curves import NARROW, NO_MARKS, drawn, flat
from samples import lake
from seams import choose, click, notes, on_screen, playground, press, screen_text, snapshot
from textual.widgets import OptionList

from rl_tui.commands.main import program
from rl_tui.runs.answers.first_update_words import episodes_in_words
from rl_tui.runs.answers.view import FirstUpdateView
from rl_tui.screen.dialogs.why import Why, remedies_of, said, written
from rl_tui.screen.panels.curve.text import NOTHING_LEARNED
from rl_tui.screen.theme.glyphs import UNICODE

EPISODES = ("e",) * 11


def command(*args: str) -> Any:
    return json.loads(CliRunner().invoke(program, ["why", *args, "--json"]).stdout)


def unbroken(text: str) -> str:
    return " ".join(text.replace("│", " ").split())


def figures(wait: dict[str, Any]) -> list[str]:
    shown = written(wait["chance"], UNICODE), episodes_in_words(wait["mean_episodes"])
    return [*shown, f"{wait['median_episodes']:,}"]


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (1.0, "1"),
        (0.99999, ">.999"),
        (0.1, ".1"),
        (0.0139398, ".0139"),
        (5.41665e-6, "5.42e-6"),
        (-2.0, "−2"),
    ],
)
def test_numbers_are_written_as_elsewhere_on_screen(number: float, text: str) -> None:
    assert written(number, UNICODE) == text


async def test_the_curve_and_the_dialog_tell_it_and_a_remedy_is_applied(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), notifications=True) as pilot:
        await press(pilot, "a", "t", *EPISODES)
        assert "explains why" in screen_text(pilot.app)
        await press(pilot, "t", "y")
        assert isinstance(pilot.app.screen, Why)
        text, found = screen_text(pilot.app), command("frozenlake", "--ties", "first")
        assert "No estimate has changed in 11 episodes" in text
        assert "ties = first" in text
        for figure in figures(found["first_update"]):
            assert figure in unbroken(text)
        for place, remedy in enumerate(found["remedies"]):
            option = pilot.app.screen.query_one(OptionList).get_option_at_index(place)
            assert option.id == remedy["setting"]
            assert str(option.prompt).split()[-3:] == figures(remedy)
        await choose(pilot, "ties")
        now = snapshot(pilot)
        assert now.agent.hyperparameters.ties == "random"
        assert now.counters.episodes == 11
        assert not isinstance(pilot.app.screen, Why)


async def test_an_optimistic_start_begins_again_and_then_it_is_over(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), notifications=True) as pilot:
        await press(pilot, "s", "t", "y")
        text = screen_text(pilot.app)
        assert "No estimate has changed" in text
        assert "6 steps away" in unbroken(text)
        await press(pilot, "down", "up", "enter")
        now = snapshot(pilot)
        assert (now.agent.hyperparameters.initial_q, now.counters.step) == (1.0, 0)
        await press(pilot, "t", "y")
        assert "No obstacle" in screen_text(pilot.app)
        assert "enter: change" not in screen_text(pilot.app)
        await press(pilot, "enter", "Y")
        assert not isinstance(pilot.app.screen, Why)
        await press(pilot, "e", "t", "y")
        assert "The agent has begun to learn" in screen_text(pilot.app)
        await press(pilot, "escape")
        assert snapshot(pilot).answers.first_update is None
        assert playground(pilot).recipe.hyperparameters.initial_q == 1.0
        assert notes(pilot.app) == []


@pytest.mark.parametrize(
    ("scenario", "reason"), [("discount", "plans with the model"), ("blackjack", "no transition table")]
)
async def test_what_cannot_be_told_is_said_with_the_reason(
    make_app: MakeApp, scenario: str, reason: str
) -> None:
    async with on_screen(make_app(scenario), (60, 20)) as pilot:
        await press(pilot, "t", "y")
        assert reason in unbroken(screen_text(pilot.app))
        await press(pilot, "q")
        assert not isinstance(pilot.app.screen, Why)


async def test_a_bandit_keeps_its_secret_until_it_is_revealed(make_app: MakeApp) -> None:
    async with on_screen(make_app("bandit-bernoulli")) as pilot:
        await press(pilot, "t", "y")
        assert "it would reveal the arms" in screen_text(pilot.app)
        assert "chance" not in screen_text(pilot.app)
        await press(pilot, "Y", "w", "h", "t", "y")
        assert "has probability" in screen_text(pilot.app)
        await press(pilot, "Y", "w", "h", *["s"] * 20, "t", "y")
        text = screen_text(pilot.app)
        assert "The agent has begun to learn: an estimate has changed." in text
        assert "reveal" not in text
        assert "chance" not in text


async def test_the_mouse_closes_it_ascii_is_enough_and_what_is_known_is_said(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake", ascii=True)) as pilot:
        await press(pilot, "a", "t", "t", "y")
        assert isinstance(pilot.app.screen, Why)
        assert screen_text(pilot.app).isascii()
        known = snapshot(pilot)
        box = pilot.app.screen.query_one("#box")
        row = box.region.bottom - 1
        column = screen_text(pilot.app).splitlines()[row].index("esc: close")
        await click(pilot, offset=(column, row))
        assert not isinstance(pilot.app.screen, Why)
        await pilot.app.push_screen(Why(playground(pilot).look, known))
        await pilot.pause()
        assert "184,616" in screen_text(pilot.app)  # the result known at its opening, even without later news


def test_the_curve_tells_that_no_estimate_has_moved() -> None:
    barren = lake(curve=flat(0.0), marks=NO_MARKS, episodes=1_234, greedy_return=0.0, return_last_100=0.0)
    stuck = replace(barren.answers, first_update=FirstUpdateView(None, "no table", False, True))
    shown = replace(barren, answers=stuck)
    assert f"{NOTHING_LEARNED} after 1,234 episodes; t y explains why" in drawn(shown, (80, 13))[0]
    assert "t y explains" in drawn(shown, NARROW)[0]
    assert remedies_of(shown) == ()
    assert said(shown, UNICODE)[-2:] == ["The wait is unknown.", "No table."]
