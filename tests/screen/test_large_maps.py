"""The playground of a map of 200×200 cells."""

from __future__ import annotations

import numpy as np
import pytest
from open_grids import open_grid_recipe
from seams import app_at, on_screen, playground, scroll_down, tap, train

from rl_tui.live.snapshot import Snapshot
from rl_tui.live.viewport import RowRange
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.panels.model import ModelPanel
from rl_tui.screen.panels.side_by_side import greedy_differences
from rl_tui.screen.playground.playground import Playground

SIDE = 200


def app_of(side: int = SIDE) -> RlTuiApp:
    return app_at(open_grid_recipe(side))


def map_of(screen: Playground) -> GridView:
    view = screen.board.world
    assert isinstance(view, GridView)
    return view


def newest(screen: Playground) -> Snapshot:
    assert screen.snapshot is not None
    return screen.snapshot


def text_of(panel: GridView) -> str:
    """The text of the map, without the legend, which repeats its signs."""
    panel.is_explained = False
    panel.redraw()
    return "\n".join(panel.render_line(y).text for y in range(panel.size.height))


def check_complete(screen: Playground) -> None:
    snapshot = newest(screen)
    assert screen.board.is_complete
    assert snapshot.agent.part.held.sum() < 45_000


@pytest.mark.parametrize("size", [(120, 40), pytest.param((80, 24), marks=pytest.mark.exhaustive("a size"))])
async def test_map_and_table_follow_the_agent_and_what_is_scrolled_to_is_filled_in(
    size: tuple[int, int],
) -> None:
    async with on_screen(app_of(), size) as pilot:
        screen = playground(pilot)
        view, table = map_of(screen), screen.board.table
        for steps in (1, 1, 50, 3_000, 40_000, 1):
            await train(pilot, steps)
            check_complete(screen)
            assert text_of(view).count("◉") == 1
            assert any(table.render_line(y).text.startswith("◉") for y in range(table.size.height))
        assert "follows the agent" in view.footing
        before = newest(screen)
        view.focus()
        for _ in range(4):
            await tap(pilot, "pagedown")
            check_complete(screen)
        assert newest(screen).counters.step == before.counters.step
        assert newest(screen) is not before
        assert "◉" not in text_of(view)
        assert "0" in text_of(view)
        await tap(pilot, "escape")
        assert "◉" in text_of(view)
        check_complete(screen)


async def test_the_table_the_model_and_a_new_size_may_look_elsewhere_while_the_agent_walks_on() -> None:
    async with on_screen(app_of(), (120, 40)) as pilot:
        screen = playground(pilot)
        table = screen.board.table
        table.focus()
        await tap(pilot, "home")
        assert table.row_range.first == 0
        await train(pilot, 3_000)
        check_complete(screen)
        assert newest(screen).agent.holds(0)
        await tap(pilot, "end")
        check_complete(screen)
        assert newest(screen).agent.holds(newest(screen).world.space.pairs - 1)
        await tap(pilot, "escape")
        check_complete(screen)
        assert isinstance(table.row_range, RowRange)
        assert table.row_range.first is None
        await train(pilot, 2_000)
        await tap(pilot, "w", "m")
        panel = pilot.app.screen.query_one(ModelPanel)
        panel.show_pair(4)
        await settle(pilot)
        assert newest(screen).agent.holds(4)
        assert "not yet visited" in "\n".join(panel.render_line(y).text for y in range(panel.size.height))
        await tap(pilot, "escape")
        map_of(screen).focus()
        await tap(pilot, "f")  # it covers all others
        check_complete(screen)
        await pilot.resize_terminal(160, 50)
        await settle(pilot)
        check_complete(screen)
        await tap(pilot, "f", "r")
        check_complete(screen)


async def test_two_lanes_show_and_scroll_the_same_part_and_count_what_is_in_view() -> None:
    async with on_screen(app_of(), (120, 40)) as pilot:
        screen = playground(pilot)
        await train(pilot, 300)
        await tap(pilot, "c", "a", "down", "enter")
        left, right = (screen.board.panel(panel) for panel in ("world", "world-beside"))
        assert isinstance(left, GridView)
        assert isinstance(right, GridView)
        for key in ("s", "l", "s"):
            await tap(pilot, key)
            assert left.stance == right.stance
            check_complete(screen)  # both show the surroundings of the controlled run's agent
        await train(pilot, 3_000)
        check_complete(screen)
        shown = newest(screen)
        assert shown.beside is not None
        found = greedy_differences(shown, shown.beside)
        assert found.is_part
        assert found.known <= len(np.unique(shown.agent.part.pairs)) // 4
        right.focus()
        for _ in range(3):
            await tap(pilot, "pagedown")
            check_complete(screen)
            assert left.cells == right.cells
        await tap(pilot, "home", *["pageup"] * 3)
        for moved, other in ((left, right), (right, left)):
            before = moved.stance
            await scroll_down(pilot, moved)
            assert moved.stance == other.stance != before
