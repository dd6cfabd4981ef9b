from __future__ import annotations

from pathlib import Path

import pytest
from conftest import MakeApp
from drawn_text import rows_of, words_of
from seams import notes
from textual.pilot import Pilot
from textual.widgets import OptionList

from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.tui.app.screenshot import settle
from rl_tui.tui.screens.catalogue.catalogue import CatalogueScreen
from rl_tui.tui.screens.catalogue.facts import defaults, sizes
from rl_tui.tui.screens.help import HelpScreen
from rl_tui.tui.screens.playground.playground import Playground
from rl_tui.worlds.files.catalogue import find, shipped_folder
from rl_tui.worlds.files.catalogue import scenarios as shipped

FAULTY = """
title = "Nothing to do"
[mdp]
start = "Here"
colour = "red"
"""


def scenarios(pilot: Pilot[UserError]) -> OptionList:
    return pilot.app.screen.query_one("#scenarios", OptionList)


async def go_to(pilot: Pilot[UserError], scenario: str) -> None:
    listed = scenarios(pilot)
    listed.highlighted = listed.get_option_index(scenario)
    await settle(pilot)


def facts(pilot: Pilot[UserError]) -> str:
    return "\n".join(rows_of(pilot.app.screen.query_one("#facts")))


async def test_it_lists_the_shipped_scenarios_in_teaching_order(make_app: MakeApp) -> None:
    async with make_app().run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        listed = scenarios(pilot)
        ids = [listed.get_option_at_index(number).id for number in range(listed.option_count)]
        assert ids == [scenario.id for scenario in shipped()]
        assert ids[0] == "bandit"
        assert ids.index("student") < ids.index("frozenlake") < ids.index("frozenlake-slippery")


async def test_arrows_show_the_details_of_each(make_app: MakeApp) -> None:
    async with make_app().run_test(size=(120, 40)) as pilot:
        await settle(pilot)
        assert "10 arms" in facts(pilot) or "10 actions" in facts(pilot)
        await go_to(pilot, "frozenlake")
        assert "16 states" in facts(pilot)
        assert "44 pairs" in facts(pilot)


async def test_enter_opens_and_escape_comes_back_to_the_same_entry(make_app: MakeApp) -> None:
    app = make_app()
    async with app.run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        await go_to(pilot, "student")
        await pilot.press("enter")
        await settle(pilot)
        screen = app.screen
        assert isinstance(screen, Playground)
        assert screen.snapshot
        assert screen.snapshot.recipe.scenario.id == "student"
        await pilot.press("escape")
        await settle(pilot)
        assert isinstance(app.screen, CatalogueScreen)
        highlighted = scenarios(pilot).highlighted_option
        assert highlighted
        assert highlighted.id == "student"


async def test_a_faulty_file_is_listed_with_its_faults(
    make_app: MakeApp, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "mine.toml").write_text(FAULTY)
    monkeypatch.setattr("rl_tui.worlds.files.catalogue.user_folder", lambda: tmp_path)
    app = make_app()
    async with app.run_test(size=(120, 40), notifications=True) as pilot:
        await settle(pilot)
        await pilot.press("end")
        await settle(pilot)
        assert "colour" in facts(pilot)
        await pilot.press("enter")
        await settle(pilot)
        assert isinstance(app.screen, CatalogueScreen)
        assert "this file has faults; mend them first" in notes(app)


async def test_a_file_whose_defaults_are_out_of_range_counts_as_faulty(
    make_app: MakeApp, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sound = (shipped_folder() / "student.toml").read_text(encoding="utf-8")
    (tmp_path / "mine.toml").write_text(sound.replace("gamma = 0.9", "gamma = 1.9"), encoding="utf-8")
    monkeypatch.setattr("rl_tui.worlds.files.catalogue.user_folder", lambda: tmp_path)
    async with make_app().run_test(size=(120, 40)) as pilot:
        await settle(pilot)
        await pilot.press("end")
        await settle(pilot)
        assert "defaults.gamma: found 1.9" in words_of(pilot.app.screen.query_one("#facts"))


async def test_help_opens(make_app: MakeApp) -> None:
    app = make_app()
    async with app.run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        await pilot.press("question_mark")
        assert isinstance(app.screen, HelpScreen)
        await pilot.press("question_mark")
        assert isinstance(app.screen, CatalogueScreen)


def test_sizes_are_loading_until_the_world_is_built() -> None:
    assert sizes(None) == "loading …"
    assert sizes(UserError("no such environment")) == "unknown: no such environment"
    student = find("student").build(streams(0).world)
    assert sizes(student) == "4 states · 5 actions · 5 pairs · time limit 100"
    assert "budget 1,000" in sizes(find("bandit").build(streams(0).world))


def test_defaults_use_the_symbols_of_the_playground() -> None:
    values = {"algorithm": "q-learning", "alpha": 0.1, "episodes": 10_000, "ties": "first"}
    assert defaults(values) == "Q-learning · α 0.1 · 10,000 episodes · ties first"
    assert defaults({"episodes": 1}) == "1 episode"
    assert defaults({"gamma": 0.0, "alpha": "sample-average"}) == "γ 0 · α sample-average"


async def test_a_default_is_never_parted_from_its_symbol(make_app: MakeApp) -> None:
    async with make_app().run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        assert "γ 0 · ε 0.1" in facts(pilot)
        assert all(line.strip()[:1] not in ("·", "-") for line in facts(pilot).splitlines())


async def test_in_ascii_no_dot_between_parts_looks_like_a_product(make_app: MakeApp) -> None:
    async with make_app(ascii=True).run_test(size=(120, 40)) as pilot:
        await settle(pilot)
        assert "1 state - 10 actions - 10 pairs - budget 1,000" in facts(pilot)
