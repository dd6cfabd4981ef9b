from __future__ import annotations

from dataclasses import replace

import pytest
from textual.geometry import Region, Size

from rl_tui.screen.frame.arrangement import Shape, arrangement, is_roomy
from rl_tui.screen.kit.row import BUDGET, CONTROLS, LAST_STEP
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.worlds.drawing import Arms, CellKind, Drawing, Graph, Grid


def lake(side: int) -> Grid:
    cells = side * side
    return Grid(
        side, side, (CellKind.FLOOR,) * cells, tuple(range(cells)), ((0, -1), (1, 0), (0, 1), (-1, 0))
    )


SHAPES = {
    "lake 4x4": Shape(lake(4), 11),
    "lake 8x8": Shape(lake(8), 53),
    "student": Shape(Graph(((0, 1), (0, 0), (1, 1), (2, 1))), 5),
    "bandit": Shape(Arms(10), 10),
    "not known yet": Shape(),
}


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES.keys())
@pytest.mark.parametrize("size", [(60, 16), (80, 22), (79, 40), (100, 32), (120, 38), (99, 60), (250, 80)])
def test_panels_cover_the_board_without_overlapping(size: tuple[int, int], shape: Shape) -> None:
    board = Size(*size)
    regions = list(arrangement(board, shape).values())
    assert sum(region.area for region in regions) == board.area
    for number, region in enumerate(regions):
        assert board.region.contains_region(region)
        assert not any(region.overlaps(other) for other in regions[:number])


@pytest.mark.parametrize("size", [(60, 16), (80, 22), (120, 38)])
def test_every_panel_keeps_a_line_of_content(size: tuple[int, int]) -> None:
    for shape in SHAPES.values():
        for name, region in arrangement(Size(*size), shape).items():
            assert region.height >= (1 if name in ("last_step", "timeline") else 2), name


def test_the_world_of_4x4_at_80x24_has_two_rows_a_cell_as_drawn() -> None:
    regions = arrangement(Size(80, 22), SHAPES["lake 4x4"])
    assert regions["world"] == Region(0, 0, 42, 10)
    assert regions["curve"] == Region(0, 10, 42, 8)
    assert regions["timeline"] == Region(0, 18, 42, 1)
    assert regions["table"] == Region(42, 0, 38, 19)
    assert regions["controls"] == Region(0, 19, 80, 2)
    assert regions["last_step"] == Region(0, 21, 80, 1)


@pytest.mark.parametrize("size", [(60, 16), (80, 22), (100, 32), (120, 38), (200, 58)])
def test_controls_and_last_step_stand_at_one_place_whatever_the_scenario(size: tuple[int, int]) -> None:
    placed = [arrangement(Size(*size), shape) for shape in SHAPES.values()]
    for panel in (CONTROLS, LAST_STEP):
        assert len({regions[panel] for regions in placed}) == 1, panel


def test_controls_stand_between_table_and_last_step_at_120x40() -> None:
    regions = arrangement(Size(120, 38), SHAPES["lake 8x8"])
    assert regions["world"].height == 8 * 3 + 2
    assert regions["table"] == Region(62, 0, 58, 20)
    assert regions["controls"] == Region(62, 20, 58, 8)
    assert regions["last_step"] == Region(62, 28, 58, 10)


@pytest.mark.parametrize(("drawing", "has_budget"), [(Arms(10), True), (lake(4), False), (Graph(()), False)])
def test_only_a_bandit_has_a_budget(drawing: Drawing, has_budget: bool) -> None:
    for size in (Size(80, 22), Size(120, 38)):
        assert ("budget" in arrangement(size, Shape(drawing, 10))) is has_budget


def test_a_graph_has_the_rows_in_which_the_student_evening_is_drawn_whole() -> None:
    assert arrangement(Size(80, 22), SHAPES["student"])["world"].height == 12


def test_a_zoomed_panel_stands_alone() -> None:
    assert arrangement(Size(80, 22), SHAPES["student"], "table") == {"table": Region(0, 0, 80, 22)}


def test_the_graph_at_80x24_keeps_the_rows_it_needs() -> None:
    assert arrangement(Size(80, 22), SHAPES["student"])["world"].height == 12
    assert arrangement(Size(120, 38), SHAPES["student"])["world"].height == 20


@pytest.mark.parametrize("panel", ["curve", "timeline"])
def test_curve_and_timeline_are_zoomed_together(panel: str) -> None:
    assert arrangement(Size(80, 22), SHAPES["student"], panel) == {
        "curve": Region(0, 0, 80, 21),
        "timeline": Region(0, 21, 80, 1),
    }


@pytest.mark.parametrize("size", [(60, 16), (80, 22), (120, 38), (200, 50)])
def test_the_timeline_is_one_row_right_below_the_curve(size: tuple[int, int]) -> None:
    for shape in SHAPES.values():
        regions = arrangement(Size(*size), shape)
        curve, timeline = regions["curve"], regions["timeline"]
        assert (timeline.x, timeline.y, timeline.width) == (curve.x, curve.bottom, curve.width)
        assert timeline.height == 1


OPENED = [row for row in PANELS if row.opened_by is not None]


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES.keys())
@pytest.mark.parametrize("size", [(60, 16), (80, 22), (100, 32), (120, 38), (250, 80)])
def test_a_panel_that_a_key_opens_covers_no_other(size: tuple[int, int], shape: Shape) -> None:
    board = Size(*size)
    for row in OPENED:
        regions = arrangement(board, shape, opened=row.id)
        assert row.id in regions
        assert sum(region.area for region in regions.values()) == board.area
        assert all(board.region.contains_region(region) for region in regions.values())


def test_where_nothing_it_replaces_is_in_view_a_panel_covers_the_board() -> None:
    row = replace(OPENED[0], id="new", in_place_of=(BUDGET,), is_wide=False)
    placed = arrangement(Size(80, 22), SHAPES["student"], opened="new", panels=(*PANELS, row))
    assert placed == {"new": Region(0, 0, 80, 22)}
    placed = arrangement(Size(80, 22), SHAPES["bandit"], opened="new", panels=(*PANELS, row))
    assert placed["new"] == arrangement(Size(80, 22), SHAPES["bandit"])["budget"]


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES.keys())
@pytest.mark.parametrize("size", [(60, 16), (80, 22), (100, 32), (120, 38), (250, 80)])
def test_the_microscope_leaves_the_table_in_view(size: tuple[int, int], shape: Shape) -> None:
    board = Size(*size)
    regions = arrangement(board, shape, opened="microscope")
    assert sum(region.area for region in regions.values()) == board.area
    assert all(board.region.contains_region(region) for region in regions.values())
    assert {"microscope", "table", "timeline"} <= set(regions)
    if is_roomy(board):
        assert regions["microscope"].width == board.width
        assert "world" in regions
        assert min(regions["microscope"].height, regions["world"].height) >= 12
    else:
        assert regions["table"] == arrangement(board, shape)["table"]
        assert {"controls", "last_step"} <= set(regions)
