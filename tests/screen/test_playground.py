from __future__ import annotations

import pytest
from conftest import MakeApp
from seams import on_screen, playground, press, screen_text, snapshot, tap, train

from rl_tui.live.snapshot import Phase
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.frame.message_line import MessageLine
from rl_tui.worlds.files.catalogue import scenarios


async def test_it_goes_on_where_a_screen_that_closed_forgot_to_tell_that_it_was_painted(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with on_screen(make_app("student")) as pilot:
        screen = playground(pilot)
        ask, forgotten = screen.call_after_refresh, iter([True])
        monkeypatch.setattr(screen, "call_after_refresh", lambda what: next(forgotten, False) or ask(what))
        assert (await press(pilot, "s")).counters.step == 1
        assert (await press(pilot, "s")).counters.step == 2


async def test_it_starts_paused_keys_step_and_run_and_set_the_speed_and_a_notice_hides_no_title(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("student"), notifications=True) as pilot:
        first = snapshot(pilot)
        assert (first.counters.step, first.playback.phase) == (0, Phase.PAUSED)
        assert first.playback.speed == 10.0
        assert (await press(pilot, "s")).counters.step == 1
        assert (await press(pilot, "s", "s")).counters.step == 3
        done = await press(pilot, "e")
        assert done.counters.episodes == 1
        assert done.counters.episode_step == 0
        assert done.playback.phase is Phase.PAUSED
        assert (await press(pilot, "space")).playback.phase is Phase.RUNNING
        here = done.counters.step + 100
        assert (await train(pilot, 100)).counters.step == here
        assert (await press(pilot, "space")).playback.phase is Phase.PAUSED
        assert snapshot(pilot).counters.step == here
        ties = await press(pilot, "a", "t")
        assert ties.agent.hyperparameters.ties == "first"
        assert ties.counters.step == here
        again = await press(pilot, "r", "r")  # with the current settings
        assert again.counters.step == 0
        assert again.playback.phase is Phase.PAUSED
        assert again.recipe.hyperparameters.ties == "first"
        assert again.recipe.seed == 0
        assert (await press(pilot, "plus")).playback.speed == 30.0
        assert (await press(pilot, "equals_sign")).playback.speed == 100.0
        assert (await press(pilot, "minus", "underscore", "minus")).playback.speed == 3.0
        assert (await press(pilot, *["plus"] * 12)).playback.speed is None
        await press(pilot, "b")  # there is nothing before step 0
        notice = pilot.app.screen.query_one(MessageLine).region
        assert (notice.bottom, notice.height) == (24, 1)
        assert notice.right >= 78
        assert RlTuiApp.NOTIFICATION_TIMEOUT <= 3


async def test_f_zooms_the_world_or_the_panel_in_focus(make_app: MakeApp) -> None:
    async with on_screen(make_app("student")) as pilot:
        board = playground(pilot).board
        width = board.query_one("#world").region.width
        await press(pilot, "f")
        assert board.zoomed == "world"
        assert board.query_one("#world").region == (0, 0, 79, 21), "the header gives its row to it"
        assert [board.panel(each).region.y for each in ("curve", "caption")] == [21, 22]
        assert "❚❚ paused" in screen_text(pilot.app).splitlines()[20]
        await press(pilot, "escape")
        assert board.zoomed is None
        assert "❚❚ paused" in screen_text(pilot.app).splitlines()[0]
        board.table.focus()
        await press(pilot, "f")
        assert board.zoomed == "table"
        assert board.table.region.size == (board.size.width - 2, board.size.height)
        await press(pilot, "f")
        assert board.zoomed is None
        assert board.query_one("#world").region.width == width


async def test_tab_goes_round_the_panels_m_shows_the_model_and_help_ends_with_notes(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("student"), (120, 40)) as pilot:
        board, visited = playground(pilot).board, []
        for _ in range(6):
            await press(pilot, "tab")
            visited.append(board.panel_of(pilot.app.focused))
        assert visited == ["world", "table", "curve", "timeline", "controls", "controls"]
        await press(pilot, "w", "m")
        assert board.opened == "model"
        await train(pilot, 10)
        await press(pilot, "escape")
        assert board.opened is None
        pilot.app.set_focus(None)
        await press(pilot, "question_mark", "3", "pagedown")
        assert "student MDP" in str(pilot.app.screen.query("MarkdownParagraph").last().render())


async def test_h_explains_itself_where_nothing_is_hidden(make_app: MakeApp) -> None:
    async with on_screen(make_app("cartpole"), notifications=True) as pilot:
        await press(pilot, "w", "h")
        assert "Not here: this world has no exact values to hide." in screen_text(pilot.app)


async def test_scenarios_may_be_changed_faster_than_they_load(make_app: MakeApp) -> None:
    app = make_app("student")
    async with app.run_test(size=(120, 40)) as pilot:
        await tap(pilot, *["w", "right_square_bracket"] * 4, *["w", "left_square_bracket"] * 3)
        shipped = [scenario.id for scenario in scenarios()]
        assert snapshot(pilot).recipe.scenario.id == shipped[shipped.index("student") + 1]
