"""A map's legend, wind and headings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import compress
from typing import Final

from rich.segment import Segment
from rich.style import Style
from textual.strip import Strip

from rl_tui.live.last_step.gust import gust_of
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.kit.panel import LegendSign
from rl_tui.screen.panels.grid.action_form import ActionForm, Places
from rl_tui.screen.panels.grid.form import LEAST_ARROWS, CellForm
from rl_tui.screen.panels.grid.map import GridMap, MapPart
from rl_tui.screen.panels.grid.marks import START, CellReward, differing_style, one_way_sign, reward_style
from rl_tui.screen.panels.world.shown_policy import TITLE
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import CellKind, Grid

# Wind of a map


WIND: Final = "wind"


def wind_strip(
    grid: Grid, part: MapPart, form: CellForm, width: int, snapshot: Snapshot, look: Look
) -> Strip:
    """Draw the columns' wind."""
    palette = look.palette
    gust = gust_of(snapshot.world, snapshot.counters.last_step)
    segments = []
    for column in range(part.left, part.left + part.columns):
        strength = grid.wind[column]
        text, style = _wind_text(strength, look), palette.text if strength else palette.dim
        text = text if len(text) < form.width else text[-1:]
        if gust is not None and gust.column == column:
            is_stronger = abs(gust.pushed) > abs(strength) and len(text) + 1 < form.width
            text, style = text + "+" * is_stronger, palette.updated
        before = (form.width - len(text)) // 2 if form.height > 1 else max(0, form.width - len(text) - 1)
        segments += [
            Segment(" " * before, palette.text),
            Segment(text, style),
            Segment(" " * (form.width - before - len(text)), palette.text),
        ]
    return Strip(segments).adjust_cell_length(width, palette.text)


def _wind_text(strength: int, look: Look) -> str:
    if not strength:
        return "0"
    return f"{look.glyphs.up if strength > 0 else look.glyphs.down}{abs(strength)}"


def wind_line(grid: Grid, part: MapPart, look: Look) -> str:
    """Write the wind: ``wind 0 0 1 2``."""
    winds = grid.wind[part.left : part.left + part.columns]
    return " ".join((WIND, *(_wind_text(each, look) for each in winds)))


# The legend


def differing_sign(width: int, name: str, look: Look) -> LegendSign:
    """Return the mark of other arrows in the second run."""
    glyphs, strong = look.glyphs, look.palette.strong
    if width - len(name) > LEAST_ARROWS:
        sign, style = glyphs.differs, look.palette.text
    else:
        is_name = width - len(name) < LEAST_ARROWS
        sign, style = name if is_name else glyphs.up, differing_style(strong)
    return LegendSign(sign, "differs", style)


def action_signs(form: ActionForm, highest: Style, look: Look) -> Iterator[LegendSign]:
    """Yield the signs of every action. ``highest``: the style of the best."""
    palette, glyphs = look.palette, look.glyphs
    # first, because between others it would look like a separator
    yield LegendSign(glyphs.untried, "not tried", palette.unvisited)
    if form.places is Places.TINTS:
        yield LegendSign(glyphs.up, "greedy", highest + Style(bold=True))
    else:
        frame = glyphs.mark_left + glyphs.mark_right if form.is_framed else glyphs.mark_after
        yield LegendSign(frame, "greedy", palette.best)
    if palette.tints:
        yield LegendSign(" tint ", "Q", highest)


def letter_signs(of: GridMap, ink: Style) -> Iterator[LegendSign]:
    """Yield the letters of actions."""
    for action, (sign, name) in enumerate(zip(of.signs, of.action_names, strict=True)):
        if isinstance(sign, str) and sign != name and action in of.actions_beside_exits:
            yield LegendSign(sign, name, ink)


def ground_signs(of: GridMap, ink: Style, look: Look, *, has_edges: bool) -> Iterator[LegendSign]:
    """Yield wind, walls between cells and one-way cells."""
    if of.grid.wind:
        yield LegendSign(_wind_text(max(of.grid.wind, key=abs), look), WIND, look.palette.text)
    if of.grid.walls and has_edges:
        yield LegendSign(look.glyphs.edges[1], "wall", ink)
    if of.ways:
        sign = "".join(one_way_sign(way, look) for way in sorted(set(of.ways.values())))
        yield LegendSign(sign, "one-way", ink)


def place_signs(
    of: GridMap, kinds: frozenset[CellKind], ink: Style, look: Look, *, says_start: bool
) -> Iterator[LegendSign]:
    """Yield terminal cells and the start."""
    palette, glyphs = look.palette, look.glyphs
    ends = (
        (CellKind.HOLE, glyphs.hole, palette.hole),
        (CellKind.CLIFF, glyphs.cliff, palette.cliff),
        (CellKind.GOAL, glyphs.goal, palette.goal),
    )
    shown = [(of.ends[kind], sign, style) for kind, sign, style in ends if kind in of.ends]
    for name in dict.fromkeys(name for name, _, _ in shown):
        signs, styles = zip(*(each[1:] for each in shown if each[0] == name), strict=True)
        yield LegendSign("".join(signs), name, styles[0] if len(signs) == 1 else palette.strong)
    if CellKind.START in kinds and not says_start:
        yield LegendSign(START, "start", ink)


def reward_signs(rewards: Sequence[CellReward], texts: Sequence[str], look: Look) -> Iterator[LegendSign]:
    """Yield the rewards' entry."""
    if len(texts[0]) > 1:
        yield LegendSign(texts[0], "reward", reward_style(rewards[0], look))
        return
    yield LegendSign("".join(dict.fromkeys(texts)), "reward", look.palette.strong)


# Headings


FOLLOWS: Final = "follows the agent"
FOLLOW_HINT: Final = "esc: follow the agent"
HEADING_ACTIONS: Final = f"{TITLE} · Q of every action"
HEADING_TINTS: Final = f"{HEADING_ACTIONS}, as tint"
STATE_NUMBERS: Final = "state numbers"


def heading_of_values(form: CellForm, arrows: str, look: Look) -> str:
    """Return the heading of V and ``arrows``."""
    if form.has_values:
        return f"{TITLE} · V and {arrows}"
    return f"{TITLE} · {arrows}, V as colour" if look.palette.tints else f"{TITLE} · {arrows}"


def heading_of_actions(form: ActionForm) -> str:
    """Return the heading of every action."""
    return HEADING_TINTS if form.places is Places.TINTS else HEADING_ACTIONS


def numbered(heading: str, form: CellForm, arrows: str, longest: int, *, in_corner: bool) -> tuple[str, ...]:
    """Return headings with state numbers of ``longest`` characters. ``in_corner``: they replace nothing."""
    if in_corner or form.has_corner:
        return f"{heading} · {STATE_NUMBERS}", f"{TITLE} · {STATE_NUMBERS}", STATE_NUMBERS
    has_arrows = form.has_values or longest <= form.width - LEAST_ARROWS
    what = f"{STATE_NUMBERS} and {arrows}" if has_arrows else STATE_NUMBERS
    return f"{TITLE} · {what}", f"{TITLE} · {STATE_NUMBERS}", STATE_NUMBERS


def shorter(legend: str) -> tuple[str, ...]:
    """Return ``legend`` and two shorter forms."""
    rows_and_columns = ", ".join(legend.split(", ")[:2])
    return legend, rows_and_columns, rows_and_columns.rpartition(": ")[2]


def where(grid: Grid, part: MapPart, *, follows: bool, is_led: bool) -> tuple[str, ...]:
    """Describe the visible part, and how to follow the agent."""
    follow = FOLLOWS if follows else "" if is_led else FOLLOW_HINT
    ending = f" · {follow}" if follow else ""
    is_cut = part.rows < grid.rows, part.columns < grid.columns
    sides = ("rows", part.top, part.rows, grid.rows), ("columns", part.left, part.columns, grid.columns)
    in_view = [(f"{name} {first}–{first + shown - 1}", total) for name, first, shown, total in sides]
    cut = list(compress(in_view, is_cut))
    named = " · ".join(f"{shown} of {total:,}" for shown, total in cut)
    brief = " · ".join(shown for shown, _ in cut)
    legends = shorter(grid.legend) if grid.legend and follows else ()
    return (
        *(f"{legend} · {named}" for legend in legends),
        f"{named}, counted from 0{ending}",
        f"{named}{ending}",
        f"{brief}{ending}",
        *((named, brief) if follow != FOLLOW_HINT else ()),  # following is obvious
        follow,
    )
