"""Settings in the playground: sliders, dialogs, seeds."""

from __future__ import annotations

import asyncio

from conftest import MakeApp
from seams import click, notes, on_screen, playground, press, slider, snapshot, train
from snapshots import changed
from textual.widgets import Input

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.dialogs.form import Form
from rl_tui.screen.frame.key_line import KeyLine
from rl_tui.screen.panels.controls.settings import AgentSettings
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.playground.playground import Playground
from rl_tui.worlds.drawing import CellKind, Grid


def holes_of(shown: Snapshot) -> list[int]:
    assert isinstance(shown.world.drawing, Grid)
    return [cell for cell, kind in enumerate(shown.world.drawing.kinds) if kind is CellKind.HOLE]


async def test_1_2_3_go_to_the_sliders_out_of_a_zoom_or_another_slider_and_letters_do_what_they_say(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("student")) as pilot:
        before = snapshot(pilot).agent.hyperparameters.epsilon
        for key, name in (("1", "alpha"), ("2", "gamma"), ("3", "epsilon")):
            playground(pilot).board.table.focus()
            await press(pilot, "f", key)
            assert pilot.app.focused is slider(pilot.app, name)
            assert playground(pilot).board.zoomed is None
        now = (await press(pilot, "right")).agent.hyperparameters.epsilon
        assert now > before
        assert slider(pilot.app, "epsilon").value == now
        assert (await press(pilot, "left")).agent.hyperparameters.epsilon == before
        assert snapshot(pilot).counters.step == 0
        typed = await press(pilot, "enter", "1", "enter")
        assert typed.agent.hyperparameters.epsilon == 1.0
        for key, name in (("2", "gamma"), ("3", "epsilon"), ("1", "alpha"), ("3", "epsilon")):
            await press(pilot, key)
            assert pilot.app.focused is slider(pilot.app, name)
        values = (await press(pilot, *"0.4", "s")).agent.hyperparameters
        assert (values.gamma, values.epsilon) == (0.9, 0.4)
        assert snapshot(pilot).counters.step == 1
        assert snapshot(pilot).timeline.current.journal[0].step == 0
        assert (await press(pilot, "b", "s")).counters.step == 1
        assert snapshot(pilot).agent.hyperparameters.epsilon == 0.4


async def test_a_value_or_a_slider_that_is_none_is_told_and_enter_and_escape_give_the_focus_back(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("student"), notifications=True) as pilot:
        await press(pilot, "3", "enter", *"30.4", "tab")
        assert pilot.app.focused is slider(pilot.app, "epsilon")
        assert notes(pilot.app) == ["ε stays 0.1: type a number from 0 to 1, not '30.4'"]
        await press(pilot, "1")
        assert pilot.app.focused is slider(pilot.app, "alpha")
        assert notes(pilot.app) == []
        await press(pilot, "3", "4")
        assert pilot.app.focused is slider(pilot.app, "epsilon")
        assert notes(pilot.app) == ["There is no fourth slider here."]
        await press(pilot, "escape")
        for ties in ("first", "random"):
            assert (await press(pilot, "a", "t")).agent.hyperparameters.ties == ties
            assert [ties in note for note in notes(pilot.app)] == [True]
        await press(pilot, "s", "2", "escape")
        assert pilot.app.focused is None
        assert notes(pilot.app) == []
        await press(pilot, "tab")
        before = pilot.app.focused
        assert before is not None
        await press(pilot, "2", "3", "escape")
        assert pilot.app.focused is before
        await press(pilot, "3", "0", "enter")
        assert pilot.app.focused is before
        assert notes(pilot.app) == []
        assert isinstance(pilot.app.screen, Playground)


async def test_while_a_person_acts_digits_act_but_on_a_slider_they_are_typed(make_app: MakeApp) -> None:
    async with on_screen(make_app("student")) as pilot:
        slider(pilot.app, "epsilon").focus()
        await press(pilot, "y")
        assert (await press(pilot, "1")).counters.step == 1
        slider(pilot.app, "epsilon").focus()
        typed = await press(pilot, "enter", "1", "enter")
        assert (typed.counters.step, typed.agent.hyperparameters.epsilon) == (1, 1.0)
        assert (await press(pilot, "1")).counters.step == 2


async def test_the_key_line_says_what_space_does_now_and_can_be_clicked(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), (120, 40)) as pilot:
        line = pilot.app.screen.query_one(KeyLine)
        paused = line.render_line(0).text
        await press(pilot, "space")
        running = line.render_line(0).text
        assert running == paused.replace("run  ", "pause", 1)
        await click(pilot, line, offset=(running.index("pause"), 0))
        assert line.render_line(0).text == paused
        await click(pilot, line, offset=(15, 0))
        assert snapshot(pilot).counters.step == 1
        settings = pilot.app.screen.query_one(AgentSettings)
        rows = [settings.render_line(y).text for y in range(settings.size.height)]
        y = next(place for place, row in enumerate(rows) if "ties" in row)
        await click(pilot, settings, offset=(rows[y].index("ties"), y))
        assert snapshot(pilot).agent.hyperparameters.ties == "first"


async def test_the_key_line_says_what_keys_do_on_a_slider_and_answers_clicks(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), (60, 18)) as pilot:
        line = pilot.app.screen.query_one(KeyLine)
        usual = line.render_line(0).text
        await press(pilot, "2")
        assert line.render_line(0).text.startswith(" γ discount   ← → move   enter type   esc leave")
        await pilot.resize_terminal(80, 24)
        await settle(pilot)
        assert "enter type a number" in line.render_line(0).text
        await pilot.resize_terminal(60, 18)
        await settle(pilot)
        await click(pilot, line, offset=(line.render_line(0).text.index("enter"), 0))
        assert slider(pilot.app, "gamma").is_typing
        assert line.render_line(0).text.startswith(" enter set")
        for width in (60, 80, 120):
            await pilot.resize_terminal(width, 24)
            assert line.render_line(0).text.rstrip().endswith("? keys")
            assert "space run" in line.render_line(0).text
            assert "esc back" not in line.render_line(0).text
        await pilot.resize_terminal(60, 18)
        await press(pilot, "0", "enter")
        assert line.render_line(0).text == usual


async def test_a_value_typed_before_there_is_a_world_is_set_once_there_is(
    make_app: MakeApp, is_typed: asyncio.Event
) -> None:
    app = make_app("student")
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("3", *"0.4", "enter")
        assert playground(pilot).snapshot is None
        is_typed.set()
        await settle(pilot)
        assert snapshot(pilot).agent.hyperparameters.epsilon == 0.4
        assert slider(app, "epsilon").value == 0.4


async def test_what_is_being_typed_outlasts_another_policy_and_a_slider_that_goes_gives_the_focus_back(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("student")) as pilot:
        await press(pilot, "2", "0", "full_stop")
        playground(pilot).agent.set_parameter("policy", "softmax")
        await settle(pilot)
        assert pilot.app.focused is slider(pilot.app, "gamma")
        assert [each.id for each in pilot.app.screen.query(Slider)] == ["alpha", "gamma", "temperature"]
        assert (await press(pilot, "5", "enter")).agent.hyperparameters.gamma == 0.5
        await press(pilot, "3")
        playground(pilot).agent.set_parameter("policy", "epsilon-greedy")
        await settle(pilot)
        assert pilot.app.focused is None


async def test_a_prompt_names_the_range_and_stays_and_initial_q_starts_again(make_app: MakeApp) -> None:
    async with on_screen(make_app("student")) as pilot:
        await train(pilot, 10)
        for letter, wrong, expected in (
            ("s", "", "Type a whole number, 0 or more."),
            ("i", "much", "Type a number from -1e12 to 1e12"),
        ):
            await press(pilot, "r", letter)
            assert isinstance(pilot.app.screen, Form)
            pilot.app.screen.query_one(Input).value = wrong
            await press(pilot, "enter")
            assert isinstance(pilot.app.screen, Form)
            assert expected in str(pilot.app.screen.query_one(".error").render())
            await press(pilot, "escape")
            assert isinstance(pilot.app.screen, Playground)
        assert snapshot(pilot).recipe.seed == 0
        await press(pilot, "r", "i")
        pilot.app.screen.query_one(Input).value = "5"
        again = await press(pilot, "enter")
        assert not isinstance(pilot.app.screen, Form)
        assert again.counters.step == 0
        assert again.agent.q.tolist() == [5.0] * 5


async def test_every_setting_is_drawn_once_whatever_the_height(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), (120, 40)) as pilot:
        settings = pilot.app.screen.query_one(AgentSettings)
        decaying = changed(snapshot(pilot), hyperparameters=Hyperparameters(epsilon_decay=0.1))
        for each, lines in ((snapshot(pilot), 3), (decaying, 3), (decaying, 20)):
            settings.show(each)
            settings.styles.height = lines
            await pilot.pause()
            text = "\n".join(settings.render_line(y).text for y in range(lines))
            for value in ("Q-learning", "random", "seed", "10/s"):
                assert text.count(value) == 1
            assert ("ε now" in text) is (each is decaying)


async def test_a_seed_is_typed_and_shows_its_own_map(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-random"), (120, 40)) as pilot:
        first = snapshot(pilot)
        second = await press(pilot, "r", "s", "4", "2", "enter")
        assert second.recipe.seed == 42
        holes = holes_of(second)
        assert holes != holes_of(first)
        view = playground(pilot).query_one(GridView)
        text = "".join(view.render_line(y).text for y in range(view.size.height))
        assert text.count("▗▄▄▖") == len(holes)
        assert (await press(pilot, "e")).counters.episodes == 1
