"""Pictures of a cart with its pole and of a car on its hill, in the middle of the agent's bins."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from rich.style import Style
from textual.strip import Strip

from rl_tui.screen.draw.block_signs import QUADRANTS
from rl_tui.screen.draw.canvas import Canvas
from rl_tui.screen.panels.margins import LabelledPart, Margins, labelled
from rl_tui.worlds.drawing import BodyKind, Grid

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rl_tui.live.snapshot import Snapshot
    from rl_tui.screen.theme.look import Look

# Bodies


UNSEEN: Final = "cart position not seen"
_TRACK: Final = 2.4  # the cart leaves the track beyond this
_WIDE: Final = 40  # columns from which the cart has its full width
_HIGH: Final = 7  # rows from which cart and car are two rows high
_LOW: Final = 4  # rows of a picture where the readings share the row of the goal
_FALLS: Final = 12.0  # degrees at which an episode ends
_DRAWN: Final = 30.0  # degrees of lean in the picture just before the pole falls
_THICK: Final = 3  # half columns of the pole
_HILL: Final = (-1.2, 0.6)  # positions of the car
_FLAG: Final = 0.5
_EIGHTHS: Final = "▁▂▃▄▅▆▇█"


class Pose(NamedTuple):
    """A body's ``numbers``, the last action, and the hill's ends."""

    kind: BodyKind
    numbers: tuple[float, ...]
    action: str
    ends: tuple[float, float] = _HILL


@lru_cache(512)
def body_strips(pose: Pose, width: int, height: int, look: Look) -> tuple[Strip, ...]:
    """Draw ``pose`` in ``width`` × ``height`` cells."""
    canvas = Canvas(width, height, look.palette.text)
    draw = _draw_cart if pose.kind is BodyKind.CART_POLE else _draw_hill
    draw(canvas, pose, look)
    return tuple(canvas.strips())


def _draw_cart(canvas: Canvas, pose: Pose, look: Look) -> None:
    glyphs, palette = look.glyphs, look.palette
    position, _, angle, _ = pose.numbers
    ground, half = canvas.height - 1, 4 if canvas.width >= _WIDE else 2
    top = ground - (2 if canvas.height >= _HIGH else 1)
    middle = canvas.width // 2
    canvas.put(0, ground, glyphs.thin * canvas.width, palette.dim)
    if not math.isnan(position):
        middle += round(max(-1.0, min(1.0, position / _TRACK)) * (canvas.width / 2 - half - 4))
        ends = f"{-_TRACK}".replace("-", glyphs.minus), f"{_TRACK}"
        canvas.put(0, ground, f"{ends[0]} ", palette.dim)
        canvas.put(canvas.width - len(ends[1]) - 1, ground, f" {ends[1]}", palette.dim)
    for row in range(top, ground):
        canvas.put(middle - half, row, glyphs.bar * (2 * half + 1), palette.text)
    for wheel in (1 - half, half - 1):
        canvas.put(middle + wheel, ground, glyphs.hole, palette.strong)
    reach = math.ceil(math.sin(math.radians(_DRAWN)) * 2 * top)
    for side in (-1, 1):
        _draw_limit(canvas, middle, top, side, look)
    degree = "°" if glyphs.braille else " deg"
    fall, at = f"falls at {_FALLS:.0f}{degree}", middle + reach + 3
    canvas.put(at, 0, fall if at + len(fall) <= canvas.width else "", palette.dim)
    if not math.isnan(angle):
        _draw_pole(canvas, middle, top, angle, look)
    _draw_push(canvas, middle, half + 2, ground - 1, pose.action, look)
    _write_readings(canvas, pose, min(middle - reach, middle - half) - 1, top, look)


def _write_readings(canvas: Canvas, pose: Pose, room: int, rows: int, look: Look) -> None:
    position, _, angle, turning = pose.numbers
    degree = "°" if look.glyphs.braille else " deg"
    texts = (
        (_angles("angle", angle, degree, 1, room, look), look.palette.text),
        (_angles("turning", turning, f"{degree}/s", 0, room, look), look.palette.text),
        (UNSEEN if math.isnan(position) and len(UNSEEN) <= room else "", look.palette.dim),
    )
    for row, (text, style) in enumerate([each for each in texts if each[0]][:rows]):
        canvas.put(0, row, text, style)


def _angles(name: str, value: float, unit: str, decimals: int, room: int, look: Look) -> str:
    degrees = _number(name, math.degrees(value), unit, decimals, look)
    both = f"{_number(name, value, '', 2, look)} ={degrees.removeprefix(name)}" if degrees else ""
    return next((form for form in (both, degrees) if len(form) <= room), "")


def _leaning(degrees: float) -> float:
    return math.radians(max(-60.0, min(60.0, degrees * _DRAWN / _FALLS)))


def _draw_limit(canvas: Canvas, middle: int, rows: int, side: int, look: Look) -> None:
    slope = math.tan(_leaning(_FALLS)) * side
    for row in range(rows):
        canvas.put(round(middle + slope * (2 * (rows - row) - 1)), row, look.glyphs.untried, look.palette.dim)


def _draw_pole(canvas: Canvas, middle: int, rows: int, angle: float, look: Look) -> None:
    lean = _leaning(math.degrees(angle))
    filled = np.zeros((2 * rows, 2 * canvas.width), dtype=np.int64)  # quarter characters
    for half_row in range(2 * rows):
        up = 2 * rows - half_row - 0.5
        left = round(2 * middle + 1 - _THICK / 2 + 2 * math.tan(lean) * up)
        filled[half_row, max(0, left) : max(0, left + _THICK)] = up <= 2 * rows * math.cos(lean)
    bits = filled[::2, ::2] + 2 * filled[::2, 1::2] + 4 * filled[1::2, ::2] + 8 * filled[1::2, 1::2]
    plain = "|" if abs(lean) < 0.1 else "/" if lean > 0.0 else "\\"
    for row, column in np.argwhere(bits).tolist():
        sign = QUADRANTS[bits[row, column]] if look.glyphs.braille else plain
        canvas.put(column, row, sign, look.palette.strong)


def _draw_hill(canvas: Canvas, pose: Pose, look: Look) -> None:
    glyphs, palette = look.glyphs, look.palette
    position, velocity = pose.numbers
    low, high = pose.ends
    car_rows = 2 if canvas.height >= _HIGH else 1
    most = canvas.height - 0.2 - (canvas.height > _LOW) - car_rows

    def level_of(place: float) -> int:
        return round(8 * (0.2 + (math.sin(3.0 * place) * 0.45 + 0.55) * most))

    def column_of(place: float) -> int:
        return round((place - low) / (high - low) * (canvas.width - 1))

    def row_above(place: float) -> int:
        return canvas.height - 1 - math.ceil(level_of(place) / 8)

    for x in range(canvas.width):
        _draw_ground(canvas, x, level_of(low + (high - low) * x / (canvas.width - 1)), look)
    _draw_axis(canvas, pose.ends, look)
    flag = column_of(_FLAG)
    canvas.put(flag, row_above(_FLAG), glyphs.goal, palette.goal)
    canvas.put(flag - 5, row_above(_FLAG), "goal", palette.dim)
    place, speed = _number("position", position, "", 2, look), _number("velocity", velocity, "", 3, look)
    room = canvas.width if canvas.height > _LOW else flag - 6
    forms = (f"{place}   {speed}", place) if place and speed else (place + speed,)
    canvas.put(0, 0, next((form for form in forms if len(form) <= room), ""), palette.text)
    if not math.isnan(position):
        x, y = max(2, min(canvas.width - 3, column_of(position))), row_above(position)
        _draw_car(canvas, x, y, car_rows, look)
        _draw_push(canvas, x, -1, y - car_rows, pose.action, look)  # above the car, clear of the hill


def _draw_ground(canvas: Canvas, x: int, level: int, look: Look) -> None:
    ground = canvas.height - 1
    if not look.glyphs.braille:
        canvas.put(x, ground - (level - 1) // 8, ".", look.palette.dim)
        return
    for row in range(math.ceil(level / 8)):
        canvas.put(x, ground - row, _EIGHTHS[min(7, level - 8 * row - 1)], look.palette.rule)


def _draw_axis(canvas: Canvas, ends: tuple[float, float], look: Look) -> None:
    ink, ground = look.palette.dim, look.palette.rule.color
    style = ink + Style(bgcolor=ground) if look.palette.tints and look.glyphs.braille else ink
    left, right = (f"{end:.3g}".replace("-", look.glyphs.minus) for end in ends)
    canvas.put(0, canvas.height - 1, f"{left} position", style)
    canvas.put(canvas.width - len(right), canvas.height - 1, right, style)


def _draw_car(canvas: Canvas, x: int, y: int, rows: int, look: Look) -> None:
    glyphs, strong = look.glyphs, look.palette.strong
    if not glyphs.braille:
        canvas.put(x - 1, y, "[#]", strong)
    elif rows == 1:
        canvas.put(x - 1, y, "▟█▙", strong)
    else:
        canvas.put(x - 1, y - 1, "▟█▙", strong)
        canvas.put(x - 2, y, f" {glyphs.hole} {glyphs.hole} ", strong + Style(reverse=True))


def _draw_push(canvas: Canvas, middle: int, beside: int, y: int, action: str, look: Look) -> None:
    glyphs = look.glyphs
    if action == "right":
        canvas.put(middle + beside, y, glyphs.track_done * 2 + glyphs.head_right, look.palette.strong)
    elif action == "left":
        text = glyphs.head_left + glyphs.track_done * 2
        canvas.put(middle - beside - 2, y, text, look.palette.strong)


def _number(name: str, value: float, unit: str, decimals: int, look: Look) -> str:
    if math.isnan(value):
        return ""
    return f"{name} {value:+.{decimals}f}{unit}".replace("-", look.glyphs.minus)


# The map with its margins


def surrounded(
    strips: list[Strip], snapshot: Snapshot, part: LabelledPart, margins: Margins, width: int, look: Look
) -> list[Strip]:
    """Put the margins around ``strips``."""
    grid, space = snapshot.world.drawing, snapshot.world.space
    assert isinstance(grid, Grid)
    if grid.axes is not None:
        strips = labelled(strips, grid, part, margins, width, snapshot.counters.state, look)
    if grid.body is None or not margins.body:
        return strips
    last = snapshot.counters.last_step
    action = "" if last is None or last.planned else space.action_names[int(space.pair_action[last.pair])]
    pose = Pose(grid.body.kind, grid.body.pose(snapshot.counters.state), action)
    if grid.axes is None or not grid.axes.is_upward or part.columns < grid.columns:
        return [*body_strips(pose, width, margins.body, look), *strips]
    pose, before = pose._replace(ends=_ends(grid.body.middles[0])), Canvas(margins.left, 1, look.palette.text)
    body = body_strips(pose, part.columns * part.cell[0], margins.body, look)
    rows = (Strip.join([*before.strips(), row]) for row in body)
    return [*(row.adjust_cell_length(width, look.palette.text) for row in rows), *strips]


def _ends(middles: Sequence[float]) -> tuple[float, float]:
    half = (middles[-1] - middles[0]) / (len(middles) - 1) / 2.0
    return _HILL if math.isnan(half) else (middles[0] - half, middles[-1] + half)
