"""The margins around a map."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Final, NamedTuple

from rich.segment import Segment
from textual.strip import Strip

from rl_tui.screen.draw.canvas import Canvas
from rl_tui.screen.panels.grid.form import CellForm
from rl_tui.worlds.drawing import BodyKind, Grid

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rl_tui.screen.theme.look import Look
    from rl_tui.worlds.drawing import Axes, Title

_LEAST_BODY: Final = 4  # rows
_MOST_BODY: Final = {BodyKind.CART_POLE: 9, BodyKind.MOUNTAIN_CAR: 12}  # rows, with the heading
_BODY_SHARE: Final = 3  # a body has this fraction of the rows
_LEAST_MAP: Final = 5  # rows of a map below a body
LEAST_WITH_TITLES: Final = 14
"""Rows of a map that scrolls to show all its labels."""
BINS: Final = "Bins"
ALL_SEEN: Final = "all the agent sees"


class Margins(NamedTuple):
    """Columns of labels left of a map, rows of body and labels above."""

    left: int = 0
    body: int = 0
    labels: int = 0

    @property
    def names_bins(self) -> bool:
        """True if a heading explains the bins."""
        return self.body > 0 and self.labels > 1

    @property
    def above(self) -> int:
        """The rows above the map."""
        return self.body + self.labels


NO_MARGINS: Final = Margins()


def wanted_margins(grid: Grid, height: int) -> Margins:
    """Return a map's preferred margins."""
    axes, body, most = grid.axes, 0, _most_body(grid)
    if most and height >= _LEAST_BODY + _LEAST_MAP:
        body = max(_LEAST_BODY, min(most, height // _BODY_SHARE))
    if axes is None:
        return Margins(body=body)
    longest, has_heading = max(map(len, axes.rows)), body > 0 and axes.names is not None
    has_titles = any(title.row < 0 for title in axes.titles)
    labels = any(axes.columns) + (has_heading or has_titles)
    return Margins(longest + bool(longest), min(body, most - has_heading), labels)


def _most_body(grid: Grid) -> int:
    return 0 if grid.body is None else _MOST_BODY[grid.body.kind]


def margins_in(grid: Grid, cell: tuple[int, int], width: int, height: int) -> Margins:
    """Return the margins beside this ``cell`` size.

    They use free space. Scrolling and high maps make space for labels, all maps for their body.
    """
    wanted = wanted_margins(grid, height)
    across, down = width - grid.columns * cell[0], height - grid.rows * cell[1]
    left = wanted.left if across >= wanted.left or across < 0 else 0
    labels = max(0, min(wanted.labels, down))
    lacks_body = wanted.body > 0 and down - labels < _LEAST_BODY
    is_high = height >= LEAST_WITH_TITLES
    if down < 0 or lacks_body or (is_high and labels < wanted.labels):
        most = 2 if wanted.body or is_high else 1
        return Margins(left, wanted.body, min(wanted.labels, most))
    return Margins(left, min(_most_body(grid), down - labels) if wanted.body else 0, labels)


class LabelledPart(NamedTuple):
    """A map's visible cells, and their size."""

    top: int
    left: int
    rows: int
    columns: int
    cell: tuple[int, int]


def labelled(
    strips: Sequence[Strip],
    grid: Grid,
    part: LabelledPart,
    margins: Margins,
    width: int,
    state: int,
    look: Look,
) -> list[Strip]:
    """Label a map, highlighting ``state``. Titles of parts are in walls."""
    axes, rows = grid.axes, list(strips)
    assert axes is not None
    row, column = divmod(grid.cell_of_state[state], grid.columns)
    named = (title for title in axes.titles if any(axes.columns) and title.is_over(column))
    if any(row in (title.row, title.row - 1) for title in named):
        row = column = -1  # the cell has its own name beside or below
    above = (title for title in reversed(axes.titles) if title.row < row and title.is_over(column))
    own = next(above, None)
    for title in axes.titles:
        if part.top <= title.row < part.top + part.rows:
            y = (title.row - part.top) * part.cell[1] + (part.cell[1] - 1) // 2
            rows[y] = _titled(rows[y], title, part, title is own, look)
    head = _heads(axes, part, margins, width, column, own, look)
    if not margins.left:
        return [*head, *rows]
    labels = _row_labels(axes, part, margins.left, len(rows), row, look)
    return [*head, *(Strip.join(each) for each in zip(labels, rows, strict=True))]


def _titled(strip: Strip, title: Title, part: LabelledPart, is_here: bool, look: Look) -> Strip:
    text, x = _placed(title, part, look)
    if not text or x < 0 or x + len(text) > strip.cell_length:
        return strip
    name = Strip([Segment(text, look.palette.strong if is_here else look.palette.dim)], len(text))
    return Strip.join([strip.crop(0, x), name, strip.crop(x + len(text))])


def _placed(title: Title, part: LabelledPart, look: Look) -> tuple[str, int]:
    room = title.columns * part.cell[0]
    forms = (look.glyphs.spelled(each) for each in (title.text, title.brief))
    text = next((each for each in forms if len(each) <= room), "")
    x = (title.column - part.left) * part.cell[0] + (room - len(text)) // 2
    return text, x


@lru_cache(64)
def _row_labels(
    axes: Axes, part: LabelledPart, left: int, height: int, here: int, look: Look
) -> tuple[Strip, ...]:
    canvas = Canvas(left, height, look.palette.text)
    for row in range(part.top, part.top + part.rows):
        y = (row - part.top) * part.cell[1] + (part.cell[1] - 1) // 2
        text = f"{axes.rows[row]:>{left - 1}}".replace("-", look.glyphs.minus)
        canvas.put(0, y, text, look.palette.strong if row == here else look.palette.dim)
    return tuple(canvas.strips())


@lru_cache(64)
def _heads(
    axes: Axes, part: LabelledPart, margins: Margins, width: int, here: int, own: Title | None, look: Look
) -> tuple[Strip, ...]:
    canvas, palette = Canvas(width, margins.labels, look.palette.text), look.palette
    start, wide = margins.left, part.cell[0]
    texts = axes.columns[part.left : part.left + part.columns] if margins.labels else ()
    if margins.labels > any(texts):
        _put_titles(canvas, axes, part, start, own, look)
        if margins.names_bins and axes.names is not None:
            _put_heading(canvas, axes, look)
    every = 1 + max(map(len, texts), default=0) // wide  # a blank separates neighbours
    form, place = CellForm(*part.cell), 0  # within a block
    middle = form.centred(1, as_blocks=form.has_blocks and look.glyphs.braille)
    for column, text in enumerate(texts):
        x = start + column * wide + middle - (len(text) - 1) // 2
        if text and place % every == 0 and x >= 0 and x + len(text) <= width:
            style = palette.strong if column + part.left == here else palette.dim
            canvas.put(x, margins.labels - 1, text.replace("-", look.glyphs.minus), style)
        place = place + 1 if text else 0
    return tuple(canvas.strips())


def _put_titles(
    canvas: Canvas, axes: Axes, part: LabelledPart, start: int, own: Title | None, look: Look
) -> None:
    nearest = max((title.row for title in axes.titles if title.row <= part.top), default=part.top)
    for title in axes.titles if nearest < part.top else ():
        text, x = _placed(title, part, look)
        if title.row == nearest and x >= 0 and start + x + len(text) <= canvas.width:
            canvas.put(start + x, 0, text, look.palette.strong if title is own else look.palette.dim)


def _put_heading(canvas: Canvas, axes: Axes, look: Look) -> None:
    palette, glyphs = look.palette, look.glyphs
    assert axes.names is not None
    (down, across), arrow = axes.names, glyphs.up if axes.is_upward else glyphs.down
    both = f"{down} {arrow}  {across} {glyphs.right}"
    close = f"{down}{arrow} {across}{glyphs.right}"
    forms = (f"{ALL_SEEN}, drawn at the middle · {both}", f"{ALL_SEEN} · {both}", both, close)
    text = next((form for form in forms if len(BINS) + 2 + len(form) <= canvas.width), "")
    canvas.put(0, 0, BINS, palette.strong)
    canvas.put(len(BINS) + 2, 0, glyphs.spelled(text), palette.dim)
    end = len(BINS) + 3 + len(text)
    canvas.put(end, 0, glyphs.thin * (canvas.width - end), palette.rule)
