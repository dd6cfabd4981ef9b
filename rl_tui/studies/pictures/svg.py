"""A picture as SVG: one file that needs no other, the same bytes for the same picture."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final
from xml.sax.saxutils import escape, quoteattr

from rl_tui.common.findings import printable
from rl_tui.studies.pictures.layout import laid_out
from rl_tui.studies.pictures.picture import Picture
from rl_tui.studies.pictures.shapes import Disc, DrawnPage, Path, Rectangle, Shape, Text

_FONTS: Final = "'Helvetica Neue', Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif"


def svg_of(picture: Picture) -> str:
    """Return ``picture`` as the text of an SVG file. It draws its own background."""
    page = laid_out(picture)
    clips = _clips(page)
    width, height = _number(page.width), _number(page.height)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="0 0 {width} {height}" role="img" aria-labelledby="title desc" '
        f"font-family={quoteattr(_FONTS)}>",
        f'<title id="title">{_text(page.title)}</title>',
        f'<desc id="desc">{_text(page.summary)}</desc>',
    ]
    if clips:
        lines.append("<defs>")
        lines += [f'<clipPath id="{name}">{_rectangle(box)}</clipPath>' for box, name in clips.items()]
        lines.append("</defs>")
    lines += [_element(shape, clips) for shape in page.shapes]
    return "\n".join([*lines, "</svg>", ""])


def _clips(page: DrawnPage) -> dict[Rectangle, str]:
    boxes = dict.fromkeys(
        shape.clip for shape in page.shapes if not isinstance(shape, Text) and shape.clip is not None
    )
    return {box: f"plot-{number}" for number, box in enumerate(boxes, start=1)}


def _element(shape: Shape, clips: dict[Rectangle, str]) -> str:
    if isinstance(shape, Text):
        return _text_element(shape)
    attributes = dict(_looks(shape))
    if shape.clip is not None:
        attributes["clip-path"] = f"url(#{clips[shape.clip]})"
    if isinstance(shape, Disc):
        place = {"cx": _number(shape.x), "cy": _number(shape.y), "r": _number(shape.radius)}
        return f"<circle{_attributes({**place, **attributes})}/>"
    name = "polygon" if shape.closed else "polyline"
    points = " ".join(f"{_number(x)},{_number(y)}" for x, y in shape.points)
    return f"<{name}{_attributes({'points': points, **attributes})}/>"


def _text_element(text: Text) -> str:
    attributes = {
        "x": _number(text.x),
        "y": _number(text.y),
        "font-size": _number(text.size),
        "fill": text.colour,
    }
    if text.anchor != "start":
        attributes["text-anchor"] = text.anchor
    if text.bold:
        attributes["font-weight"] = "bold"
    return f"<text{_attributes(attributes)}>{_text(text.text)}</text>"


def _looks(shape: Path | Disc) -> Iterator[tuple[str, str]]:
    yield "fill", shape.fill or "none"
    if shape.stroke:
        yield "stroke", shape.stroke
    if isinstance(shape, Disc):
        return
    if shape.stroke:
        yield "stroke-width", _number(shape.width)
        yield "stroke-linejoin", "round"
    if shape.dash:
        yield "stroke-dasharray", shape.dash
    if shape.opacity < 1.0:
        yield "opacity", _number(shape.opacity)


def _rectangle(box: Rectangle) -> str:
    place = dict(zip(("x", "y", "width", "height"), map(_number, box), strict=True))
    return f"<rect{_attributes(place)}/>"


def _attributes(values: dict[str, str]) -> str:
    return "".join(f" {name}={quoteattr(value)}" for name, value in values.items())


def _text(text: str) -> str:
    return escape(printable(text))


def _number(value: float) -> str:
    """Return ``value`` with two decimals at most: a hundredth of a pixel, alike on every machine."""
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
