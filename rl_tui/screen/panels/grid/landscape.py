"""A map as a landscape: V is its height, lit from the upper left, with contour lines.

A character has two pixels. Half of a height is the rank of V, so that plateaus have slopes too.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from rich.color import Color, ColorSystem, ColorType, blend_rgb
from rich.color_triplet import ColorTriplet
from rich.segment import Segment
from rich.style import Style
from textual.geometry import Size
from textual.strip import Strip

from rl_tui.screen.draw.scale import round_step
from rl_tui.screen.kit.value_scale import ValueScale
from rl_tui.screen.panels.grid.cells import MOST_ROWS
from rl_tui.screen.panels.grid.map import CellContent, MapPart
from rl_tui.screen.panels.grid.marks import SEVERAL, sign_text
from rl_tui.screen.theme.look import Look
from rl_tui.screen.theme.roles import Palette, contrast
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.mdp.space import FloatArray, IntArray
from rl_tui.worlds.world import World

_LEAST_CELL: Final = Size(5, 2)
_LEAST_RELIEF: Final = 0.05  # share of the scale: smaller differences of V are not visible
_HALF: Final = "▀"
_LIGHTS: Final = 6  # steps of light, and equally many of shade
_MOST_LIGHT: Final = 0.3  # share by which the brightest slope is brighter than a plain
_STEEPNESS: Final = 1.0  # of light per rise of the scale from cell to cell
_RANKS: Final = 0.5  # share of the rank in a height, beside V
_ALIKE: Final = 500  # parts of the scale: values within one have the same rank
_LEAST_LINES: Final = 8  # approximate steps of the scale
_MOST_LINES: Final = 80
_CELLS_A_LINE: Final = 1.5  # for the typical difference between cells
_CLOSEST: Final = 2.5  # pixels between lines: steeper slopes have none
_INKS: Final = (0.0, 0.4)  # share of black in a pixel: none, line
_TINTS: Final = 33  # odd, so that 0 has its own on a signed scale
_MOST_KEPT: Final = 4_096
_BLACK, _WHITE = ColorTriplet(0, 0, 0), ColorTriplet(255, 255, 255)


class Plate(NamedTuple):
    """A ``text`` over the landscape."""

    x: int
    text: str
    style: Style | None = None


def has_landscape(world: World, cell: Size | None, look: Look) -> bool:
    """Return whether such cells can be a landscape."""
    is_large = cell is not None and cell.width >= _LEAST_CELL.width and cell.height >= _LEAST_CELL.height
    return is_large and isinstance(world.drawing, Grid) and look.palette.has_shades and look.glyphs.braille


def has_relief(values: Sequence[float], scale: ValueScale) -> bool:
    """Return whether ``values`` of states differ visibly."""
    low, high = scale.ends
    return high > low and max(values, default=low) - min(values, default=low) > _LEAST_RELIEF * (high - low)


def line_step(values: FloatArray, scale: ValueScale) -> float:
    """Return the step of the lines: 1, 2 or 5 times a power of ten.

    Neighbours in ``values``, [rows, columns], are about two thirds of it apart.
    """
    low, high = scale.ends
    apart = np.abs(np.concatenate([np.diff(values, axis=axis).ravel() for axis in (0, 1)]))
    apart = apart[apart > (high - low) / _ALIKE]  # without NaN
    usual = float(np.median(apart)) * _CELLS_A_LINE if len(apart) else high - low
    return round_step(max((high - low) / _MOST_LINES, min(usual, (high - low) / _LEAST_LINES)))


def relief(values: FloatArray, scale: ValueScale) -> FloatArray:
    """Return heights, 0 to 1, from V's place on its scale and its rank. On a signed scale, 0 is at .5."""
    low, high = scale.ends
    base = 0.0 if scale.is_signed else low
    share = ((values - base) / (high - base)).clip(-1.0, 1.0)
    size = np.rint(np.abs(share) * _ALIKE)
    known = np.unique(np.append(0.0, size[np.isfinite(size)]))
    rank = np.searchsorted(known, size) / max(1, len(known) - 1)
    found = np.sign(share) * ((1.0 - _RANKS) * np.abs(share) + _RANKS * rank)
    return np.asarray((1.0 + found) / 2.0 if scale.is_signed else found)


def heights(values: FloatArray, cell: Size) -> FloatArray:
    """Return V of each pixel, from ``values`` of cells, [rows, columns], NaN in walls.

    Beside walls and edges, a cell continues its own value.
    """
    rows, columns = values.shape
    down, across = 2 * cell.height, cell.width
    own = np.repeat(np.repeat(values, down, axis=0), across, axis=1)
    y, x = (np.arange(rows * down) + 0.5) / down - 0.5, (np.arange(columns * across) + 0.5) / across - 0.5
    top, left = np.floor(y).astype(int), np.floor(x).astype(int)
    found = np.zeros_like(own)
    for i, part_y in ((top, 1.0 - (y - top)), (top + 1, y - top)):
        for j, part_x in ((left, 1.0 - (x - left)), (left + 1, x - left)):
            corner = values[i.clip(0, rows - 1)][:, j.clip(0, columns - 1)]
            found += np.outer(part_y, part_x) * np.where(np.isnan(corner), own, corner)
    return found


def _around(values: FloatArray) -> FloatArray:
    """Return each cell with its neighbours, [rows, columns, 3, 3], NaN beyond an edge."""
    return sliding_window_view(np.pad(values, 1, constant_values=math.nan), (3, 3))


def _slopes(values: FloatArray) -> FloatArray:
    """Return how far cells rise to the lower right. Walls and edges are level."""
    near = _around(values)[..., (1, 2, 1, 0), (2, 1, 0, 1)] - values[..., None]
    return np.asarray(np.nan_to_num(near) @ (0.5, 0.5, -0.5, -0.5))


def pixels(values: FloatArray, cell: Size, scale: ValueScale, every: float) -> IntArray:
    """Return each pixel's index into :func:`_colours`, −1 in walls.

    Lines are ``every`` apart, unless they would touch. None is at 0, where plains often are.
    """
    down, across = 2 * cell.height, cell.width
    z, shown = heights(values, cell), relief(values, scale)
    tint = np.rint(np.nan_to_num(heights(shown, cell)) * (_TINTS - 1)).astype(np.int64)
    slope = _STEEPNESS * heights(_slopes(shown), cell)
    light = np.rint(slope.clip(-1.0, 1.0) * _LIGHTS).astype(np.int64) + _LIGHTS
    step = np.floor(z / every + 0.5 + 1e-9)
    is_line = np.zeros(z.shape, dtype=np.bool_)
    is_line[:, 1:] = np.abs(np.diff(step, axis=1)) > 0.0
    is_line[1:] |= np.abs(np.diff(step, axis=0)) > 0.0
    near = _around(values)
    spread = np.fmax.reduce(near, axis=(2, 3)) - np.fmin.reduce(near, axis=(2, 3))
    is_steep = spread * _CLOSEST > 2.0 * every * min(down, across)
    is_line &= ~np.kron(is_steep, np.ones((down, across), dtype=np.bool_))
    return np.where(np.isnan(z), -1, (tint * (2 * _LIGHTS + 1) + light) * len(_INKS) + is_line)


def _values(cells: Sequence[CellContent], part: MapPart, scale: ValueScale) -> FloatArray:
    """Return V of ``cells``, [rows, columns], with extremes at goals and holes."""
    low, high = scale.ends
    ends = {CellKind.GOAL: high, CellKind.HOLE: low, CellKind.CLIFF: low}
    values = [ends.get(each.kind, math.nan) if each.value is None else each.value for each in cells]
    return np.array(values).reshape(part.rows, part.columns)


def _plates(cells: Sequence[CellContent], part: MapPart, cell: Size, look: Look) -> list[tuple[Plate, ...]]:
    plates: list[list[Plate]] = [[] for _ in range(part.rows * cell.height)]
    for place, content in enumerate(cells):
        row, column = divmod(place, part.columns)
        x, line = column * cell.width + (cell.width - 1) // 2, row * cell.height + (cell.height - 1) // 2
        plates[line] += _plates_of(content, x, cell.width, look)
    return [tuple(each) for each in plates]


def _plates_of(content: CellContent, x: int, width: int, look: Look) -> Iterator[Plate]:
    palette, glyphs = look.palette, look.glyphs
    ends = {
        CellKind.HOLE: Plate(x - 1, f" {glyphs.hole} ", palette.hole),
        CellKind.CLIFF: Plate(x - 1, glyphs.cliff * 3, palette.cliff),
        CellKind.GOAL: Plate(x - 1, f" {glyphs.goal} ", palette.goal),
    }
    text = "".join(sign_text(each, look) for each in content.greedy)
    text = text if len(text) < width - 1 else SEVERAL
    if content.value is None and content.kind in ends:
        yield ends[content.kind]
    elif text:
        yield Plate(x - (len(text) - 1) // 2, text, palette.focus if content.cursor else None)
    if content.agent:
        yield Plate(x - 1, f" {glyphs.agent} ", palette.agent)
    elif content.cursor and not text:
        yield Plate(x, " ", palette.focus)
    if content.stops:
        yield Plate(x - 2, glyphs.breakpoint, palette.breakpoint)
    if content.differs:
        yield Plate(x - (width - 1) // 2, glyphs.differs, palette.text)


class LandscapeArtist:
    """Draws equal rows only once."""

    def __init__(self, look: Look) -> None:
        self.look = look
        self.step = 0.0
        """The step of the lines of the last landscape."""
        self._pixels: tuple[object, IntArray] | None = None
        self._row = lru_cache(MOST_ROWS)(self._drawn_row)
        self._pair = lru_cache(_MOST_KEPT)(self._style)
        self._ink = lru_cache(_MOST_KEPT)(self._ink_on)

    def strips(
        self, cells: Sequence[CellContent], part: MapPart, cell: Size, scale: ValueScale, size: Size
    ) -> list[Strip] | None:
        """Draw a landscape, if not flat."""
        if not has_relief([each.value for each in cells if each.value is not None], scale):
            return None
        values = _values(cells, part, scale)
        key = values.tobytes(), values.shape, cell, scale
        if self._pixels is None or self._pixels[0] != key:
            self.step = line_step(values, scale)
            self._pixels = key, pixels(values, cell, scale, self.step)
        found = self._pixels[1]
        width, height = size
        text, plates = self.look.palette.text, _plates(cells, part, cell, self.look)
        blank = Strip([Segment(" " * width, text)], width)
        after, rows = Segment(" " * (width - found.shape[1]), text), list[Strip]()
        for y in range(part.rows * cell.height):
            row = self._row(found[2 * y : 2 * y + 2].tobytes(), plates[y], scale.is_signed)
            rows.append(Strip([*row, after], width))
        return rows + [blank] * (height - len(rows))

    def _drawn_row(self, row: bytes, plates: tuple[Plate, ...], is_signed: bool) -> Strip:
        upper, lower = np.frombuffer(row, dtype=np.int64).reshape(2, -1)
        last = len(upper)
        signs = {
            column: Segment(sign, style or self._ink(int(upper[column]), is_signed))
            for x, text, style in plates
            for column, sign in enumerate(text, start=x)
        }
        changes = np.flatnonzero(np.diff(upper) | np.diff(lower)) + 1
        starts = sorted({0, last, *changes.tolist(), *signs, *(column + 1 for column in signs)})
        above, below = upper.tolist(), lower.tolist()
        segments = []
        for start, end in pairwise(starts):
            style = self._pair(above[start], below[start], is_signed)
            segments.append(signs.get(start) or Segment(_HALF * (end - start), style))
        return Strip(segments, last)

    def _style(self, upper: int, lower: int, is_signed: bool) -> Style:
        return Style(color=self._colour(upper, is_signed), bgcolor=self._colour(lower, is_signed))

    def _ink_on(self, pixel: int, is_signed: bool) -> Style:
        ground = self._colour(pixel, is_signed)
        inks = map(Color.from_triplet, (_BLACK, _WHITE))
        return Style(color=max(inks, key=lambda ink: contrast(ink, ground)), bgcolor=ground, bold=True)

    def _colour(self, pixel: int, is_signed: bool) -> Color:
        return _colours(self.look.palette, is_signed)[pixel]


@lru_cache(8)
def _colours(palette: Palette, is_signed: bool) -> tuple[Color, ...]:
    ramp = [each.bgcolor for each in (palette.signed if is_signed else palette.values)]
    wall = palette.wall.bgcolor
    assert wall is not None
    steps = [each.get_truecolor() for each in ramp if each is not None]
    found = []
    for tint in range(_TINTS):
        part, at = math.modf(tint * (len(steps) - 1) / (_TINTS - 1))
        base = blend_rgb(steps[int(at)], steps[min(int(at) + 1, len(steps) - 1)], part)
        for light in range(-_LIGHTS, _LIGHTS + 1):
            # brighter in its own hue: white would be a haze over dark valleys
            more = 1.0 + _MOST_LIGHT * light / _LIGHTS
            lit = ColorTriplet(*(min(255, round(part * more)) for part in base))
            found += [blend_rgb(lit, _BLACK, ink) for ink in _INKS]
    colours = [Color.from_triplet(each) for each in found]
    if ramp[0] is not None and ramp[0].type is ColorType.EIGHT_BIT:
        colours = [each.downgrade(ColorSystem.EIGHT_BIT) for each in colours]
    return *colours, wall
