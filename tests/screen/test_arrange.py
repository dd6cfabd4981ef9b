"""The place of every panel."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from itertools import combinations, product
from typing import Any

import pytest
from textual.geometry import Region, Size

from rl_tui.screen.frame.arrange import arrange
from rl_tui.screen.frame.shape import ROOMY, WORLDS, Arrangement, Shape, cell_size, size_class
from rl_tui.screen.kit.row import (
    CAPTION,
    CONTROLS,
    CURVE,
    DISCOUNT,
    DRAW,
    LAST_STEP,
    LESSON,
    MANY_SEEDS,
    PROGRAM,
    TABLE,
    TIMELINE,
    WORLD,
    beside,
)
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.worlds.drawing import Arms, Axes, Body, BodyKind, CellKind, Graph, Grid, Title


def grid(rows: int, columns: int, legend: str = "", wind: tuple[int, ...] = ()) -> Grid:
    cells, ways = rows * columns, ((0, -1), (1, 0), (0, 1), (-1, 0))
    return Grid(rows, columns, (CellKind.FLOOR,) * cells, tuple(range(cells)), ways, legend, wind)


MAPS = {
    "lake": Shape(grid(4, 4), 11),
    "large lake": Shape(grid(8, 8), 53),
    "cliff": Shape(grid(4, 12), 37),
    "maze": Shape(grid(6, 9), 46),
    "windy": Shape(grid(7, 10, wind=(0,) * 10), 70),
    "karpathy": Shape(grid(10, 10), 88),
    "largest": Shape(grid(10, 12), 120),
}
BODY = Body(BodyKind.CART_POLE, ((math.nan,),) * 4)
BINS = replace(
    grid(6, 12, "angle down, velocity across"),
    body=BODY,
    axes=Axes(("−0.17",) * 6, ("1.5",) * 12, names=("angle", "velocity")),
)
CARDS = replace(
    grid(19, 21, "sum down, card across"),
    axes=Axes(("21",) * 19, ("A",) * 21, (Title(-1, 0, 10, "no ace"), Title(-1, 11, 10, "ace"))),
)
TOWN = Title(-1, 0, 5, "R→R")
SHAPES = MAPS | {
    "taxi": Shape(
        replace(grid(29, 23, legend="rows: taxi"), axes=Axes(("",) * 29, ("",) * 23, (TOWN,))), 400, 6
    ),
    "cart pole": Shape(grid(6, 12, legend="rows: angle"), 72, 2),
    "bins of a body": Shape(BINS, 72, 2),
    "many bins of a body": Shape(replace(BINS, rows=18, columns=14), 252, 3),
    "cards": Shape(CARDS, 290, 2),
    "bandit": Shape(Arms(10), 10, 1),
    "student": Shape(Graph(((0, 1), (0, 0), (1, 1), (2, 1))), 5),
    "walk": Shape(Graph(tuple((x, 0) for x in range(7)), tuple(range(7))), 5, 1),
    "long walk": Shape(Graph(tuple((x, 0) for x in range(21)), tuple(range(21))), 19, 1),
    "not known yet": Shape(),
}
# arguments of the function, then fields of the shape
STATES: Mapping[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "plain": ({}, {}),
    "panel": ({"opened": "microscope"}, {}),
    "wide panel": ({"opened": "discount", "wide_rows": 15}, {}),
    "wide panel, drawing": ({"opened": "discount", "wide_rows": 15}, {"is_drawn": True}),
    "lanes": ({}, {"lanes": True}),
    "lanes, panel": ({"opened": "microscope"}, {"lanes": True}),
    "lanes, drawing": ({}, {"lanes": True, "is_drawn": True}),
    "lesson": ({}, {"has_lesson": True}),
    "lesson, read": ({}, {"has_lesson": True, "reads": True}),
    "lesson, looked at": ({}, {"has_lesson": True, "reads": True, "spotlight": WORLD}),
    "lesson, at first": ({}, {"has_lesson": True, "is_fresh": True}),
    "lesson, world alone": ({}, {"shown": frozenset({WORLD}), "has_lesson": True}),
    "lesson, world and curve": ({}, {"shown": frozenset({WORLD, CURVE, TIMELINE}), "has_lesson": True}),
    "lesson, world and table": (
        {},
        {"shown": frozenset({WORLD, TABLE, CURVE, TIMELINE}), "has_lesson": True},
    ),
    "lesson, world, panel": ({"opened": "policies"}, {"shown": frozenset({WORLD}), "has_lesson": True}),
    "lesson, panel": ({"opened": "policies"}, {"has_lesson": True}),
    "lesson, lanes": ({}, {"has_lesson": True, "lanes": True}),
    "lesson, drawing": ({}, {"has_lesson": True, "is_drawn": True}),
    "world alone": ({}, {"shown": frozenset({WORLD})}),
    "world and curve": ({}, {"shown": frozenset({WORLD, CURVE, TIMELINE})}),
    "world and table": ({}, {"shown": frozenset({WORLD, CURVE, TIMELINE, TABLE})}),
    "all but the settings": ({}, {"shown": frozenset({WORLD, CURVE, TIMELINE, TABLE, LAST_STEP})}),
    "world and settings": ({}, {"shown": frozenset({WORLD, CONTROLS})}),
    "world, panel": ({"opened": "microscope"}, {"shown": frozenset({WORLD})}),
    "drawing": ({}, {"is_drawn": True}),
    "drawing, panel": ({"opened": "world_check"}, {"is_drawn": True}),
    "program": ({}, {"is_program": True}),
    "zoomed table": ({"zoomed": TABLE}, {}),
    "zoomed world": ({"zoomed": WORLD}, {}),
    "zoomed world, lesson": ({"zoomed": WORLD}, {"has_lesson": True, "reads": True}),
    "zoomed world, lanes": ({"zoomed": beside(WORLD)}, {"lanes": True}),
    "zoomed world, drawing": ({"zoomed": WORLD}, {"is_drawn": True}),
    "zoomed world at first": ({"zoomed": WORLD}, {"shown": frozenset({WORLD, CAPTION})}),
    "world and caption": ({}, {"shown": frozenset({WORLD, CAPTION})}),
    "all and caption": (
        {},
        {"shown": frozenset({WORLD, TABLE, CURVE, TIMELINE, LAST_STEP, CONTROLS, CAPTION})},
    ),
    "program, world and settings": ({}, {"is_program": True, "shown": frozenset({WORLD, CONTROLS})}),
}


def arranged(shape: Shape, state: str, size: Size) -> Arrangement:
    asked, changes = STATES[state]
    return arrange(size, replace(shape, **changes), **asked)


def check(place: Arrangement, shape: Shape, state: str, size: Size) -> None:
    case = state, size, place
    asked, changes = STATES[state]
    is_big = asked.get("zoomed") in WORLDS
    above = int(place.has_header)
    between = Region(0, above, size.width, size.height - 1 - above)
    assert all(between.contains_region(each) for each in place.regions.values()), case
    assert not any(one.overlaps(other) for one, other in combinations(place.regions.values(), 2)), case
    if "shown" in changes and "opened" in asked and size_class(size) is not ROOMY:
        return  # a board then shows all panels
    if changes.get("reads") and place.regions.keys() == {LESSON}:
        return
    wanted = {asked.get("opened", asked.get("zoomed", WORLD))}
    wanted |= {DRAW} if changes.get("is_drawn") and not asked else set()
    wanted |= {LESSON} if changes.get("has_lesson") else {CAPTION} if is_big else set()
    wanted |= {CAPTION, PROGRAM if changes.get("is_program") else CONTROLS} & changes.get("shown", set())
    assert wanted <= place.regions.keys(), case
    for row in {CAPTION} & place.regions.keys():
        assert place.regions[row].bottom == size.height - 1, case
    if is_big:
        assert place.regions.keys() <= {*WORLDS, CURVE, CAPTION, LESSON}, case
        assert place.regions[asked["zoomed"]].bottom <= size.height - 3, case
    if "shown" in changes:
        permanent = {WORLD, TABLE, CURVE, TIMELINE, LAST_STEP, CONTROLS}
        assert place.regions.keys() & permanent <= {*changes["shown"]}, case
    if isinstance(shape.drawing, Grid) and WORLD in place.regions:
        assert place.cell.area > 0
        assert place.cell.width <= place.regions[WORLD].width


WIDTHS, HEIGHTS = range(60, 250, 3), range(18, 71, 2)
CASES = list(product(range(len(WIDTHS)), range(len(HEIGHTS)), SHAPES, STATES))


@pytest.mark.parametrize(
    "step", [61, pytest.param(1, marks=pytest.mark.exhaustive("checks every arrangement"))]
)
def test_nothing_overlaps_nothing_stands_outside_and_what_is_open_is_there(step: int) -> None:
    # 61 has no factor in common with the lists, so every 61st case has all shapes and states at many sizes
    for column, row, name, state in CASES[::step]:
        size = Size(WIDTHS[column], HEIGHTS[row])
        check(arranged(SHAPES[name], state, size), SHAPES[name], state, size)


def share(shape: Shape, size: Size) -> int:
    assert isinstance(shape.drawing, Grid)
    cell = arrange(size, shape).cell
    return round(100 * cell.area * shape.drawing.rows * shape.drawing.columns / size.area)


@pytest.mark.parametrize(
    ("size", "cell", "percent"),
    [
        ((60, 18), (7, 3), 31),
        ((80, 24), (11, 4), 37),
        ((120, 40), (17, 6), 34),
        ((160, 50), (23, 8), 37),
        ((200, 60), (31, 11), 45),
    ],
)
def test_the_small_lake_has_a_third_of_the_screen_and_more(
    size: tuple[int, int], cell: tuple[int, int], percent: int
) -> None:
    assert arrange(Size(*size), MAPS["lake"]).cell == cell
    assert share(MAPS["lake"], Size(*size)) == percent


@pytest.mark.parametrize("name", MAPS)
def test_no_map_of_up_to_10x12_cells_has_less_than_a_quarter_or_nearly(name: str) -> None:
    sizes = [(80, 24), (90, 28), (100, 30), (120, 36), (120, 40), (132, 43), (160, 50), (200, 60)]
    for size in (*sizes, (220, 50), (250, 70)):
        assert share(MAPS[name], Size(*size)) >= 24, size


@pytest.mark.parametrize(
    ("size", "cell"), [((60, 18), (11, 3)), ((80, 24), (19, 5)), ((120, 40), (29, 9)), ((160, 50), (39, 11))]
)
def test_a_world_alone_is_as_large_as_it_goes(size: tuple[int, int], cell: tuple[int, int]) -> None:
    place = arrange(Size(*size), MAPS["lake"], zoomed=WORLD)
    assert place.cell == cell
    assert place.regions[WORLD].width >= 4 * cell[0]
    assert place.regions[CURVE].y == place.regions[CAPTION].y - 1
    assert 0 <= place.regions[CURVE].y - place.regions[WORLD].bottom <= 1


def test_on_a_small_screen_a_last_step_leaves_the_map_its_width() -> None:
    alone = replace(MAPS["cliff"], shown=frozenset({WORLD, CAPTION}))
    stepped = replace(MAPS["cliff"], shown=frozenset({WORLD, CAPTION, LAST_STEP}))
    assert arrange(Size(60, 18), stepped).cell.width == arrange(Size(60, 18), alone).cell.width


def test_a_world_alone_has_a_header_if_a_row_is_left() -> None:
    assert arrange(Size(120, 40), MAPS["cliff"], zoomed=WORLD).has_header
    assert not arrange(Size(80, 24), MAPS["lake"], zoomed=WORLD).has_header


def test_in_a_world_alone_cells_of_an_even_width_take_the_room_there_is() -> None:
    assert arrange(Size(80, 24), MAPS["cliff"], zoomed=WORLD).cell == (6, 4)
    assert arrange(Size(120, 40), MAPS["cliff"]).cell == (9, 5)


def test_beside_a_map_that_is_nearly_as_tall_as_the_screen_curve_and_settings_change_places() -> None:
    place = arrange(Size(120, 40), SHAPES["taxi"])
    world, curve, settings = (place.regions[each] for each in (WORLD, CURVE, CONTROLS))
    assert place.cell == (3, 1)
    assert curve.height >= 10
    assert curve.x > world.right
    assert settings.y >= world.bottom
    assert settings.right < curve.x
    assert world.height == 1 + 29 + 1  # titles, rows, scale


def test_a_wide_map_lies_above_all_else_at_80x24() -> None:
    place = arrange(Size(80, 24), MAPS["cliff"])
    assert place.cell == (5, 3)
    assert place.regions[WORLD].bottom == place.regions[LAST_STEP].y
    assert place.regions[TABLE].y == place.regions[CURVE].y


@pytest.mark.parametrize(
    ("size", "regions"),
    [
        (
            (80, 24),
            {
                WORLD: (0, 1, 45, 17),
                TABLE: (47, 1, 32, 14),
                LAST_STEP: (47, 15, 32, 3),
                CURVE: (1, 18, 44, 4),
                TIMELINE: (1, 22, 44, 1),
                CONTROLS: (47, 18, 32, 5),
            },
        ),
        (
            (120, 40),
            {
                WORLD: (1, 2, 69, 25),
                TABLE: (73, 2, 45, 16),
                LAST_STEP: (73, 19, 45, 8),
                CURVE: (2, 28, 68, 9),
                TIMELINE: (2, 37, 68, 1),
                CONTROLS: (73, 28, 45, 10),
            },
        ),
    ],
    ids=["80x24", "120x40"],
)
def test_two_bands_share_a_line(size: tuple[int, int], regions: dict[str, tuple[int, ...]]) -> None:
    assert arrange(Size(*size), MAPS["lake"]).regions == regions


@pytest.mark.parametrize("size", [(76, 22), (80, 24), (120, 40), (200, 60)])
def test_the_timeline_has_the_columns_of_the_curve_and_the_row_below_it(size: tuple[int, int]) -> None:
    for shape, state in product(SHAPES.values(), ("plain", "panel", "lanes", "lesson", "program")):
        regions = arranged(shape, state, Size(*size)).regions
        if CURVE in regions:
            curve, timeline = regions[CURVE], regions[TIMELINE]
            assert timeline == (curve.x, curve.bottom, curve.width, 1)


def test_a_small_screen_has_curve_and_timeline_in_its_last_line() -> None:
    regions = arrange(Size(60, 18), MAPS["lake"]).regions
    assert regions[CURVE].y == regions[TIMELINE].y == 16


def test_a_panel_of_charts_has_the_lower_band_where_it_is_roomy_else_the_right_column() -> None:
    lake = MAPS["lake"]
    assert arrange(Size(120, 40), lake, "discount", wide_rows=15).regions["discount"] == (2, 20, 116, 16)
    assert arrange(Size(80, 24), lake, "discount", wide_rows=15).regions["discount"] == (39, 1, 40, 22)
    assert arrange(Size(60, 18), lake, "discount", wide_rows=15).regions == {"discount": (1, 1, 58, 16)}


@pytest.mark.parametrize(("panel", "cell"), [(MANY_SEEDS, (13, 5)), (DISCOUNT, (11, 4))])
def test_the_lake_has_the_rows_that_a_panel_below_it_does_not_need(panel: str, cell: tuple[int, int]) -> None:
    rows = next(row.wide_rows for row in PANELS if row.id == panel)
    place = arrange(Size(120, 40), MAPS["lake"], panel, wide_rows=rows)
    assert place.cell == cell
    assert place.regions[panel].height >= rows


def test_a_table_ends_where_its_rows_and_its_legend_do() -> None:
    for name in ("lake", "student", "walk", "large lake"):
        table = arrange(Size(160, 50), SHAPES[name]).regions[TABLE]
        assert SHAPES[name].table_rows + 8 >= table.height >= min(SHAPES[name].table_rows + 8, 14), name


def test_a_page_about_the_world_alone_leaves_it_nearly_all_of_the_height() -> None:
    place = arranged(MAPS["lake"], "lesson, world alone", Size(120, 40))
    assert place.cell == (17, 8)
    assert place.regions == {WORLD: (1, 2, 69, 33), LESSON: (73, 2, 45, 36)}


@pytest.mark.parametrize(
    ("size", "cell", "columns"), [((80, 24), (3, 2), 40), ((120, 40), (5, 3), 48), ((160, 50), (9, 5), 45)]
)
@pytest.mark.parametrize("state", ["panel", "drawing"])
def test_a_wide_map_beside_a_panel_is_larger_than_the_curve(
    size: tuple[int, int], cell: tuple[int, int], columns: int, state: str
) -> None:
    place = arranged(MAPS["cliff"], state, Size(*size))
    assert place.cell == cell
    assert place.regions[DRAW if state == "drawing" else "microscope"].width == columns
    assert 4 * cell[1] > place.regions[CURVE].height


@pytest.mark.parametrize(("size", "most"), [((80, 24), 5), ((100, 30), 5), ((120, 40), 10), ((160, 50), 10)])
def test_a_curve_beside_a_panel_is_low(size: tuple[int, int], most: int) -> None:
    for name, state in product(SHAPES, ["panel", "drawing", "drawing, panel"]):
        assert arranged(SHAPES[name], state, Size(*size)).regions[CURVE].height <= most, (name, state)


@pytest.mark.parametrize("state", ["plain", "lesson"])
def test_at_80x24_the_table_shows_ten_arms(state: str) -> None:
    assert arranged(SHAPES["bandit"], state, Size(80, 24)).regions[TABLE].height >= 10 + 3


@pytest.mark.parametrize(
    ("name", "cell", "columns"), [("lake", (9, 4), 40), ("cliff", (3, 2), 40), ("maze", (4, 2), 40)]
)
def test_at_80x24_a_page_that_points_at_the_world_or_at_nothing_has_a_small_map(
    name: str, cell: tuple[int, int], columns: int
) -> None:
    place = arranged(MAPS[name], "lesson, looked at", Size(80, 24))
    assert place == arranged(MAPS[name], "lesson, read", Size(80, 24))
    assert place.cell == cell
    assert place.regions.keys() == {WORLD, LESSON}
    assert place.regions[LESSON].width == columns
    assert place.regions[WORLD].bottom <= 18
    assert arranged(MAPS[name], "lesson, looked at", Size(60, 18)).regions.keys() == {LESSON}


@pytest.mark.parametrize("name", SHAPES)
def test_before_the_first_step_a_lesson_shows_no_empty_panel_and_the_world_has_their_rows(name: str) -> None:
    size, shape = Size(120, 40), replace(SHAPES[name], has_lesson=True)
    fresh = replace(shape, is_fresh=True)
    before, after = arrange(size, fresh), arrange(size, shape)
    assert before.regions.keys() == {WORLD, CONTROLS, LESSON}
    assert before.cell.area >= after.cell.area
    assert before.regions[WORLD].height >= after.regions[WORLD].height
    for panel in (TABLE, CURVE, LAST_STEP):
        assert panel in arrange(size, replace(fresh, spotlight=panel)).regions
    alone = replace(shape, shown=frozenset({WORLD, CONTROLS}))
    assert arrange(size, alone) == arrange(size, replace(alone, is_fresh=True)), "it need not shrink"


def test_two_wide_maps_lie_one_above_the_other() -> None:
    place = arranged(MAPS["cliff"], "lanes", Size(120, 40))
    left, right = place.regions[WORLD], place.regions[beside(WORLD)]
    assert (left.x, left.bottom) == (right.x, right.y)
    assert left.right - 12 * place.cell.width >= 28, "name and results of each have room beside its map"
    place = arranged(MAPS["lake"], "lanes", Size(120, 40))
    assert place.regions[WORLD].y == place.regions[beside(WORLD)].y


def test_what_says_by_what_a_program_learns_stands_where_the_sliders_do() -> None:
    plain, program = (arranged(MAPS["lake"], each, Size(120, 40)).regions for each in ("plain", "program"))
    assert program[PROGRAM] == plain[CONTROLS]
    assert CONTROLS not in program


def test_tools_of_drawing_leave_the_world_in_view_on_a_small_screen_too() -> None:
    regions = arranged(MAPS["lake"], "drawing", Size(60, 18)).regions
    assert {WORLD, DRAW} <= regions.keys()
    assert TABLE not in regions


@pytest.mark.parametrize(
    ("rows", "columns", "width", "height", "cell"),
    [
        (4, 4, 100, 16, (11, 4)),
        (4, 4, 100, 4, (7, 1)),
        (4, 4, 6, 4, (1, 1)),
        (29, 23, 80, 12, (3, 1)),
        (50, 4, 80, 12, (3, 1)),
    ],
)
def test_cells_are_as_tall_as_fits_then_as_wide(
    rows: int, columns: int, width: int, height: int, cell: tuple[int, int]
) -> None:
    assert cell_size(rows, columns, width, height) == cell


@pytest.mark.parametrize(("size", "rows"), [((60, 18), 8), ((80, 24), 10), ((120, 40), 13), ((160, 50), 17)])
def test_a_chain_lies_above_all_else_and_grows_with_the_screen(size: tuple[int, int], rows: int) -> None:
    long, short = (arrange(Size(*size), SHAPES[name]).regions for name in ("long walk", "walk"))
    for regions in (long, short):
        assert regions[TABLE].y > regions[WORLD].bottom
        assert regions[WORLD].width >= size[0] - 4
    assert short[WORLD].height == rows


@pytest.mark.parametrize(
    ("size", "cell"), [((60, 18), (2, 1)), ((80, 24), (3, 1)), ((120, 40), (5, 2)), ((160, 50), (9, 4))]
)
def test_bins_keep_their_size_below_a_body(size: tuple[int, int], cell: tuple[int, int]) -> None:
    place = arrange(Size(*size), SHAPES["bins of a body"])
    assert place.cell == cell
    around = place.regions[WORLD].height - 1 - 6 * place.cell.height
    assert 4 <= around - 1 <= 9
