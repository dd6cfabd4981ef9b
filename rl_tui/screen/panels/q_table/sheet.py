"""The visible part of a Q-table."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Final

from rich.segment import Segment
from rich.style import Style
from textual.cache import LRUCache
from textual.strip import Strip

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw.canvas import Piece, wrapped
from rl_tui.screen.draw.number_form import TINY
from rl_tui.screen.kit.layers import Layer, other_lane
from rl_tui.screen.kit.panel import Legend, LegendSign, Panel
from rl_tui.screen.kit.scrolling import kept_in_view, scroll_bar, scrolled_to
from rl_tui.screen.kit.snapshot_facts import has_estimates, hides_means
from rl_tui.screen.panels.policies.studied import policy_name
from rl_tui.screen.panels.q_table.forms import ListForm, MatrixForm, greedy_line
from rl_tui.screen.panels.q_table.world import NO_ROW, Pieces, Scene
from rl_tui.screen.theme.glyphs import ASCII, Glyphs
from rl_tui.screen.theme.look import Look

# The visible rows


_STATES_IN_GREEDY_LINE: Final = 12

Form = MatrixForm | ListForm  # a scene laid out for one width: an entry is a table row, counted from 0


class Sheet:
    """``height`` rows from entry ``first`` on."""

    def __init__(self, form: Form, scene: Scene, width: int, height: int) -> None:
        self.form = form
        self.first = 0
        self._scene = scene
        self._width = width
        self._height = height
        self._heads = form.heads()[: max(0, height - 1)]
        self._entries, self._block_width = form.entries, form.block_width
        self._lines = min(height - len(self._heads), -(-self._entries // form.blocks))
        self.shown = min(self._entries, self._lines * form.blocks)
        self.is_scrolled = self.shown < self._entries
        self.part = f"{self.shown} of {self._entries:,}"
        self.page = max(1, self._lines)

    @property
    def free_rows(self) -> int:
        """The empty rows at the bottom."""
        below = self._height - len(self._heads) - self._lines
        return 0 if self.is_scrolled else below - len(self._notes(below))

    @property
    def pairs(self) -> range:
        """The visible pairs, and those between."""
        if self.shown == 0:
            return range(0)
        last = self.form.pairs_in(self.first + self.shown - 1)
        return range(self.form.pairs_in(self.first).start, last.stop)

    def scroll(self, first: int, state: int | None = None) -> None:
        """Start near entry ``first``, with ``state`` visible."""
        entry = NO_ROW if state is None else self.form.entry_of(state)
        self.first = kept_in_view(first, None if entry == NO_ROW else entry, self.shown, self._entries)

    def scroll_to(self, first: int, pair: int) -> None:
        """Start near entry ``first``, with ``pair`` visible."""
        self.scroll(scrolled_to(first, self.form.entry_of_pair(pair), self.shown))

    def reach(self, pair: int, state: int) -> None:
        """Scroll to ``pair`` unless that hides ``state``."""
        first = self.first
        self.scroll_to(first, pair)
        if not self.first <= self.form.entry_of(state) < self.first + self.shown:
            self.first = first

    def pair_at(self, x: int, y: int) -> int | None:
        """Return the pair here, or None."""
        block, x = divmod(x, max(1, self._block_width))
        line = y - len(self._heads)
        entry = self.first + block * self._lines + line
        if not 0 <= line < self._lines or block >= self.form.blocks or entry >= self._entries:
            return None
        return self.form.pair_at(entry, x)

    def strips(self, cache: LRUCache[tuple[Segment, ...], Strip]) -> list[Strip]:
        """Draw the rows, from ``cache`` if unchanged."""
        rows = [head * self.form.blocks for head in self._heads]
        bar = []
        if self.is_scrolled and self._lines:
            bar = scroll_bar(self.first, self.shown, self._entries, self._lines, self._scene.look)
        rows += [self._row(line, bar[line : line + 1]) for line in range(self._lines)]
        rows += self._notes(self._height - len(rows))
        rows += [[]] * (self._height - len(rows))
        return [self._strip(row, cache) for row in rows]

    def _row(self, line: int, bar: Pieces) -> Pieces:
        pieces: Pieces = []
        gap = self._width - 1
        for block in range(self.form.blocks):
            entry = self.first + block * self._lines + line
            if entry < self._entries:
                pieces += self.form.entry(entry, is_first=line == 0)
                gap -= self._block_width
        return [*pieces, Segment(" " * gap, self._scene.look.palette.text), *bar] if bar else pieces

    def _notes(self, room: int) -> list[Pieces]:
        scene, palette = self._scene, self._scene.look.palette
        if room < 2 or not isinstance(self.form, ListForm):
            return []
        note: Pieces = []
        if hides_means(scene.snapshot):
            note = [Segment("  w h", palette.press), Segment("  show the true means q*", palette.dim)]
        elif not scene.snapshot.world.is_bandit and len(scene.world.live) <= _STATES_IN_GREEDY_LINE:
            text = scene.look.glyphs.separated(greedy_line(scene))
            note = [Segment(f" {text}", palette.dim)] if text else []
        return [[], note] if note and sum(segment.cell_length for segment in note) <= self._width else []

    def _strip(self, row: Pieces, cache: LRUCache[tuple[Segment, ...], Strip]) -> Strip:
        text = self._scene.look.palette.text
        key = (*row, Segment(str(self._width), text))
        strip = cache.get(key)
        if strip is None:
            blank = Segment(" " * self._width, text)
            strip = cache[key] = Strip(row or [blank]).adjust_cell_length(self._width, text)
        return strip


# Texts on the border


COMPUTING: Final = "computing the exact values …"
FOLLOW_HINT: Final = "esc: follow the agent"
TITLES: Final = {
    Layer.Q: "Q",
    Layer.OPTIMAL: "Q*, exact",
    Layer.ERROR: "Q − Q*",
    Layer.POLICY: "Q of a policy",
    Layer.LANES: "Q − other run",
    Layer.VISITS: "Visits",
}
_CAPTIONS: Final = {
    Layer.OPTIMAL: "what each action is worth",
    Layer.ERROR: "how wrong each estimate is",
    Layer.POLICY: "exact",
    Layer.VISITS: "how often each was tried",
}
NO_TABLE: Final = "no table found in your program"
_KEY: Final = "v "
_REVEAL: Final = "w h"


def rare_signs(strips: Sequence[Strip], look: Look) -> tuple[LegendSign, ...]:
    """Return the signs beside or instead of a number."""
    glyphs, text = look.glyphs, "".join(strip.text for strip in strips)
    signs = zip(TINY[glyphs is ASCII], ("just below 0", "just above 0"), strict=True)
    return tuple(LegendSign(sign, meaning, look.palette.text) for sign, meaning in signs if sign in text)


def headings(snapshot: Snapshot, layer: Layer, panel: Panel, lane: str = "") -> tuple[str, ...]:
    """Return titles. ``lane`` is the run number."""
    group = snapshot.run_group
    if group.lanes and not lane:
        lane = f"{panel.look.glyphs.cursor}{group.shown + 1}"
    other = other_lane(snapshot) if layer is Layer.LANES else None
    if other is None:
        title, studied = TITLES[layer], snapshot.answers.studied
        if layer is Layer.POLICY and studied is not None:
            title = f"Q of {policy_name(studied)}"
        captions = panel.captioned(title, _CAPTIONS.get(layer, ""))
        if layer is Layer.Q and not has_estimates(snapshot):
            captions = (f"{title} · {NO_TABLE}",)
        forms = (*captions, title)
        return tuple(f"{lane} · {each}" for each in forms) if lane else forms
    title, own = f"Q − Q of {other.name}", snapshot.run_group.lanes[snapshot.run_group.shown].name
    number = 1 + next(place for place, lane in enumerate(snapshot.run_group.lanes) if lane is other)
    forms = f"Q of {own} − Q of {other.name}", title, f"Q − Q of run {number}"
    return tuple(f"{lane} · {each}" for each in forms)


def footings(layer: Layer, choices: Sequence[Layer], *, hides_exact: bool) -> list[str]:
    """Return the keys for layers and hidden values. Short forms keep ``layer``, and drop the last others."""
    forms = []
    for count in range(len(choices), 0, -1):
        kept = choices[:count] if layer in choices[:count] else (*choices[: count - 1], layer)
        forms.append(_KEY + "".join(f" {each} " for each in kept))
    return [*(f"{each}· {_REVEAL} shows Q*" for each in forms if hides_exact), *forms]


def followed(footings: Sequence[str], part: str, *, is_following: bool) -> list[str]:
    """Add the visible ``part``, or the key to follow."""
    if is_following:
        return [f"{part} · {footings[0]}", *footings]
    return [*(f"{FOLLOW_HINT} · {each}" for each in footings), FOLLOW_HINT]


def layer_at(footing: str, column: int, choices: Sequence[Layer], glyphs: Glyphs) -> Layer | None:
    """Return the layer at ``column``."""
    places = _places(glyphs.separated(footing), choices, glyphs)
    return next((layer for layer, place in places.items() if column in place), None)


def key_column(footing: str) -> int:
    """Return the column of the key for layers, or −1."""
    return footing.find(f"{_KEY} ")


@lru_cache(64)
def footing_pieces(
    foot: str, layer: Layer, choices: tuple[Layer, ...], signs: Legend, look: Look
) -> tuple[Segment, ...]:
    """Style the text below the table: ``signs`` of its legend, its keys, and ``layer`` reversed."""
    palette = look.palette
    styles = [palette.dim] * len(foot)
    key, reveal = key_column(foot), foot.find(f"{_REVEAL} shows")
    for place, columns in ((key, len(_KEY.strip())), (reveal, len(_REVEAL))):
        if place >= 0:
            styles[place : place + columns] = [palette.press] * columns
    for sign in signs:
        mark = sign.sign.strip()
        for meaning in filter(None, (sign.in_full, sign.meaning)):
            if (place := foot.find(f"{mark} {look.glyphs.spelled(meaning)}")) >= 0:
                styles[place : place + len(mark)] = [sign.style] * len(mark)
    for column in _places(foot, choices, look.glyphs).get(layer, ()):
        styles[column] = palette.dim + Style(reverse=True)
    return tuple(Segment.simplify(Segment(*each) for each in zip(foot, styles, strict=True)))


def _places(text: str, choices: Sequence[Layer], glyphs: Glyphs) -> dict[Layer, range]:
    places: dict[Layer, range] = {}
    end = key_column(text) + len(_KEY)
    for layer in choices if end >= len(_KEY) else ():
        name = glyphs.spelled(f" {layer} ")
        if (start := text.find(name, end)) >= 0:
            end = start + len(name)
            places[layer] = range(start, end)
    return places


def no_answer(snapshot: Snapshot, width: int, look: Look) -> list[list[Piece]]:
    """Explain why exact values are missing."""
    palette, refused = look.palette, snapshot.exact_answer.refused
    text = f"No exact values: {refused}" if refused else COMPUTING
    lines = wrapped(text, max(1, width - 2), palette.text if refused else palette.dim, look)
    return [[Piece(" ", palette.text), *line] for line in lines]
