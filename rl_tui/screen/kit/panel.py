"""Base classes of all panels."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import fields, is_dataclass
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np
from rich.cells import cell_len
from rich.segment import Segment
from rich.style import Style
from textual import events
from textual.color import Color
from textual.geometry import Region, Size
from textual.strip import Strip
from textual.widget import Widget

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Piece, length, spelled, strips_of
from rl_tui.screen.kit.bindings import key_of_hint
from rl_tui.screen.kit.pointing import NOWHERE
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.world import World

# The legend


GREEDY_IN_FULL: Final = "greedy: looks best"
AGENT: Final = "agent"
MAY_NEVER_END: Final = "may never end"
_GAP: Final = "  "
_BETWEEN: Final = " · "
_CLOSER: Final = ", "  # used if all signs then fit
_MOST_KEPT: Final = 64  # the same legend is drawn in every frame


class LegendSign(NamedTuple):
    """A ``sign`` and its ``meaning``."""

    sign: str
    meaning: str
    style: Style
    in_full: str = ""


Legend = tuple[LegendSign, ...]


def agent_meaning(snapshot: Snapshot) -> str:
    """Return the agent sign's meaning."""
    return "backed up" if snapshot.agent.row.planner else AGENT


def no_value_sign(look: Look) -> LegendSign:
    """Return the sign of values missing because a policy may never end."""
    return LegendSign(numbers.missing(look.glyphs), "none", look.palette.text, f"no value: {MAY_NEVER_END}")


@lru_cache(_MOST_KEPT)
def legend_rows(signs: Legend, width: int, most: int, look: Look) -> tuple[Strip, ...]:
    """Draw the legend in up to ``most`` rows."""
    lines = _lines(_in_full(signs), width, look)
    if len(lines) > most:
        lines = _lines(signs, width, look)
    return tuple(strips_of(lines, width, min(most, len(lines)), look))


def _in_full(signs: Legend) -> Legend:
    return tuple(sign._replace(meaning=sign.in_full or sign.meaning) for sign in signs)


def _lines(signs: Legend, width: int, look: Look) -> list[list[Piece]]:
    lines: list[list[Piece]] = []
    for sign in signs:
        entry = [Piece(sign.sign, sign.style), Piece(f" {sign.meaning}", look.palette.dim)]
        if lines and length(spelled([*lines[-1], *entry], look)) + len(_GAP) <= width:
            lines[-1] += [Piece(_GAP, look.palette.dim), *entry]
        else:
            lines.append([Piece(" ", look.palette.dim), *entry])
    return lines


@lru_cache(_MOST_KEPT)
def legend_text(signs: Legend, room: int, look: Look) -> str:
    """Write the signs that fit a border."""
    entries = _entries(_in_full(signs), look)
    if cell_len(look.glyphs.separated(_BETWEEN.join(entries))) > room:
        entries = _entries(signs, look)
    whole = _CLOSER.join(entries)
    if cell_len(look.glyphs.separated(_BETWEEN.join(entries))) > room >= cell_len(whole):
        return whole
    text = ""
    for entry in entries:
        longer = f"{text}{_BETWEEN}{entry}" if text else entry
        if cell_len(look.glyphs.separated(longer)) <= room:
            text = longer
    return text


def _entries(signs: Legend, look: Look) -> list[str]:
    return [f"{sign.sign.strip()} {look.glyphs.spelled(sign.meaning)}".strip() for sign in signs]


# The panel


BORDER_ENDS: Final = 1  # one blank between the title and the border line
_TITLE_GAP: Final = "  "
_WHEEL_ROWS: Final = 3
_EDGES: Final = {  # border name in the style sheet: line, upper and lower corners
    "solid": ("─", "┌┐", "└┘"),
    "heavy": ("━", "┏┓", "┗┛"),
    "round": ("─", "╭╮", "╰╯"),
    "ascii": ("-", "++", "++"),
    "blank": (" ", "  ", "  "),
}


_HINT: Final = re.compile(r"(\S+): ?.*?(?=\s+\S+: |\s+[·–-]\s|$)")


def key_at(hints: str, column: int) -> str | None:
    """Return the key of the hint (``esc: close``) here."""
    for hint in _HINT.finditer(hints):
        if hint.start() <= column < hint.end():
            return key_of_hint(hint[1])
    return None


def key_hints(*keys: Sequence[str]) -> Iterator[str]:
    """Yield texts for the lower border, from longest to shortest.

    Each of ``keys`` lists its forms. Last keys shrink first, then the first keys go.
    """
    left = [list(forms) for forms in keys if forms]
    while left:
        yield _BETWEEN.join(forms[0] for forms in left)
        longer = next((forms for forms in reversed(left) if len(forms) > 1), None)
        (longer or left).pop(0)


def is_same(one: object, other: object) -> bool:
    """Compare part by part, worlds by identity."""
    if one is other:
        return True
    if type(one) is not type(other) or isinstance(one, World):
        return False
    if isinstance(one, np.ndarray):
        return np.array_equal(one, np.asarray(other), equal_nan=True)
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(map(is_same, one, other))
    if is_dataclass(one):
        return all(is_same(getattr(one, each.name), getattr(other, each.name)) for each in fields(one))
    return one == other


class BoardPanel(Widget):
    """A panel as the board sees it.

    ``is_led``: the other run's panel chooses the visible part. ``is_spotlit``: a lesson points here.
    """

    snapshot: Snapshot | None = None
    is_led: bool = False
    caption: str = ""
    is_explained: bool = False
    is_spotlit: bool = False
    drawn_from: object = None
    """The last result of :meth:`depends_on`. None forces a redraw."""
    head = ""  # title and caption above the panel
    foot = ""  # text below the panel, mostly keys
    _border_look: Look | None = None
    _heading: Sequence[Segment] = ()
    _keys: Sequence[Segment] = ()
    _ground: Style | None = None  # cached during rendering, because Textual recomputes it on every access
    _edges: tuple[tuple[object, Strip], ...] = ((None, Strip([])), (None, Strip([])))

    @property
    def stance(self) -> object:
        """State shared by two runs' panels: cursor, visible part, scale."""
        return None

    @property
    def is_complete(self) -> bool:
        """True if the snapshot contains all visible data."""
        return True

    def subject_in(self, snapshot: Snapshot) -> range:
        """Return the pairs to mark in worlds and tables."""
        return NOWHERE

    def depends_on(self, snapshot: Snapshot) -> object:
        """Return everything visible. None: always redraw."""
        return None

    def show(self, snapshot: Snapshot) -> None:
        """Store ``snapshot``, and redraw on visible changes."""
        self.snapshot, before = snapshot, self.drawn_from
        self.drawn_from = self.depends_on(snapshot)
        if self.drawn_from is None or not is_same(self.drawn_from, before):
            self.redraw()

    def align_with(self, twin: BoardPanel) -> None:
        """Take the twin's stance, without redrawing."""

    def redraw(self) -> None:
        """Draw the last snapshot again."""

    def write_border(self, head: str, foot: str, look: Look) -> None:
        """Write ``head`` above and ``foot`` below."""
        head = f"{look.glyphs.cursor} {head}" if self.is_spotlit else head
        texts = look.glyphs.separated(head), look.glyphs.separated(foot)
        keys = self.foot_pieces(texts[1], look)
        if texts == (self.head, self.foot) and keys == self._keys and look is self._border_look:
            return
        self._border_look = look
        self.head, self.foot = texts
        title, _, caption = (look.glyphs.separated(part) for part in head.partition(_BETWEEN))
        dim, strong = look.palette.dim, look.palette.strong
        self._heading = [Segment(title, strong)] if title else []
        self._heading += [Segment(f"{_TITLE_GAP}{caption}", dim)] if caption else []
        self._keys = keys
        x, y = self.content_offset
        width, height = self.outer_size
        self.refresh(Region(-x, -y, width, 1), Region(-x, height - 1 - y, width, 1))

    def foot_pieces(self, foot: str, look: Look) -> Sequence[Segment]:
        """Style the text below the panel."""
        return [Segment(foot, look.palette.dim)]

    def render_lines(self, crop: Region) -> list[Strip]:
        """Return the visible lines with their borders."""
        self._ground = self.rich_style
        strips = super().render_lines(crop)
        styles, bottom = self.styles, self.outer_size.height
        if strips and crop.y == 0 and styles.border_top[0]:
            emphasis = Strip([*self._heading][:1]).apply_style(styles.border_title_style)
            heading = [*emphasis, *self._heading[1:]]
            strips[0] = self._edge(styles.border_top, 0, heading).crop(crop.x, crop.right)
        if strips and crop.bottom == bottom > 1 and styles.border_bottom[0]:
            strips[-1] = self._edge(styles.border_bottom, 1, self._keys).crop(crop.x, crop.right)
        return strips

    def _edge(self, border: tuple[str, Color], row: int, text: Sequence[Segment]) -> Strip:
        made_of = border, text, self.outer_size.width, self._ground, bool(self.styles.border_right[0])
        if self._edges[row][0] != made_of:
            edge = made_of, self._new_edge(border, row, text)
            self._edges = (edge, self._edges[1]) if row == 0 else (self._edges[0], edge)
        strip = self._edges[row][1]
        for each in self.get_line_filters():  # such as the filter of a terminal without colours
            strip = strip.apply_filter(each, self.background_colors[1])
        return strip

    def _new_edge(self, border: tuple[str, Color], row: int, text: Sequence[Segment]) -> Strip:
        kind, colour = border
        rule, *corners = _EDGES[kind]
        is_framed, line = bool(self.styles.border_right[0]), Style(color=colour.rich_color)
        parts = [Segment(f"{corners[row][0]}{rule} ", line)] if is_framed else []
        parts += [*text, Segment(" ")] if text else []
        end = corners[row][1] if is_framed else ""
        taken = sum(part.cell_length for part in parts) + len(end)
        parts.append(Segment(rule * max(0, self.outer_size.width - taken) + end, line))
        ground = self._ground or self.rich_style
        return Strip(parts).apply_style(ground).adjust_cell_length(self.outer_size.width, ground)


class Panel(BoardPanel):
    """A panel that redraws each snapshot and refreshes changed rows.

    Subclasses implement :meth:`picture`, which sets ``heading``, ``footing`` and ``free_rows``. The
    :meth:`legend` fills the first of these rows, or the border.
    """

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id, classes=classes)
        self.look = look  # call :meth:`redraw` after a change
        self.heading = ""
        self.footing = ""
        self.free_rows = 0
        self._border_legend = ""
        self._least_free: tuple[World | None, Size, int] | None = None
        self._rows: list[Strip] = []
        self._drawn_size = Size(0, 0)

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return ``height`` strips of ``width`` cells, both ≥ 1."""
        raise NotImplementedError

    def legend(self, snapshot: Snapshot) -> Legend:
        """Return the possible signs, most important first."""
        return ()

    def captioned(self, title: str, caption: str = "") -> tuple[str, ...]:
        """Add the caption, if captions are shown."""
        caption = caption or self.caption
        return (f"{title} · {caption}",) if self.is_explained and caption else ()

    def fitting(self, titles: Iterable[str], width: int) -> str:
        """Return the first fitting title."""
        room = width - BORDER_ENDS - (len(f"{self.look.glyphs.cursor} ") if self.is_spotlit else 0)
        return next((each for each in titles if cell_len(self.look.glyphs.separated(each)) <= room), "")

    def redraw(self) -> None:
        """Draw again and refresh the changed rows."""
        before, size_before = self._rows, self._drawn_size
        self._draw()
        footing = " · ".join(filter(None, (self._border_legend, self.footing)))
        self.write_border(self.heading, footing, self.look)
        if self._drawn_size != size_before:
            self.refresh()
            return
        changed = [y for y, (old, new) in enumerate(zip(before, self._rows, strict=True)) if old != new]
        if changed:
            self.refresh(*(Region(0, y, self._drawn_size.width, 1) for y in changed))

    def on_resize(self) -> None:
        """Refit picture and titles."""
        self.redraw()

    def watch_has_focus(self, has_focus: bool) -> None:
        """Draw what counts only in focus, such as keys and the cursor."""
        super().watch_has_focus(has_focus)
        self.redraw()

    def render_line(self, y: int) -> Strip:
        """Return row ``y`` of the picture."""
        if self._drawn_size != self.size:
            self._draw()
        if y >= len(self._rows):
            return Strip.blank(self.size.width, self._ground or self.rich_style)
        return self._rows[y].apply_style(self._ground or self.rich_style)

    def on_click(self, event: events.Click) -> None:
        """Press the clicked key."""
        column = self.footing_column(event)
        key = None if column is None else key_at(self.look.glyphs.separated(self.footing), column)
        if key is not None:
            event.stop()
            self.app.simulate_key(key)

    def turn_wheel(self, rows: int, event: events.MouseEvent) -> None:
        """Scroll by ``rows`` if possible."""

    def on_mouse_scroll_down(self, event: events.MouseScrollDown) -> None:
        """Scroll down."""
        self.turn_wheel(_WHEEL_ROWS, event)

    def on_mouse_scroll_up(self, event: events.MouseScrollUp) -> None:
        """Scroll up."""
        self.turn_wheel(-_WHEEL_ROWS, event)

    def footing_column(self, event: events.MouseEvent) -> int | None:
        """Return the column in the footing."""
        text = self.look.glyphs.separated(self.footing)
        frame = len("╰─ ") if self.styles.border_right[0] else 0
        column = event.x - frame - self.foot.rfind(text)
        is_border = self.styles.border_bottom[0] and event.y == self.outer_size.height - 1
        return column if is_border and 0 <= column < cell_len(text) else None

    def _draw(self) -> None:
        self._drawn_size = size = self.size
        self._rows, self._border_legend = [], ""
        if size.width > 0 and size.height > 0:
            self._rows = self.picture(self.snapshot, size.width, size.height)
            if self.is_explained and self.snapshot is not None:
                self._explain(self.snapshot)

    def _explain(self, snapshot: Snapshot) -> None:
        size, signs = self._drawn_size, self.legend(snapshot)
        free = self._always_free(snapshot)
        rows = legend_rows(signs, size.width, free, self.look)
        if rows:
            start = size.height - free
            self._rows[start : start + len(rows)] = rows
        else:
            taken = cell_len(self.look.glyphs.separated(f"{self.footing} · ")) if self.footing else 0
            self._border_legend = legend_text(signs, size.width - BORDER_ENDS - taken, self.look)

    def _always_free(self, snapshot: Snapshot) -> int:
        """Return the fewest free rows so far, so that the legend does not jump."""
        known = self._least_free
        if known is not None and known[0] is snapshot.world and known[1] == self._drawn_size:
            least = min(known[2], self.free_rows)
        else:
            least = self.free_rows
        self._least_free = snapshot.world, self._drawn_size, least
        return max(0, least)
