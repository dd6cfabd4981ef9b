"""The shapes of a picture, in pixels from the upper left."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal, NamedTuple

Anchor = Literal["start", "middle", "end"]
Point = tuple[float, float]

# Widths of characters in a wide sans-serif font, relative to the size, for estimates
_WIDTHS: Final = {
    **dict.fromkeys("ijlI|'.,:;!", 0.34),
    **dict.fromkeys(" ftr()[]{}-/", 0.42),
    **dict.fromkeys("mwMW@%—…", 0.98),
}
_CAPITAL, _OTHER = 0.74, 0.64


class Rectangle(NamedTuple):
    """A rectangle in pixels."""

    left: float
    top: float
    width: float
    height: float

    @property
    def right(self) -> float:
        """Its right side."""
        return self.left + self.width

    @property
    def bottom(self) -> float:
        """Its lower side."""
        return self.top + self.height

    @property
    def corners(self) -> tuple[Point, ...]:
        """Corners, clockwise from the upper left."""
        left, top, right, bottom = self.left, self.top, self.right, self.bottom
        return (left, top), (right, top), (right, bottom), (left, bottom)


@dataclass(frozen=True, slots=True)
class Text:
    """A line of text with its baseline at `y` and its `anchor` at `x`."""

    x: float
    y: float
    text: str
    size: float
    colour: str
    anchor: Anchor = "start"
    bold: bool = False


@dataclass(frozen=True, slots=True)
class Path:
    """A line through `points`, or the filled area within. An empty colour draws nothing.

    `dash` has alternating lengths of line and gap.
    """

    points: tuple[Point, ...]
    stroke: str = ""
    width: float = 1.0
    dash: str = ""
    fill: str = ""
    opacity: float = 1.0
    closed: bool = False
    clip: Rectangle | None = None


@dataclass(frozen=True, slots=True)
class Disc:
    """A filled disc."""

    x: float
    y: float
    radius: float
    fill: str
    stroke: str = ""
    clip: Rectangle | None = None


Shape = Text | Path | Disc


class DrawnPage(NamedTuple):
    """The shapes of a picture in drawing order, and its size."""

    width: float
    height: float
    title: str
    summary: str
    shapes: Sequence[Shape]


def area(box: Rectangle, fill: str, stroke: str = "", width: float = 1.0) -> Path:
    """Return `box` as a filled rectangle, with a border of colour `stroke`."""
    return Path(box.corners, stroke=stroke, width=width, fill=fill, closed=True)


def text_width(text: str, size: float) -> float:
    """Estimate the largest width of `text` in pixels."""
    return size * sum(
        _WIDTHS.get(character, _CAPITAL if character.isupper() else _OTHER) for character in text
    )


def fitting(text: str, size: float, width: float) -> str:
    """Return `text`, cut with an ellipsis if it may exceed `width`."""
    if text_width(text, size) <= width:
        return text
    room = width - text_width("…", size)
    kept = 0
    for character in text:
        room -= text_width(character, size)
        if room < 0.0:
            break
        kept += 1
    return text[:kept].rstrip() + "…"


def wrapped(text: str, size: float, width: float) -> list[str]:
    """Return `text` in lines of at most `width`, cutting wider words."""
    lines = [""]
    for word in (fitting(each, size, width) for each in text.split()):
        longer = f"{lines[-1]} {word}".strip()
        if lines[-1] and text_width(longer, size) > width:
            lines.append(word)
        else:
            lines[-1] = longer
    return lines
