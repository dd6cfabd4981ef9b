"""Picture files: SVG, or a PNG that resvg draws from it. Equal pictures have equal bytes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Final
from xml.sax.saxutils import escape, quoteattr

from rl_tui.common.errors import UserError
from rl_tui.common.files import whole_file
from rl_tui.common.findings import printable
from rl_tui.studies.pictures import shapes
from rl_tui.studies.pictures.layout import laid_out
from rl_tui.studies.pictures.picture import Picture
from rl_tui.studies.pictures.shapes import Disc, DrawnPage, Rectangle, Shape, Text

# SVG


_FONTS: Final = "'Helvetica Neue', Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif"


def svg_of(picture: Picture) -> str:
    """Return `picture` as an SVG with its own background."""
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


def _looks(shape: shapes.Path | Disc) -> Iterator[tuple[str, str]]:
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
    """Format `value` with at most two decimals, equally on every machine."""
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


# PNG


PNG: Final = ".png"
SCALE: Final = 2
"""PNG pixels for each pixel of the layout, for sharp prints."""
_LETTER: Final = '<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"><text y="9">M</text></svg>'


def check_renderer() -> None:
    """Raise UserError if resvg or a font is missing. Without fonts, resvg omits texts silently."""
    if find_spec("resvg_py") is None:
        raise UserError(
            'a PNG needs resvg, which is not installed: pip install "rl-tui[plot]", '
            "or choose a name that ends in .svg"
        )
    from resvg_py import svg_to_bytes

    if svg_to_bytes(svg_string=_LETTER) == svg_to_bytes(svg_string=_LETTER, skip_system_fonts=True):
        raise UserError(
            "a PNG needs a font, and none is installed: install one such as DejaVu Sans, "
            "or choose a name that ends in .svg"
        )


def png_of(picture: Picture) -> bytes:
    """Return `picture` as a PNG. Raises UserError."""
    check_renderer()
    from resvg_py import svg_to_bytes

    drawn: bytes = svg_to_bytes(svg_string=svg_of(picture), zoom=SCALE)
    return drawn


# Files


@contextmanager
def picture_file(path: Path) -> Iterator[Callable[[Picture], None]]:
    """Yield a function that writes a picture to `path`, as PNG or SVG.

    `whole_file` decides whether the file is kept. Raises UserError before there is a picture.
    """
    is_png = path.suffix.lower() == PNG
    if is_png:
        check_renderer()
    with whole_file(path) as stream:

        def write(picture: Picture) -> None:
            if is_png:
                stream.buffer.write(png_of(picture))
            else:
                stream.write(svg_of(picture))

        yield write
