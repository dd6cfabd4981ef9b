"""Picture files: PNG drawn by Matplotlib, which is imported only here, or SVG. An SVG needs no other file,
and equal pictures have equal bytes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from typing import Any, Final
from xml.sax.saxutils import escape, quoteattr

from rl_tui.common.errors import UserError
from rl_tui.common.files import whole_file
from rl_tui.common.findings import printable
from rl_tui.studies.pictures import shapes
from rl_tui.studies.pictures.layout import laid_out
from rl_tui.studies.pictures.picture import Picture
from rl_tui.studies.pictures.shapes import Disc, DrawnPage, Rectangle, Shape, Text

# PNG


SCALE: Final = 2
"""PNG pixels for each pixel of the layout, for sharp prints."""
_DOTS_PER_INCH: Final = 100
_POINTS_PER_INCH: Final = 72
_ANCHORS: Final = {"start": "left", "middle": "center", "end": "right"}


def check_matplotlib() -> None:
    """Raise UserError if Matplotlib is not installed."""
    if find_spec("matplotlib") is None:
        raise UserError(
            'a PNG needs Matplotlib, which is not installed: pip install "rl-tui[plot]", '
            "or choose a name that ends in .svg"
        )


def png_of(picture: Picture) -> bytes:
    """Return `picture` as the bytes of a PNG. Raises UserError if Matplotlib is not installed."""
    check_matplotlib()
    import matplotlib as mpl

    with mpl.rc_context():
        mpl.rcdefaults()  # ignore the user's settings for other pictures
        return _drawn(laid_out(picture))


def _drawn(page: DrawnPage) -> bytes:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    size = (page.width / _DOTS_PER_INCH, page.height / _DOTS_PER_INCH)
    figure = Figure(figsize=size, dpi=_DOTS_PER_INCH * SCALE)
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(0.0, page.width)
    axes.set_ylim(page.height, 0.0)
    for order, shape in enumerate(page.shapes):
        if isinstance(shape, Text):
            _draw_text(axes, shape, order)
        else:
            _draw_patch(axes, shape, order)
    stream = BytesIO()
    metadata = {"Title": page.title, "Description": page.summary, "Software": "rl-tui"}
    figure.savefig(stream, format="png", metadata=metadata)
    return stream.getvalue()


def _draw_text(axes: Any, text: Text, order: int) -> None:
    axes.text(
        text.x,
        text.y,
        printable(text.text),
        fontsize=_points(text.size),
        color=text.colour,
        ha=_ANCHORS[text.anchor],
        va="baseline",
        weight="bold" if text.bold else "normal",
        parse_math=False,
        zorder=order,
    )


def _draw_patch(axes: Any, shape: shapes.Path | Disc, order: int) -> None:
    from matplotlib.patches import Circle, PathPatch, Rectangle
    from matplotlib.path import Path as Outline

    patch: Any
    if isinstance(shape, Disc):
        patch = Circle((shape.x, shape.y), shape.radius)
    else:
        patch = PathPatch(Outline([*shape.points, *shape.points[:1]] if shape.closed else shape.points))
        patch.set_linewidth(_points(shape.width) if shape.stroke else 0.0)
        patch.set_alpha(shape.opacity)
        if shape.dash:  # in multiples of the line width
            patch.set_linestyle((0, [float(part) / shape.width for part in shape.dash.split()]))
    patch.set_facecolor(shape.fill or "none")
    patch.set_edgecolor(shape.stroke or "none")
    patch.set_zorder(order)
    axes.add_patch(patch)
    if shape.clip is not None:
        left, top, width, height = shape.clip
        patch.set_clip_path(Rectangle((left, top), width, height, transform=axes.transData))


def _points(pixels: float) -> float:
    return pixels * _POINTS_PER_INCH / _DOTS_PER_INCH


# SVG


_FONTS: Final = "'Helvetica Neue', Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif"


def svg_of(picture: Picture) -> str:
    """Return `picture` as the text of an SVG with its own background."""
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


PNG: Final = ".png"


@contextmanager
def picture_file(path: Path) -> Iterator[Callable[[Picture], None]]:
    """Yield a function that writes a picture to `path`, as PNG if the name ends in .png, else as SVG.
    `whole_file` decides whether the file is kept.

    Raises:
        UserError: The file cannot be written or drawn. This is raised before there is a picture.
    """
    is_png = path.suffix.lower() == PNG
    if is_png:
        check_matplotlib()
    with whole_file(path) as stream:

        def write(picture: Picture) -> None:
            if is_png:
                stream.buffer.write(png_of(picture))
            else:
                stream.write(svg_of(picture))

        yield write
