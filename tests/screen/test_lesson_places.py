"""Where the page of a lesson stands, and what it leaves to the run."""

from __future__ import annotations

from dataclasses import replace

import pytest
from test_arrangement import SHAPES
from textual.geometry import Size

from rl_tui.screen.frame.arrangement import Shape, arrangement, beside_lesson, docks_lesson, has_lines_below
from rl_tui.screen.kit.row import CONTROLS, CURVE, LAST_STEP, LESSON, MICROSCOPE, TABLE, WORLD
from rl_tui.screen.panels.catalogue import PANELS

SIZES = [(60, 16), (80, 22), (99, 60), (100, 31), (100, 32), (120, 38), (160, 48), (250, 80)]
everywhere = pytest.mark.parametrize("size", SIZES)
every_shape = pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES.keys())


def with_lesson(shape: Shape, *, reads: bool = False, lanes: bool = False) -> Shape:
    return replace(shape, has_lesson=True, reads=reads, lanes=lanes)


@every_shape
@everywhere
@pytest.mark.parametrize("lanes", [False, True])
@pytest.mark.parametrize("opened", [None, *(row.id for row in PANELS if row.opened_by)])
def test_page_and_panels_cover_the_board(
    size: tuple[int, int],
    shape: Shape,
    opened: str | None,
    lanes: bool,
) -> None:
    board = Size(*size)
    regions = list(arrangement(board, with_lesson(shape, lanes=lanes), None, opened).values())
    assert sum(region.area for region in regions) == board.area
    for number, region in enumerate(regions):
        assert board.region.contains_region(region)
        assert not any(region.overlaps(other) for other in regions[:number])


@every_shape
@everywhere
def test_a_page_is_docked_where_there_is_room_else_it_has_a_row(size: tuple[int, int], shape: Shape) -> None:
    board = Size(*size)
    page = arrangement(board, with_lesson(shape))[LESSON]
    if docks_lesson(board):
        assert page.right == board.width
        assert page.height == board.height
        assert 40 <= page.width <= 56
        assert board.width - page.width >= 60
    else:
        assert page.size == Size(board.width, 1)
        assert arrangement(board, with_lesson(shape, reads=True)) == {LESSON: board.region}


def test_120x40_leaves_76_columns_to_the_run() -> None:
    size = Size(120, 38)
    regions = arrangement(size, with_lesson(SHAPES["lake 4x4"], reads=True))
    assert beside_lesson(size, with_lesson(SHAPES["lake 4x4"])).size == Size(76, 38)
    assert regions[LESSON].width == 44
    assert regions[WORLD].height == 14
    assert regions[LAST_STEP].size == Size(76, 8)
    assert regions[CONTROLS].height == 2
    assert has_lines_below(size, with_lesson(Shape()))


@everywhere
def test_zoomed_or_opened_panels_leave_the_page_where_it_is(size: tuple[int, int]) -> None:
    board, shape = Size(*size), with_lesson(SHAPES["student"])
    page = arrangement(board, shape)[LESSON]
    rest = beside_lesson(board, shape)
    assert arrangement(board, shape, TABLE) == {TABLE: rest, LESSON: page}
    assert arrangement(board, shape, None, MICROSCOPE)[LESSON] == page
    assert arrangement(board, shape, LESSON) == {LESSON: board.region}


@everywhere
def test_without_a_lesson_there_is_no_page(size: tuple[int, int]) -> None:
    assert LESSON not in arrangement(Size(*size), SHAPES["student"])
    assert CURVE in arrangement(Size(*size), SHAPES["student"])
