"""Maps larger than their panel."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from drawn_grids import large_lake, q_of
from samples import lake, look
from snapshots import changed
from textual.app import App, ComposeResult
from textual.geometry import Region, Size

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.kit.scrolling import kept_in_view
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.panels.grid.map import CellContent, GridMap, MapPart
from rl_tui.screen.panels.world_views import make_world_view
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.world import World


@pytest.mark.parametrize(
    ("first", "place", "expected"),
    [(0, 3, 0), (0, 9, 4), (5, 7, 5), (0, 99, 90), (95, None, 90), (-3, None, 0), (50, 0, 0)],
)
def test_the_view_moves_only_where_the_agent_nears_its_edge(
    first: int, place: int | None, expected: int
) -> None:
    assert kept_in_view(first, place, shown=10, total=100) == expected


def test_only_cells_in_view_are_read(monkeypatch: pytest.MonkeyPatch) -> None:
    snapshot = large_lake()
    read: list[MapPart] = []
    contents = GridMap.contents

    def counted(
        self: GridMap, part: MapPart, snapshot: Snapshot, *more: Any, **options: Any
    ) -> list[CellContent]:
        read.append(part)
        return contents(self, part, snapshot, *more, **options)

    monkeypatch.setattr(GridMap, "contents", counted)
    view = GridView(snapshot.world, look())
    view.picture(changed(snapshot, state=20 * 40 + 30), 40, 10)
    assert read == [MapPart(15, 26, 10, 8)]


def test_wheel_and_cursor_scroll_until_the_agent_is_followed_again() -> None:
    snapshot = large_lake()
    view = GridView(snapshot.world, look())
    view.snapshot, view.cell = snapshot, Size(8, 1)

    def text(width: int = 96) -> str:
        return "".join(strip.text for strip in view.picture(snapshot, width, 11))

    assert "◉" in text()
    assert view.footing == "rows 0–9 of 40 · columns 0–11 of 40 · follows the agent"
    assert view.check_action("back", ()) is False
    for _ in range(3):
        view.pan(1, 0)
    assert "◉" not in text()
    assert view.footing == "rows 3–12 of 40 · columns 0–11 of 40 · esc: follow the agent"
    view.action_page(1, 1)
    text()
    assert view.cursor == 10 * 40 + 12  # a page from the agent, at the start
    assert view.footing.startswith("rows 3–12 of 40 · columns 1–12 of 40")  # only as far as necessary
    view.action_move(3, 0)
    text()
    assert view.footing.startswith("rows 4–13 of 40 · columns 1–12 of 40")
    view.action_page(9, -9)
    assert "★" not in text()
    assert view.cursor == 39 * 40
    assert view.footing.startswith("rows 30–39 of 40 · columns 0–11 of 40")
    assert view.check_action("back", ()) is True
    view.follow()
    assert "◉" in text()
    text(64)
    assert view.footing == "rows 0–9 of 40 · columns 0–7 of 40"  # following the agent is visible


def test_a_legend_stands_below_a_map_with_the_part_in_view() -> None:
    snapshot = large_lake()
    assert isinstance(snapshot.world.drawing, Grid)
    drawing = replace(snapshot.world.drawing, legend="angle down, speed across")
    view = GridView(World(snapshot.world.space, drawing), look())
    view.picture(snapshot, 110, 10)
    assert view.footing.startswith("angle down, speed across · rows 0–9 of 40")
    view.picture(snapshot, 30, 10)
    assert view.footing == "rows 0–9 · columns 0–5"
    view.keep_in_view(0)
    view.picture(snapshot, 30, 10)
    assert view.footing == "esc: follow the agent"
    view.follow()
    view.picture(snapshot, 240, 40)
    assert view.footing == "angle down, speed across"
    for legend in ("angle down, speed across, ace right", "towns: angle down, speed across"):
        narrow = GridView(World(snapshot.world.space, replace(drawing, legend=legend)), look())
        narrow.cell = Size(1, 1)
        narrow.picture(snapshot, 58, 41)
        assert narrow.footing == "angle down, speed across"
        narrow.picture(snapshot, 74, 11)
        assert narrow.footing == "angle down, speed across · rows 0–9 of 40"


def test_a_whole_map_does_not_scroll() -> None:
    view = GridView(lake().world, look())
    view.picture(lake(), 40, 8)
    view.pan(1, 1)
    assert not view.is_away
    assert view.cells is None
    view.picture(lake(), 40, 8)
    assert view.footing == ""


async def test_only_rows_that_changed_are_refreshed() -> None:
    snapshot = lake()
    view = make_world_view(snapshot.world, look(), id="world")
    asked: list[Region] = []

    class Alone(App[None]):
        CSS = "#world { width: 40; height: 8; }"

        def compose(self) -> ComposeResult:
            yield view

    async with Alone().run_test(size=(80, 24)) as pilot:
        assert "the world is being built" in view.render_line(3).text
        view.show(snapshot)
        await pilot.pause()
        assert view.head == "World · V and greedy"
        before = view.render_line(1).text
        refresh = view.refresh

        def recorded(*regions: Region, **options: bool) -> object:
            asked.extend(regions)
            return refresh(*regions, **options)

        view.refresh = recorded  # type: ignore[method-assign,assignment]
        view.show(snapshot)
        assert asked == []
        view.show(changed(snapshot, q=snapshot.agent.q + q_of(snapshot, {(8, 1): -0.02})))
        assert asked == []
        best = int(np.argmax(snapshot.agent.q[:4]))
        view.show(changed(snapshot, q=snapshot.agent.q + q_of(snapshot, {(0, best): 0.05})))
        assert asked == [Region(0, 0, 40, 1), Region(0, 1, 40, 1)]  # both rows of its cell
        assert view.render_line(1).text != before


def test_an_end_far_from_where_the_agent_acted_does_not_move_the_map() -> None:
    snapshot = large_lake()
    goal = snapshot.world.space.states - 1
    last = lake().counters.last_step
    assert last is not None
    last = replace(last, state=5, pair=20, next_state=goal, terminated=True)
    view = GridView(snapshot.world, look())
    view.cell = Size(8, 1)
    view.picture(changed(snapshot, state=goal, last_step=last), 96, 11)
    assert view.footing.startswith("rows 0–9 of 40 · columns 0–11")
    near = replace(last, state=goal - 1)
    view.picture(changed(snapshot, state=goal, last_step=near), 96, 11)
    assert view.footing.startswith("rows 30–39 of 40")
