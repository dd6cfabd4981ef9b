"""A policy that a person draws."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import pytest
from click.testing import CliRunner
from conftest import MakeApp
from open_grids import open_grid_recipe
from seams import app_at, choose, click, notes, on_screen, order, playground, press, screen_text, snapshot
from textual.pilot import Pilot
from textual.widgets import Static

from rl_tui.commands.main import program
from rl_tui.common.errors import UserError
from rl_tui.live.commands import AddLane
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.answers.policy_values import PolicyAnswer
from rl_tui.runs.recipe import SetParameter
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.dialogs.dialog import Confirm
from rl_tui.screen.dialogs.export import CommandLine
from rl_tui.screen.frame.key_line import KeyLine
from rl_tui.screen.panels.world.view import WorldView
from rl_tui.screen.playground.playground import Playground

LEFT, DOWN, RIGHT, UP = range(4)
SHORTEST = ((0, DOWN), (4, DOWN), (8, RIGHT), (9, DOWN), (13, RIGHT), (14, RIGHT))
WAY = ("down", "down", "right", "down", "right", "right")


def view(pilot: Pilot[UserError]) -> WorldView:
    world = playground(pilot).board.world
    assert world is not None
    return world


def drawn(pilot: Pilot[UserError]) -> tuple[tuple[int, int], ...]:
    return snapshot(pilot).answers.drawn.choices


def worth(pilot: Pilot[UserError]) -> PolicyAnswer:
    return snapshot(pilot).answers.policies[PolicyKind.DRAWN]


def picture(pilot: Pilot[UserError]) -> str:
    world = view(pilot)
    return "\n".join(world.render_line(y).text for y in range(world.size.height))


async def draw_shortest(pilot: Pilot[UserError]) -> None:
    await settle(pilot)
    await press(pilot, "w", "p", *(f"shift+{key}" for key in WAY))


async def test_a_way_is_drawn_with_shift_and_arrows_and_where_it_never_comes_nothing_need_be(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("frozenlake"), (120, 40)) as pilot:
        await draw_shortest(pilot)
        assert drawn(pilot) == SHORTEST
        world = view(pilot)
        assert world.cursor == 15
        assert "You draw a policy · return 1 · its path is drawn" in world.head
        assert worth(pilot).expected_return == 1.0
        arrows = picture(pilot)
        assert (arrows.count("▜██▛"), arrows.count("█▙▄▖"), arrows.count("?")) == (
            5,  # three arrows, agent and star
            3,
            6,  # five cells and the legend
        )
        await pilot.resize_terminal(80, 24)
        await settle(pilot)

        def bold_signs() -> int:
            rows = [world.render_line(y) for y in range(world.size.height)]
            signs = [each for row in rows for each in row if "?" in each.text]
            return sum(each.style is not None and bool(each.style.bold) for each in signs)

        assert (picture(pilot).count("?"), bold_signs()) == (5, 0)
        assert world.head.endswith("its path is drawn")
        world.put_cursor(4)
        await press(pilot, "delete")
        left = snapshot(pilot).answers.left_to_chance
        assert bold_signs() == left.sum() == 1
        assert "1 at random" in world.head


@pytest.mark.parametrize(
    ("scenario", "keys", "said"),
    [
        pytest.param(
            *("taxi", ("3",), "You draw · return −752.0 · 399 at random (?)"),
            marks=pytest.mark.exhaustive("a world"),
        ),
        (
            "cliff",
            ("shift+up", "shift+right"),
            "You draw a policy · return −34,154 · 35 states on its path random (?)",
        ),
    ],
)
async def test_in_little_room_the_mode_its_figures_and_its_signs_are_told(
    make_app: MakeApp, scenario: str, keys: tuple[str, ...], said: str
) -> None:
    async with on_screen(make_app(scenario)) as pilot:
        await press(pilot, "w", "p", *keys)
        world = view(pilot)
        assert world.head == said
        assert world.foot.endswith("esc: end")
        assert "?" in picture(pilot)


async def test_a_diagonal_of_two_characters_is_no_tie(make_app: MakeApp) -> None:
    async with on_screen(make_app("windy-king", ascii=True)) as pilot:
        await press(pilot, "w", "p", "3", "right", "6")
        assert "@  v v>  ?" in picture(pilot)
        cells = picture(pilot).splitlines()[:-1]
        assert "*" not in "".join(cells)
        assert view(pilot).foot == "1^ 2> 3v 4< 5^> 6v> 7v< 8^< - esc: end"


async def test_digits_draw_and_the_cursor_stays_and_all_is_cleared_after_asking(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), notifications=True) as pilot:
        await press(pilot, "w", "p", "C")
        assert notes(pilot.app)[-1] == "Nothing drawn yet."
        await press(pilot, "right", "1", "2", "down")
        assert drawn(pilot) == ((1, RIGHT),)
        await press(pilot, "3")
        assert drawn(pilot) == ((1, RIGHT),)  # a hole is below
        assert "nothing to choose" in notes(pilot.app)[-1]
        assert view(pilot).foot == "nothing to choose here · esc: end"
        await press(pilot, "up", "7")
        assert notes(pilot.app)[-1] == "7 is not an action here: draw with 1…4"
        await press(pilot, "C")
        assert isinstance(pilot.app.screen, Confirm)
        await press(pilot, "escape")
        assert drawn(pilot) == ((1, RIGHT),)
        await press(pilot, "delete")
        assert drawn(pilot) == ()
        await press(pilot, "3", "C", "enter")
        assert drawn(pilot) == ()
        assert snapshot(pilot).counters.step == 0


async def test_the_mode_is_seen_and_ends_by_its_keys_and_by_another_mode(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), (120, 40), notifications=True) as pilot:
        screen, world = playground(pilot), view(pilot)
        keys = screen.query_one(KeyLine)

        def seen() -> tuple[str, ...]:
            borders = world.head, world.foot
            return *borders, keys.render_line(0).text, picture(pilot)

        before = seen()
        for keys_of_end in (("w", "p"), ("escape",)):
            await press(pilot, "w", "p")
            assert world.has_class("-manual")
            assert world.has_focus
            said = "return .01 · 10 states on its path random (?)" if drawn(pilot) else "all at random (?)"
            assert world.head.endswith(f" · {said}")
            assert world.foot == "1 ↑  2 →  3 ↓  4 ← · del: undraw · C: clear · esc: end"
            assert keys.render_line(0).text.startswith(" shift+arrow draw  digits draw  esc end")
            await press(pilot, "shift+right", *keys_of_end)
            assert not screen.drawing.is_on
            assert not world.has_class("-manual")
            pilot.app.set_focus(None)
            await settle(pilot)
            assert seen() == before
            assert isinstance(pilot.app.screen, Playground)
        assert drawn(pilot) == ((0, RIGHT),)
        assert "w p" in notes(pilot.app)[-1]
        await press(pilot, "w", "p", "y")
        assert (screen.drawing.is_on, screen.manual.is_on, world.is_manual) == (False, True, True)
        await press(pilot, "w", "p")
        assert (screen.drawing.is_on, screen.manual.is_on, world.is_manual) == (True, False, False)
        assert snapshot(pilot).answers.studied is PolicyKind.DRAWN


async def test_a_node_of_a_graph_takes_its_own_actions_and_a_name_leaves_the_corners_whole(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("student"), notifications=True) as pilot:
        await press(pilot, "w", "p")
        rows = picture(pilot)
        assert "Phone?  ─" in rows
        assert "◉Class?  ─" in rows
        assert "│ 4.04 │" not in rows
        assert "?" not in "".join(row for row in rows.splitlines() if "──╮" in row)
        assert rows.count("?") == 2  # Pass has one action
        assert "1 study  2 check phone" in rows
        await pilot.resize_terminal(120, 40)
        await settle(pilot)
        assert view(pilot).foot.startswith("1 study  2 check phone · ")
        assert "Drawn · all at random   1 study  2 check phone " in picture(pilot)
        names = snapshot(pilot).world.space.state_names
        await press(pilot, "1")
        view(pilot).put_cursor(names.index("Phone"))
        await press(pilot, "2")
        assert drawn(pilot) == ((0, 0), (1, 3))
        assert "?" not in picture(pilot)
        assert "its path is drawn" in view(pilot).head
        mdp = snapshot(pilot).world.mdp
        assert mdp is not None
        assert worth(pilot).expected_return == pytest.approx(7.5, abs=5.0)


async def test_an_arm_of_a_bandit_is_drawn(make_app: MakeApp) -> None:
    async with on_screen(make_app("bandit")) as pilot:
        await press(pilot, "w", "p", "down", "down", "enter")
        assert drawn(pilot) == ((0, 2),)
        await press(pilot, "7")
        assert drawn(pilot) == ((0, 7),)
        assert worth(pilot).expected_return is not None
        assert view(pilot).head == "You draw · return hidden (w h shows it)"
        assert view(pilot).foot.endswith("esc: end")
        assert "? random" not in picture(pilot)


async def test_a_world_without_a_table_refuses_with_the_reason(make_app: MakeApp) -> None:
    async with on_screen(make_app("blackjack"), notifications=True) as pilot:
        await press(pilot, "w", "p")
        assert not playground(pilot).drawing.is_on
        assert f"Not here: {playground(pilot).drawing.why_not('toggle')}." in screen_text(pilot.app)


async def test_a_large_map_says_at_least_what_is_open() -> None:
    app = app_at(open_grid_recipe(200))
    async with on_screen(app) as pilot:
        await press(pilot, "w", "p", "shift+right", "shift+down", "2")
        assert len(drawn(pilot)) == 3
        assert view(pilot).head == "You draw · 39,996 on its path random (?)"


async def test_the_mouse_draws_towards_the_side_that_is_clicked_again(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), (120, 40)) as pilot:
        await press(pilot, "w", "p")
        world = view(pilot)
        places = [(x, y) for y in range(world.size.height) for x in range(world.size.width)]
        cell = [each for each in places if world.place_at(*each) == 6]
        sides = {world.part_at(*each): each for each in cell}
        assert set(sides) == {None, (0, 1), (0, -1), (1, 0), (-1, 0)}
        for step, expected in (((0, 1), RIGHT), ((1, 0), DOWN), ((0, -1), LEFT), ((-1, 0), UP)):
            x, y = sides[step]
            if world.cursor != 6:
                await click(pilot, world, offset=(x + 1, y))
                assert drawn(pilot) == ()
            await click(pilot, world, offset=(x + 1, y))
            assert drawn(pilot) == ((6, expected),)
            assert world.cursor == 6
        await order(pilot, AddLane((SetParameter("alpha", 0.5),)))
        seen = await press(pilot, "shift+down")
        assert seen.answers.drawn == seen.beside.answers.drawn
        assert seen.answers.drawn.choices == ((6, DOWN),)


async def test_what_is_exported_is_worth_what_the_screen_says(
    make_app: MakeApp, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    async with on_screen(make_app("frozenlake-slippery"), (120, 40), notifications=True) as pilot:
        await press(pilot, "m", "x")
        with pytest.raises(Exception, match="policy"):
            pilot.app.screen.query_one("OptionList").get_option("policy")  # type: ignore[attr-defined]
        await press(pilot, "escape")
        await draw_shortest(pilot)
        shown = worth(pilot)
        assert 0.0 < shown.expected_return < 0.2  # type: ignore[operator]
        assert "5 states on its path random (?)" in view(pilot).head
        await press(pilot, "m", "x")
        await choose(pilot, "policy")
        await press(pilot, "enter")
        assert isinstance(pilot.app.screen, CommandLine)
        line = str(pilot.app.screen.query_one("#command Static", Static).render())
    words = shlex.split(line)
    policy = "frozenlake-slippery-policy.json"
    assert words[:5] == ["rl-tui", "evaluate", "frozenlake-slippery", "--policy", policy]
    answer = json.loads(CliRunner().invoke(program, [*words[1:], "--json"]).stdout)
    assert list(answer["V"].values()) == shown.v.tolist()
    assert answer["expected_return"] == shown.expected_return
    assert answer["value_at_start"] == shown.value_at_start
