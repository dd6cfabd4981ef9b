"""The menus: letters, arrows, enter, the mouse, and refusals."""

from __future__ import annotations

from dataclasses import replace

import pytest
from conftest import MakeApp
from seams import click, notes, on_screen, playground, press, settle, snapshot, train
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.live.commands import Play
from rl_tui.live.snapshot import Phase
from rl_tui.screen.dialogs.form import Choice, Form
from rl_tui.screen.frame.key_sheet import KeySheet
from rl_tui.screen.frame.menu_strip import MenuStrip
from rl_tui.screen.keys.action import MENUS, Action
from rl_tui.screen.playground.actions.lanes import ONE_RUN
from rl_tui.screen.playground.playground import Playground


def strip(pilot: Pilot[UserError]) -> MenuStrip:
    screen = pilot.app.screen
    assert isinstance(screen, MenuStrip)
    return screen


def lines(pilot: Pilot[UserError]) -> list[str]:
    menu = strip(pilot).menu
    return [menu.render_line(y).text for y in range(menu.size.height)]


@pytest.mark.exhaustive("plays at other sizes", but=["60"])
@pytest.mark.parametrize(
    ("size", "ascii_only"), [((120, 40), False), ((80, 24), False), ((60, 18), True)], ids=["120", "80", "60"]
)
async def test_each_row_of_menus_is_whole(make_app: MakeApp, size: tuple[int, int], ascii_only: bool) -> None:
    async with on_screen(make_app("frozenlake", ascii=ascii_only), size) as pilot:
        for key, title in MENUS.items():
            await press(pilot, key)
            drawn = lines(pilot)
            assert drawn[0].split()[1] == title
            rows = [each for each in playground(pilot).actions if each.menu == key]
            for row in rows:
                label = playground(pilot).look.glyphs.spelled(row.label)
                assert any(f"{row.letter} {label}" in line for line in drawn), row.id
            assert strip(pilot).menu.region.bottom == size[1]
            await press(pilot, "escape")
            assert isinstance(pilot.app.screen, Playground)


async def test_letters_enter_and_the_mouse_act_at_once(make_app: MakeApp) -> None:
    async with on_screen(make_app("student")) as pilot:
        await press(pilot, "r", "n")
        assert snapshot(pilot).recipe.seed == 1
        await press(pilot, "r", "down", "enter")
        assert snapshot(pilot).recipe.seed == 2
        await press(pilot, "r", "j", "k", "right", "left", "end", "home", "down", "enter")
        assert snapshot(pilot).recipe.seed == 3
        await press(pilot, "r", "s")
        assert isinstance(pilot.app.screen, Form)
        await press(pilot, "escape", "a", "enter")
        assert isinstance(pilot.app.screen, Choice)
        await press(pilot, "escape", "r")
        place = lines(pilot)[2].index("next seed")
        await click(pilot, strip(pilot).menu, offset=(place, 2))
        assert snapshot(pilot).recipe.seed == 4
        await press(pilot, "r")
        await click(pilot, offset=(3, 3))
        assert isinstance(pilot.app.screen, Playground), "a click beside the rows closes it"
        assert snapshot(pilot).recipe.seed == 4


async def test_what_cannot_be_done_now_says_why_and_a_key_of_no_row_says_so(make_app: MakeApp) -> None:
    async with on_screen(make_app("student")) as pilot:
        await press(pilot, "c", "l")
        assert ONE_RUN in lines(pilot)[-1]
        for key, name in (("Z", "Z"), ("backspace", "backspace"), ("full_stop", ".")):
            await press(pilot, key)
            assert lines(pilot)[-1].strip() == f"{name}: no row here."
        await press(pilot, "down", "up")
        assert ONE_RUN in lines(pilot)[-1]
        await press(pilot, "q")
        assert isinstance(pilot.app.screen, Playground)
        await press(pilot, "c", "question_mark")
        assert isinstance(pilot.app.screen, KeySheet)


async def test_rows_show_values_while_the_run_goes_on_and_escape_ends_no_mode(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake")) as pilot:
        await press(pilot, "y", "t", "escape")
        assert playground(pilot).modes.current is playground(pilot).manual
        await press(pilot, "y")
        await press(pilot, "t", "b", "t")
        assert "1 set" in " ".join(lines(pilot))
        await press(pilot, "escape", "a")
        assert all(value in " ".join(lines(pilot)) for value in ("Q-learning", "ε-greedy", "random"))
        before = snapshot(pilot).counters.step
        playground(pilot).send(Play())
        await train(pilot, 20)
        assert isinstance(pilot.app.screen, MenuStrip)
        assert playground(pilot).snapshot is not None
        assert snapshot(pilot).counters.step > before


async def test_a_reason_that_comes_while_the_menu_is_open_is_shown_whole(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), (60, 18)) as pilot:
        row = Action("one", "t o", "one", "Do it.")
        rows = [row]
        pilot.app.push_screen(MenuStrip(playground(pilot).look, "Test", lambda: list(rows)))
        await settle(pilot)
        rows[:] = [replace(row, refused=f"{'Because of this and that, ' * 4}this is the end.")]
        strip(pilot).show(snapshot(pilot))
        await settle(pilot)
        assert "is the end." in lines(pilot)[-1]


async def test_an_old_key_does_what_it_did_and_names_the_new_one_or_only_names_it(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), notifications=True) as pilot:
        await press(pilot, "P")
        assert playground(pilot).board.opened == "policies"
        assert "t p" in notes(pilot.app)[-1]
        await press(pilot, "P", "P")
        assert notes(pilot.app) == []
        await press(pilot, "W")
        assert "m w" in notes(pilot.app)[-1]
        assert snapshot(pilot).playback.phase is Phase.PAUSED
