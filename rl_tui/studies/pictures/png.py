"""A picture as PNG, drawn by Matplotlib, which is asked for only here."""

from __future__ import annotations

from importlib.util import find_spec
from io import BytesIO
from typing import Any, Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import printable
from rl_tui.studies.pictures.layout import laid_out
from rl_tui.studies.pictures.picture import Picture
from rl_tui.studies.pictures.shapes import Disc, DrawnPage, Path, Text

SCALE: Final = 2
"""Dots of the PNG for each pixel of the layout, so that it is sharp on paper."""
_DOTS_PER_INCH: Final = 100
_POINTS_PER_INCH: Final = 72
_ANCHORS: Final = {"start": "left", "middle": "center", "end": "right"}


def check_matplotlib() -> None:
    """Raise UserError where Matplotlib is not installed."""
    if find_spec("matplotlib") is None:
        raise UserError(
            'a PNG is drawn by Matplotlib, which is not installed: pip install "rl-tui[plot]", '
            "or take a name that ends in .svg"
        )


def png_of(picture: Picture) -> bytes:
    """Return ``picture`` as the bytes of a PNG file. Raises UserError where Matplotlib is not installed."""
    check_matplotlib()
    import matplotlib as mpl

    with mpl.rc_context():
        mpl.rcdefaults()  # what a person has set for other pictures is not for this one
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


def _draw_patch(axes: Any, shape: Path | Disc, order: int) -> None:
    from matplotlib.patches import Circle, PathPatch, Rectangle
    from matplotlib.path import Path as Outline

    patch: Any
    if isinstance(shape, Disc):
        patch = Circle((shape.x, shape.y), shape.radius)
    else:
        patch = PathPatch(Outline([*shape.points, *shape.points[:1]] if shape.closed else shape.points))
        patch.set_linewidth(_points(shape.width) if shape.stroke else 0.0)
        patch.set_alpha(shape.opacity)
        if shape.dash:  # it is given in widths of the line
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
