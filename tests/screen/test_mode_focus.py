"""The keys of a mode need the world's focus."""

from __future__ import annotations

import pytest
from conftest import MakeApp
from seams import notes, on_screen, playground, press, screen_text, slider, snapshot, tap
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.frame.key_line import KeyLine
from rl_tui.screen.kit.row import MICROSCOPE, POLICIES
from rl_tui.screen.panels.world.view import WorldView
from rl_tui.screen.playground.modes.drawing import NOTHING_TO_CHOOSE
from rl_tui.screen.playground.playground import Playground

LEFT, DOWN, RIGHT, UP = range(4)
KEPT = "What you drew is kept. w p: go on drawing."


def view(pilot: Pilot[UserError]) -> WorldView:
    world = playground(pilot).board.world
    assert world is not None
    return world


def key_line(pilot: Pilot[UserError]) -> str:
    return playground(pilot).query_one(KeyLine).render_line(0).text.strip()


def drawn(pilot: Pilot[UserError]) -> tuple[tuple[int, int], ...]:
    return snapshot(pilot).answers.drawn.choices


@pytest.mark.exhaustive("plays at another size", but=["size0"])
@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_the_list_of_policies_opens_beside_the_drawing_and_another_policy_ends_it(
    make_app: MakeApp, size: tuple[int, int]
) -> None:
    async with on_screen(make_app("frozenlake"), size, notifications=True) as pilot:
        assert (await press(pilot, "w", "p", "1", "t", "p")).answers.studied is PolicyKind.DRAWN
        board = playground(pilot).board
        assert board.opened == POLICIES
        assert board.shows(POLICIES)
        assert view(pilot).has_focus
        assert len(drawn(pilot)) == 1
        assert "↑ ↓: which" not in screen_text(pilot.app)
        await press(pilot, "2", "shift+down")
        assert drawn(pilot) == ((0, DOWN),)
        assert view(pilot).cursor == 4
        assert key_line(pilot).startswith("shift+arrow draw")
        assert (await press(pilot, "t", "p")).answers.studied is PolicyKind.DRAWN
        assert view(pilot).has_focus
        assert playground(pilot).drawing.is_on
        await press(pilot, "t", "p")
        board.panel(POLICIES).focus()
        await settle(pilot)
        assert playground(pilot).drawing.is_on
        assert "enter: keep" in screen_text(pilot.app)
        assert "draw" not in key_line(pilot)
        assert (await press(pilot, "down", "up")).answers.studied is PolicyKind.OPTIMAL  # above the drawn one
        assert not playground(pilot).drawing.is_on
        assert notes(pilot.app)[-1] == KEPT
        assert "optimal" in view(pilot).head
        assert not view(pilot).has_class("-manual")
        assert (await press(pilot, "w", "p")).answers.studied is PolicyKind.DRAWN
        assert view(pilot).has_focus
        assert drawn(pilot) == ((0, DOWN),)
        assert view(pilot).has_class("-manual")


@pytest.mark.parametrize(
    ("mode", "word", "end"), [("w p", "draw", "w p ends it"), ("y", "act", "y: hand back")]
)
async def test_in_another_panel_keys_and_key_line_are_its_own(
    make_app: MakeApp, mode: str, word: str, end: str
) -> None:
    async with on_screen(make_app("frozenlake")) as pilot:
        screen = playground(pilot)
        await press(pilot, "s", "s", *mode.split())
        told = view(pilot).foot
        for other in ("alpha", "timeline", "table"):
            assert word in key_line(pilot), other
            assert view(pilot).has_class("-manual"), other
            for _ in range(20):
                await press(pilot, "tab")
                if screen.focused.id == other:
                    break
            assert screen.focused.id == other
            assert screen.modes.current is not None, other
            assert word not in key_line(pilot), other
            assert not view(pilot).has_class("-manual"), other
            assert view(pilot).title, other  # the drawing and the manual control continue
            assert view(pilot).foot.endswith(end), other
            assert "↑" not in view(pilot).foot, other
            if other == "alpha":
                assert key_line(pilot).split()[:3] == ["α", "step", "size"]
                await press(pilot, "right")
                assert slider(pilot.app, "alpha").value > 0.1
                await press(pilot, "escape")  # leaves the slider
            elif other == "table":
                await press(pilot, "down", "2")
                assert screen.board.table.cursor_pair is not None
            assert snapshot(pilot).counters.step == 2, other
            assert drawn(pilot) == ()
            view(pilot).focus()
            await settle(pilot)
            assert other != "alpha" or view(pilot).foot == told
        assert word in key_line(pilot)
        assert view(pilot).has_class("-manual")


async def test_escape_elsewhere_ends_the_mode_before_it_leaves_and_in_it_gives_the_focus_back(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("frozenlake"), notifications=True) as pilot:
        await press(pilot, "w", "p", "2")
        pilot.app.set_focus(playground(pilot).board.curve)
        await press(pilot, "escape")
        assert not playground(pilot).drawing.is_on
        assert isinstance(pilot.app.screen, Playground)
        assert notes(pilot.app)[-1] == KEPT
        table = playground(pilot).board.table
        for mode in ("w p", "y"):
            table.focus()
            await press(pilot, *mode.split())
            assert view(pilot).has_focus, mode
            await press(pilot, "escape")
            assert table.has_focus, mode
            assert playground(pilot).modes.current is None, mode


async def test_a_panel_leaves_the_arrows_to_who_acts_and_goes_on_from_what_was_drawn_beside_it(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("frozenlake"), (120, 40)) as pilot:
        board = playground(pilot).board
        board.table.focus()
        await press(pilot, "y", "d")
        assert board.opened == MICROSCOPE
        assert (await press(pilot, "down")).counters.step == 1
        await press(pilot, "d", "t", "p")
        assert board.opened == POLICIES
        seen = await press(pilot, "down")
        assert (seen.counters.step, seen.answers.studied) == (2, PolicyKind.GREEDY)
        await press(pilot, "y", "t", "p", "t", "p")
        assert (await press(pilot, "w", "p")).answers.studied is PolicyKind.DRAWN
        await press(pilot, "w", "p")
        assert board.panel(POLICIES).has_focus  # its previous row
        assert (await press(pilot, "up")).answers.studied is PolicyKind.OPTIMAL


@pytest.mark.parametrize("scenario", ["frozenlake", "student"])
async def test_after_an_episode_one_draws_where_the_next_one_starts(make_app: MakeApp, scenario: str) -> None:
    async with on_screen(make_app(scenario)) as pilot:
        ended = await press(pilot, "e")
        assert not len(ended.world.space.pairs_of(ended.counters.state))
        await press(pilot, "w", "p", "1")
        assert [state for state, _ in drawn(pilot)] == [ended.counters.step_from]
        assert NOTHING_TO_CHOOSE not in view(pilot).foot


async def test_a_cursor_that_was_put_stays_and_the_first_words_tell_of_the_mouse(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), notifications=True) as pilot:
        await press(pilot, "e")
        view(pilot).focus()
        view(pilot).put_cursor(9)
        await press(pilot, "w", "p")
        assert "shift and an arrow, a digit, or two clicks" in notes(pilot.app)[-1]
        await press(pilot, "3")
        assert drawn(pilot) == ((9, DOWN),)


async def test_the_first_words_of_a_bandit_tell_of_its_arms(make_app: MakeApp) -> None:
    async with on_screen(make_app("bandit"), notifications=True) as pilot:
        await press(pilot, "w", "p")
        assert notes(pilot.app)[-1] == "Draw: a digit, or two clicks. ? acts at random."


@pytest.mark.parametrize(("mode", "key"), [("w p", "2"), ("y", "down")])
async def test_a_mode_that_is_wanted_at_once_has_its_keys(make_app: MakeApp, mode: str, key: str) -> None:
    async with make_app("frozenlake").run_test(size=(80, 24)) as pilot:
        await tap(pilot, *mode.split(), key)
        assert drawn(pilot) == ((0, RIGHT),) if mode == "w p" else snapshot(pilot).counters.step == 1
