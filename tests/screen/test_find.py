"""The matches of a query."""

from __future__ import annotations

import pytest
from conftest import MakeApp
from seams import on_screen, playground, press, snapshot
from textual.pilot import Pilot
from textual.widgets import OptionList, Static

from rl_tui.common.errors import UserError
from rl_tui.screen.app.find import NOTHING, Findable, FindScreen, found_by, relevance
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.frame.glossary import GlossaryScreen
from rl_tui.screen.keys.registry import ACTIONS
from rl_tui.screen.playground.playground import Playground


def entry(name: str, *, keys: str = "", also: str = "", sentence: str = "") -> Findable:
    return Findable(name, "action", sentence, lambda: None, keys, also)


@pytest.mark.parametrize(
    ("query", "is_found"),
    [
        ("policies", True),
        ("POL", True),
        ("licies", True),
        ("t p", True),
        ("exact compare", True),
        ("worth", True),
        ("compare xyz", False),
        ("olp", False),
    ],
)
def test_each_word_begins_a_word_or_is_in_the_name(query: str, is_found: bool) -> None:
    policies = entry("Policies", keys="t p", also="worth", sentence="Compare policies by their exact return.")
    assert (relevance(query, policies) > 0.0) is is_found


def test_an_exact_word_comes_before_a_beginning_before_other_words_before_the_sentence() -> None:
    ranked = [
        entry("Step"),
        entry("Steps per episode"),
        entry("A stepwise way"),
        entry("Back", also="step"),
        entry("Run", sentence="Take a step."),
    ]
    assert found_by("step", ranked[::-1]) == ranked
    step, word = [entry("Step")], entry("step")._replace(kind="word")
    assert found_by(" ", [*step, word]) == step


def test_signs_are_found_as_they_are_typed() -> None:
    assert relevance("8x8", entry("FrozenLake 8×8")) > 0.0
    assert relevance("-", entry("−")) > 0.0


@pytest.mark.parametrize(
    ("id_", "words"),
    [
        ("help", "help manual shortcuts"),
        ("back", "close environment lesson load sessions tutorial"),
        ("run.run_or_pause", "continue pause resume train"),
        ("run.slower", "speed"),
        ("until.choose", "skip"),
        ("time.show_branches", "history log redo undo"),
        ("view.next_layer", "error"),
        ("view.zoom", "fullscreen"),
        ("view.hide_answer", "cheat solution"),
        ("agent.show_options", "config options preferences"),
        ("until.toggle_breakpoint", "debug"),
        ("export.choose", "chart code copy csv image plot python screenshot share svg"),
        ("panels.turn", "layout"),
        ("run.reset", "new reset restart"),
    ],
)
def test_words_of_other_programs_lead_to_an_action(id_: str, words: str) -> None:
    action = next(each for each in ACTIONS if each.id == id_)
    sought = entry(action.label, also=action.aliases, sentence=action.help)
    assert [word for word in words.split() if not relevance(word, sought)] == []


async def names(pilot: Pilot[UserError]) -> list[str]:
    await settle(pilot)
    screen = pilot.app.screen
    assert isinstance(screen, FindScreen)
    return [str(each.prompt) for each in screen.query_one(OptionList).options]


async def test_all_actions_are_listed_first_and_anything_is_found(make_app: MakeApp) -> None:
    async with on_screen(make_app("student")) as pilot:
        await press(pilot, "slash")
        listed = await names(pilot)
        actions = [each for each in playground(pilot).actions if each.id != "find"]
        assert len(listed) == len(actions)
        assert all(each.shown in line for each, line in zip(actions, listed, strict=True))
        for query, kind in (
            ("epsilon", "setting"),
            ("bellman", "word"),
            ("8x8", "world"),
            ("bandits", "lesson"),
        ):
            await press(pilot, *query)
            assert any(line.rstrip().endswith(kind) for line in await names(pilot)), query
            await press(pilot, *["backspace"] * len(query))
        await press(pilot, *"xyzzy")
        assert await names(pilot) == []
        assert str(pilot.app.screen.query_one("FindScreen Static", Static).render()) == NOTHING


async def test_what_files_add_does_not_move_the_cursor_and_what_cannot_be_done_says_why_and_stays(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("student")) as pilot:
        await press(pilot, "slash", *"step", "down", "down")
        screen = pilot.app.screen
        assert isinstance(screen, FindScreen)
        rows = screen.query_one(OptionList)
        here = str(rows.options[rows.highlighted or 0].prompt)
        screen.list_matches("step", keeps_cursor=True)
        assert str(rows.options[rows.highlighted or 0].prompt) == here
        await press(pilot, "escape", "slash", *"next run", "enter")
        assert isinstance(pilot.app.screen, FindScreen)
        assert "Not here" in str(pilot.app.screen.query_one("FindScreen Static", Static).render())


async def test_enter_sets_a_setting_acts_explains_a_word_and_opens_a_world(make_app: MakeApp) -> None:
    async with on_screen(make_app("student")) as pilot:
        await press(pilot, "ctrl+p", *"epsilon", "space", "full_stop", "3", "enter")
        await settle(pilot)
        assert isinstance(pilot.app.screen, Playground)
        assert snapshot(pilot).agent.hyperparameters.epsilon == 0.3
        await press(pilot, "slash", *"next seed", "enter")
        await settle(pilot)
        assert snapshot(pilot).recipe.seed == 1
        await press(pilot, "slash", *"bellman", "enter")
        assert isinstance(pilot.app.screen, GlossaryScreen)
        await press(pilot, "escape", "slash", *"8x8")
        await names(pilot)
        await press(pilot, "enter")
        await settle(pilot)
        assert playground(pilot).recipe.scenario.id.startswith("frozenlake-8x8")
