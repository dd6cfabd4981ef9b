"""Pictures of bodies, a cart with its pole and a car on its hill, and maps with all that is around them.

The agent sees no more than the bin of each number. So the picture of a cart or a car shows the middle of its
bin, and says so.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from textual.strip import Strip

from rl_tui.screen.draw.braille import BLANK, DOTS_ACROSS, DOTS_DOWN, braille_codes
from rl_tui.screen.draw.canvas import Canvas
from rl_tui.screen.panels.margins import LabelledPart, Margins, labelled
from rl_tui.worlds.drawing import BodyKind, Grid

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.style import Style

    from rl_tui.live.snapshot import Snapshot
    from rl_tui.screen.theme.look import Look
    from rl_tui.worlds.mdp.space import BoolArray


# Bodies: a cart with its pole, and a car on its hill


MIDDLE: Final = "bin middle"
_TRACK: Final = 2.4  # the cart leaves the track beyond that
_WIDE: Final = 40  # columns from which the cart has its full width
_HILL: Final = (-1.2, 0.6)  # positions of the car
_FLAG: Final = 0.5
_POINTS: Final = 400  # of the pole


class Pose(NamedTuple):
    """The ``numbers`` of a body, and the name of the last action, empty before the first one."""

    kind: BodyKind
    numbers: tuple[float, ...]
    action: str


@lru_cache(512)
def body_strips(pose: Pose, width: int, height: int, look: Look) -> tuple[Strip, ...]:
    """Return the picture of ``pose`` in width × height cells."""
    canvas = Canvas(width, height, look.palette.text)
    if pose.kind is BodyKind.CART_POLE:
        _draw_cart(canvas, pose, look)
    else:
        _draw_hill(canvas, pose, look)
    return tuple(canvas.strips())


def _draw_cart(canvas: Canvas, pose: Pose, look: Look) -> None:
    glyphs, palette = look.glyphs, look.palette
    position, _, angle, turning = pose.numbers
    ground, half = canvas.height - 1, 4 if canvas.width >= _WIDE else 2
    canvas.put(0, ground, glyphs.thin * canvas.width, palette.dim)
    middle = canvas.width // 2
    if not math.isnan(position):
        middle += round(max(-1.0, min(1.0, position / _TRACK)) * (canvas.width / 2 - half - 4))
    canvas.put(middle - half, ground - 1, glyphs.bar * (2 * half + 1), palette.text)
    if not math.isnan(angle):
        _draw_pole(canvas, middle, ground - 1, angle, look)
    _draw_push(canvas, middle, half + 2, ground - 1, pose.action, look)
    degree = "°" if glyphs.braille else " deg"
    texts = [
        _number("angle", math.degrees(angle), degree, 1, look),
        _number("turns", math.degrees(turning), f"{degree}/s", 0, look),
        MIDDLE,
    ]
    free = middle - half - 1
    for y, text in enumerate(text for text in texts if text and len(text) <= free):
        canvas.put(0, y, text, palette.dim if text is MIDDLE else palette.text)


def _draw_pole(canvas: Canvas, middle: int, rows: int, angle: float, look: Look) -> None:
    dots = np.zeros((rows * DOTS_DOWN, canvas.width * DOTS_ACROSS), dtype=np.bool_)
    along = np.linspace(0.0, rows * DOTS_DOWN - 1, _POINTS)
    x = np.rint(middle * DOTS_ACROSS + np.sin(angle) * along).astype(np.int64)
    y = np.rint(rows * DOTS_DOWN - 1 - np.cos(angle) * along).astype(np.int64)
    for column in (x, x + 1):
        inside = (column >= 0) & (column < dots.shape[1])
        dots[y[inside], column[inside]] = True
    slant = "|" if abs(angle) < 0.05 else "/" if angle > 0.0 else "\\"
    _put_dots(canvas, 0, dots, slant, look.palette.strong, look)


def _draw_hill(canvas: Canvas, pose: Pose, look: Look) -> None:
    glyphs, palette = look.glyphs, look.palette
    position, velocity = pose.numbers
    rows, low, high = canvas.height - 1, *_HILL
    across, down = canvas.width * DOTS_ACROSS, rows * DOTS_DOWN

    def dot_of(place: float) -> float:
        return (1.0 - (math.sin(3.0 * place) * 0.45 + 0.55)) * (down - DOTS_DOWN - 1) + DOTS_DOWN

    def column_of(place: float) -> int:
        return round((place - low) / (high - low) * (canvas.width - 1))

    dots = np.zeros((down, across), dtype=np.bool_)
    heights = [round(dot_of(low + (high - low) * x / (across - 1))) for x in range(across)]
    dots[np.clip(heights, 0, down - 1), np.arange(across)] = True
    _put_dots(canvas, 1, dots, ".", palette.dim, look)
    flag = column_of(_FLAG)
    canvas.put(flag, int(dot_of(_FLAG)) // DOTS_DOWN, glyphs.goal, palette.goal)
    if not math.isnan(position):
        x, y = column_of(position), int(dot_of(position)) // DOTS_DOWN
        car = "▟█▙" if glyphs.braille else "[#]"
        x = max(1, min(canvas.width - 2, x))
        canvas.put(x - 1, y, car, palette.strong)
        _draw_push(canvas, x, 3, y, pose.action, look)
    place, speed = _number("position", position, "", 2, look), _number("velocity", velocity, "", 3, look)
    forms = ([place, speed, MIDDLE], [place, MIDDLE], [MIDDLE])
    texts = next((form for form in forms if len("   ".join(form)) <= canvas.width), forms[-1])
    x = 0
    for text in filter(None, texts):
        canvas.put(x, 0, text, palette.dim if text is MIDDLE else palette.text)
        x += len(text) + 3


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


def _put_dots(canvas: Canvas, top: int, dots: BoolArray, plain: str, style: Style, look: Look) -> None:
    codes: Sequence[Sequence[int]] = braille_codes(dots).tolist()
    for y, row in enumerate(codes, start=top):
        for x, code in enumerate(row):
            if code != BLANK:
                canvas.put(x, y, chr(code) if look.glyphs.braille else plain, style)


# The map with both


def surrounded(
    strips: list[Strip], snapshot: Snapshot, part: LabelledPart, margins: Margins, width: int, look: Look
) -> list[Strip]:
    """Return ``strips`` of ``part`` of the map of ``snapshot`` in its margins, ``width`` cells wide."""
    grid, space = snapshot.world.drawing, snapshot.world.space
    assert isinstance(grid, Grid)
    if grid.axes is not None:
        strips = labelled(strips, grid.axes, part, margins, width, look)
    if grid.body is None or not margins.body:
        return strips
    last = snapshot.counters.last_step
    action = "" if last is None or last.planned else space.action_names[int(space.pair_action[last.pair])]
    pose = Pose(grid.body.kind, grid.body.pose(snapshot.counters.state), action)
    return [*body_strips(pose, width, margins.body, look), *strips]
