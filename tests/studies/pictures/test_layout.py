"""No text is truncated, and no texts overlap."""

from __future__ import annotations

from itertools import combinations, pairwise

import pytest
from drawn_samples import atlas, chart, curve, picture
from hypothesis import given
from hypothesis import strategies as st

from rl_tui.studies.pictures import colours
from rl_tui.studies.pictures.chart_layout import spread
from rl_tui.studies.pictures.layout import laid_out
from rl_tui.studies.pictures.picture import Picture
from rl_tui.studies.pictures.shapes import (
    Disc,
    DrawnPage,
    Path,
    Rectangle,
    Text,
    fitting,
    text_width,
    wrapped,
)

LONG = "Expected SARSA with a name that is much too long to stand beside a chart, asymptotic"
MANY = [curve(f"line {place}", [0.0, 1.0 + place / 100], place) for place in range(14)]
PICTURES = {
    "one curve": picture(chart(curve("", [1.0, 2.0, 3.0]))),
    "long names": picture(chart(curve(LONG, [1.0, 2.0]), curve(LONG, [2.0, 1.0], 1)), notes=(LONG * 3,)),
    "many curves that end alike": picture(chart(*MANY)),
    "large numbers": picture(chart(curve("a", [-123456.0, 98765.0]))),
    "a small atlas": picture(atlas([[1.0, 2.0], [3.0, None]], best=(1, 0))),
    "a large atlas": picture(atlas([[float(row * column) for column in range(60)] for row in range(50)])),
    "an atlas with long names": picture(
        atlas([[-1234.5] * 9] * 3, rows=("a long name of a row", "b", "c"), columns=("much longer",) * 9)
    ),
    "two panels": picture(
        chart(curve("a", [1.0, 2.0])), atlas([[1.0, 2.0]], alike=((True, False),)), band="Bands: none."
    ),
}


def box_of(text: Text) -> Rectangle:
    width = text_width(text.text, text.size)
    left = text.x - {"start": 0.0, "middle": width / 2, "end": width}[text.anchor]
    return Rectangle(left, text.y - 0.75 * text.size, width, text.size)


def texts(page: DrawnPage) -> list[Text]:
    return [shape for shape in page.shapes if isinstance(shape, Text) and shape.text]


def overlap(one: Rectangle, other: Rectangle) -> bool:
    return (
        one.left < other.right
        and other.left < one.right
        and one.top < other.bottom
        and other.top < one.bottom
    )


@pytest.mark.parametrize("drawn", PICTURES.values(), ids=PICTURES)
def test_all_texts_stand_on_the_page_and_apart(drawn: Picture) -> None:
    page = laid_out(drawn)
    boxes = [box_of(text) for text in texts(page)]
    assert all(box.left >= 0 and box.right <= page.width for box in boxes)
    assert all(box.top >= 0 and box.bottom <= page.height for box in boxes)
    assert [pair for pair in combinations(boxes, 2) if overlap(*pair)] == []


@pytest.mark.parametrize("drawn", PICTURES.values(), ids=PICTURES)
def test_all_that_is_not_clipped_stands_on_the_page(drawn: Picture) -> None:
    page = laid_out(drawn)
    for shape in page.shapes:
        if isinstance(shape, Path) and shape.clip is None:
            assert all(0 <= x <= page.width and 0 <= y <= page.height for x, y in shape.points)


def test_the_first_shape_is_the_background() -> None:
    page = laid_out(PICTURES["one curve"])
    first = page.shapes[0]
    assert isinstance(first, Path)
    assert first.fill == colours.BACKGROUND
    assert first.points == Rectangle(0.0, 0.0, page.width, page.height).corners


def test_curves_are_cut_at_the_axes_and_named_where_they_end() -> None:
    rising, falling = curve("rising", [0.0, 10.0]), curve("falling", [10.0, -990.0], 1)
    axes = chart(curve("", [0.0, 10.0]))
    page = laid_out(picture(type(axes)("", axes.x, axes.y, (falling, rising))))
    lines = [shape for shape in page.shapes if isinstance(shape, Path) and shape.clip and not shape.closed]
    clip = lines[0].clip
    assert max(y for _, y in lines[0].points) > clip.bottom
    named = {text.text: text.y for text in texts(page)}
    assert named["rising"] < named["falling"] <= clip.bottom + 17


def test_a_gap_parts_a_line() -> None:
    page = laid_out(picture(chart(curve("a", [1.0, 2.0, None, 3.0, 2.0, None, 5.0]))))
    lines = [shape for shape in page.shapes if isinstance(shape, Path) and shape.clip]
    assert [len(line.points) for line in lines] == [2, 2]


def test_a_band_goes_around_its_curve() -> None:
    page = laid_out(picture(chart(curve("a", [1.0, 2.0, 3.0], low=(0.5, 1.0, 2.5), high=(1.5, 3.0, 3.5)))))
    (band,) = [shape for shape in page.shapes if isinstance(shape, Path) and shape.opacity < 1]
    (line,) = [shape for shape in page.shapes if isinstance(shape, Path) and shape.clip and not shape.closed]
    upper, lower = band.points[:3], band.points[:2:-1]
    for (x, y), high, low in zip(line.points, upper, lower, strict=True):
        assert x == high[0] == low[0]
        assert high[1] < y < low[1]


def test_points_that_nothing_joins_have_their_intervals() -> None:
    points = curve("a", [1.0, 2.0], low=(0.5, None), high=(1.5, None))
    page = laid_out(picture(chart(points, connected=False)))
    bars = [shape for shape in page.shapes if isinstance(shape, Path) and shape.clip]
    assert len(bars) == 3  # one line with two ends
    assert not [shape for shape in bars if shape.closed]


def test_cells_have_the_colour_of_their_value_and_the_best_a_frame() -> None:
    drawn = atlas([[0.0, 5.0], [10.0, None]], best=(1, 0), alike=((False, True), (True, False)))
    page = laid_out(picture(drawn))
    fills = [shape.fill for shape in page.shapes if isinstance(shape, Path) and shape.closed and shape.fill]
    assert fills[1:5] == [
        colours.ramp_colour(0.0),
        colours.ramp_colour(0.5),
        colours.ramp_colour(1.0),
        colours.MISSING,
    ]
    dots = [shape for shape in page.shapes if isinstance(shape, Disc)]
    assert len(dots) == 2  # of the tied cell, and of the line that explains it
    said = [text.text for text in texts(page)]
    assert {"0", "5", "10", "the best", "tied with the best"} <= set(said)


def test_cells_without_room_have_no_numbers() -> None:
    page = laid_out(PICTURES["a large atlas"])
    assert len(texts(page)) < 100


@given(st.lists(st.floats(0, 250), min_size=1, max_size=14).map(sorted))
def test_names_stand_apart_in_their_order_and_within_the_chart(wanted: list[float]) -> None:
    placed = spread(wanted, 17.0, 0.0, 250.0)
    assert all(later - earlier >= 17.0 - 1e-6 for earlier, later in pairwise(placed))
    assert min(placed) >= -1e-6
    assert max(placed) <= 250.0 + 1e-6


def test_names_with_room_stand_where_they_want() -> None:
    assert spread([10.0, 100.0, 240.0], 17.0, 0.0, 250.0) == [10.0, 100.0, 240.0]
    assert spread([100.0, 100.0], 20.0, 0.0, 250.0) == [90.0, 110.0]


def test_texts_are_cut_and_wrapped_to_the_room_there_is() -> None:
    assert fitting("short", 12, 200) == "short"
    cut = fitting(LONG, 12, 100)
    assert cut.endswith("…")
    assert text_width(cut, 12) <= 100
    lines = wrapped(LONG, 12, 150)
    assert " ".join(lines) == LONG
    assert all(text_width(line, 12) <= 150 for line in lines)
