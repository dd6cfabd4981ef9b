"""The layout of a chart, with names at the right ends of curves."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final

from rl_tui.studies.pictures import colours
from rl_tui.studies.pictures.picture import Chart, ChartCurve
from rl_tui.studies.pictures.shapes import Disc, Path, Point, Rectangle, Shape, Text, fitting, text_width

SIZE: Final = 12.0
_TITLE_SIZE: Final = 13.5
_TITLE_LINE: Final = 20.0
_LABEL_LINE: Final = 18.0
_TICK: Final = 5.0
_HEIGHT: Final = 250.0
_NAME_LINE: Final = 17.0
_SAMPLE: Final = 26.0
_MOST_NAME: Final = 220.0
_GAP: Final = 8.0
_MARK: Final = 3.4
_ALIKE: Final = 6.0  # pixels; closer ends keep the given order
_DENSE: Final = 300  # points; denser lines are thinner
_BAND_OPACITY: Final = 0.18


def chart_shapes(chart: Chart, left: float, top: float, width: float) -> tuple[float, list[Shape]]:
    """Return the bottom of the chart and its shapes."""
    names = [fitting(curve.name, SIZE, _MOST_NAME) for curve in chart.curves]
    values = max((text_width(label, SIZE) for label in chart.y.labels), default=0.0) + _TICK + 4
    widest = max((text_width(name, SIZE) for name in names), default=0.0)
    legend = widest + _SAMPLE + 2 * _GAP if any(names) else _GAP
    y = top
    shapes: list[Shape] = []
    if chart.title:
        y += _TITLE_LINE
        shapes.append(
            Text(left, y - 5, fitting(chart.title, _TITLE_SIZE, width), _TITLE_SIZE, colours.TEXT, bold=True)
        )
    if chart.y.label:
        y += _LABEL_LINE
        shapes.append(Text(left, y - 5, fitting(chart.y.label, SIZE, width), SIZE, colours.DIM))
    y += _TICK
    height = max(_HEIGHT, _NAME_LINE * len(names))
    box = Rectangle(left + values, y, width - values - legend, height)
    shapes += _axes(chart, box)
    places = [_points(chart, box, curve) for curve in chart.curves]
    for curve, points in zip(chart.curves, places, strict=True):
        shapes += _band(chart, box, curve)
        if chart.connected:
            shapes += _line(curve, points, box)
    if chart.has_few_points:
        for curve, points in zip(chart.curves, places, strict=True):
            shapes += _marks(curve, points, box)
    if any(names):
        shapes += _names(chart.curves, names, places, box)
    return box.bottom + _TICK + 2 * _LABEL_LINE, shapes


def _axes(chart: Chart, box: Rectangle) -> Iterator[Shape]:
    for share, label in zip(chart.y.tick_shares, chart.y.labels, strict=True):
        y = box.bottom - share * box.height
        yield Path(((box.left - _TICK, y), (box.right, y)), stroke=colours.GRID)
        yield Text(box.left - _TICK - 3, y + SIZE / 3, label, SIZE, colours.TEXT, anchor="end")
    for share, label in zip(chart.x.tick_shares, chart.x.labels, strict=True):
        x = box.left + share * box.width
        yield Path(((x, box.bottom), (x, box.bottom + _TICK)), stroke=colours.FRAME)
        yield Text(x, box.bottom + _TICK + SIZE, label, SIZE, colours.TEXT, anchor="middle")
    yield Path(((box.left, box.top), (box.left, box.bottom), (box.right, box.bottom)), stroke=colours.FRAME)
    below = box.bottom + _TICK + _LABEL_LINE + SIZE
    yield Text(
        box.left + box.width / 2,
        below,
        fitting(chart.x.label, SIZE, box.width),
        SIZE,
        colours.DIM,
        anchor="middle",
    )


def _place(chart: Chart, box: Rectangle, x: float, y: float) -> Point:
    # values far outside are clipped anyway, and would be long numbers
    share = min(max(chart.y.share(y), -9.0), 9.0)
    return box.left + chart.x.share(x) * box.width, box.bottom - share * box.height


def _points(chart: Chart, box: Rectangle, curve: ChartCurve) -> list[list[Point]]:
    return [
        [
            _place(chart, box, curve.x[place], value)
            for place in stretch
            if (value := curve.y[place]) is not None
        ]
        for stretch in curve.stretches
    ]


def _band(chart: Chart, box: Rectangle, curve: ChartCurve) -> Iterator[Shape]:
    for stretch in curve.band_stretches:
        if not chart.connected or len(stretch) == 1:
            yield from _intervals(chart, box, curve, stretch)
            continue
        edges = [
            [
                _place(chart, box, curve.x[place], value)
                for place in stretch
                if (value := edge[place]) is not None
            ]
            for edge in (curve.high, curve.low)
        ]
        yield Path(
            (*edges[0], *reversed(edges[1])),
            fill=colours.line_colour(curve.colour),
            opacity=_BAND_OPACITY,
            closed=True,
            clip=box,
        )


def _intervals(chart: Chart, box: Rectangle, curve: ChartCurve, places: range) -> Iterator[Shape]:
    colour = colours.line_colour(curve.colour)
    for place in places:
        low, high = curve.low[place], curve.high[place]
        if low is not None and high is not None:
            ends = (_place(chart, box, curve.x[place], low), _place(chart, box, curve.x[place], high))
            yield Path(ends, stroke=colour, width=1.8, clip=box)
            for x, y in ends:
                yield Path(((x - _MARK, y), (x + _MARK, y)), stroke=colour, width=1.8, clip=box)


def _line(curve: ChartCurve, stretches: Sequence[Sequence[Point]], box: Rectangle) -> Iterator[Shape]:
    colour, dash = _look(curve)
    for points in stretches:
        if len(points) > 1:
            yield Path(
                tuple(points), stroke=colour, width=1.2 if len(points) > _DENSE else 1.8, dash=dash, clip=box
            )
        else:
            yield Disc(*points[0], 2.0, colour, clip=box)


def _marks(curve: ChartCurve, stretches: Sequence[Sequence[Point]], box: Rectangle) -> Iterator[Shape]:
    for points in stretches:
        for x, y in points:
            if box.top - 1 <= y <= box.bottom + 1:
                yield _mark(curve, x, y)


def _mark(curve: ChartCurve, x: float, y: float) -> Shape:
    colour, _ = _look(curve)
    fill = colours.BACKGROUND if curve.dashed else colour
    corners = (0, 4, 3, 5)[curve.colour % 4]
    if not corners:
        return Disc(x, y, _MARK, fill, stroke=colour)
    turns = [math.pi * (2 * corner / corners - (0.75 if corners == 4 else 0.5)) for corner in range(corners)]
    radius = 1.25 * _MARK
    points = tuple((x + radius * math.cos(turn), y + radius * math.sin(turn)) for turn in turns)
    return Path(points, stroke=colour, width=1.2, fill=fill, closed=True)


def _look(curve: ChartCurve) -> tuple[str, str]:
    return colours.line_colour(curve.colour), colours.line_dash(curve.colour, dashed=curve.dashed)


def _names(
    curves: Sequence[ChartCurve],
    names: Sequence[str],
    places: Sequence[Sequence[Sequence[Point]]],
    box: Rectangle,
) -> Iterator[Shape]:
    ends = [
        min(max(stretches[-1][-1][1], box.top), box.bottom) if stretches else box.bottom
        for stretches in places
    ]
    order = sorted(range(len(curves)), key=lambda place: round(ends[place] / _ALIKE))
    heights = spread([ends[place] for place in order], _NAME_LINE, box.top, box.bottom)
    left = box.right + _GAP
    for place, y in zip(order, heights, strict=True):
        colour, dash = _look(curves[place])
        yield Path(((left, y), (left + _SAMPLE, y)), stroke=colour, width=2.2, dash=dash)
        yield Text(left + _SAMPLE + _GAP / 2, y + SIZE / 3, names[place], SIZE, colours.TEXT)


def spread(wanted: Sequence[float], apart: float, first: float, last: float) -> list[float]:
    """Move ascending positions as little as needed to be at least `apart`, in [`first`, `last`].

    Neighbours share the displacement. Without enough space, positions exceed `last`.
    """
    groups: list[list[float]] = []  # wanted positions of each group
    for value in wanted:
        groups.append([value])
        while len(groups) > 1 and _start(groups[-1], apart, first, last) < (
            _start(groups[-2], apart, first, last) + len(groups[-2]) * apart
        ):
            groups[-2:] = [[*groups[-2], *groups[-1]]]
    return [
        _start(group, apart, first, last) + place * apart for group in groups for place in range(len(group))
    ]


def _start(group: Sequence[float], apart: float, first: float, last: float) -> float:
    length = (len(group) - 1) * apart
    return max(first, min(sum(group) / len(group) - length / 2, last - length))
