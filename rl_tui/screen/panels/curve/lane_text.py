"""The words of runs side by side on the return curve: names at the ends of their lines, and titles."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from rich.cells import cell_len
from rich.style import Style

from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.kit.snapshot_facts import recent_name
from rl_tui.screen.panels.curve.data import CurveData, LaneLine
from rl_tui.screen.panels.curve.seed_band import seed_remark
from rl_tui.screen.panels.curve.text import (
    NUMBER,
    ROOM_FOR_NAMES,
    LineLabel,
    amount,
    label_columns,
    labels,
    no_end,
)
from rl_tui.screen.panels.curve.words import (
    BESIDE_NAMES,
    BEST_ARM,
    COUNTS_SEEDS,
    EQUAL_STEPS,
    ONE_SEED,
    SHORT_OPTIMUM,
    TITLES,
)
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look

_GREEDY: Final = ", greedy "
_LARGEST_SHARE: Final = 0.5  # of the plot that names may take
_TITLE_NAME: Final = 16  # cells of a shortened name in a title


class _Form(NamedTuple):
    """How much is said of a lane where its line ends: ``name`` is the cells of the longest name."""

    name: int
    number: bool
    greedy: bool


_FORMS: Final = (
    _Form(24, number=True, greedy=True),
    _Form(24, number=True, greedy=False),
    _Form(16, number=True, greedy=False),
    _Form(10, number=True, greedy=False),
    _Form(10, number=False, greedy=False),
)


def lane_labels(data: CurveData, look: Look, decimals: int, room: int) -> list[LineLabel]:
    """Return the names for a plot of ``room`` columns, the lane shown and then the others before the rest."""
    if room < ROOM_FOR_NAMES:
        return []
    form = _form(data, look, room)
    names = _names(data, look, form.name)
    lanes = sorted(zip(data.lanes, names, strict=True), key=lambda each: not each[0].shown)
    found = [
        LineLabel(_said(lane, name, form, decimals, look.glyphs), _place(lane), _style(lane, look))
        for lane, name in lanes
        if lane.value is not None or _has_no_line(lane)
    ]
    has_greedy = not any(lane.shown and lane.is_exact for lane in data.lanes)
    return [*found, *labels(data, look, decimals, room, greedy=has_greedy, mean=False)]


def lane_columns(data: CurveData, look: Look, room: int) -> int:
    """Return how many columns the names take at most, their distance from the line included."""
    if room < ROOM_FOR_NAMES:
        return 0
    return max(_columns(data, look, _form(data, look, room)), label_columns(data, look, room, mean=False))


def lane_titles(data: CurveData, usual: tuple[str, ...], glyphs: Glyphs) -> tuple[str, ...]:
    """Return titles that say which lane is shown, the longest first; ``usual`` are those of a single one."""
    shown, least = next(lane for lane in data.lanes if lane.shown), TITLES[data.unit][-1]
    short = f"{len(data.lanes)} lanes, {glyphs.cursor}{shown.number}"
    named = f"{short} {shown.name}"
    clipped = f"{short} {_clipped(shown.name, _TITLE_NAME, glyphs.ellipsis)}"
    return (
        f"{usual[0]} · {named}",
        *(f"{least} · {each}" for each in (named, clipped, short)),
        clipped,
        short,
    )


def lane_remark(data: CurveData, look: Look, room: int, *, counts_seeds: bool = True) -> tuple[str, ...]:
    """Return what the figures beside the names are, and of how many seeds, the longest form first.

    ``counts_seeds`` says that M does for these lanes.
    """
    if room < ROOM_FOR_NAMES or not data.furthest:
        return ()
    if data.seeds:
        return seed_remark(data.seeds, look)
    if not _form(data, look, room).number:
        return (ONE_SEED + COUNTS_SEEDS, ONE_SEED) if counts_seeds else (ONE_SEED,)
    what = "pulls" if data.is_bandit else "episodes"
    recent = recent_name(*(lane.finished for lane in data.lanes if not lane.is_exact))
    if any(lane.is_exact for lane in data.lanes):
        return (
            f"{BESIDE_NAMES}: mean of the {recent} {what} of one seed; of planners the exact return",
            f"mean of the {recent}; planners: exact",
            f"mean of the {recent}, or exact",
        )
    recent_return, recent_ones = f"mean of the {recent} {what}", f"{recent} {what}"
    if recent == recent_name(1):
        recent_return, recent_ones = f"return of the last {what[:-1]}", f"last {what[:-1]}"
    best = f"the {BEST_ARM}" if data.is_bandit else SHORT_OPTIMUM
    one_seed = ONE_SEED + COUNTS_SEEDS if counts_seeds else ONE_SEED
    return (
        f"{BESIDE_NAMES}: {recent_return} of {one_seed}",
        *((f"{one_seed} · h adds {best}",) if data.hides_optimum and data.has_key else ()),
        f"{BESIDE_NAMES}: {recent_ones}, {one_seed}",
        f"{recent} of {one_seed}",
        *((f"{recent}, one seed; M: many",) if counts_seeds else ()),
        one_seed,
        ONE_SEED,
    )


def steps_note(data: CurveData) -> tuple[str, ...]:
    """Return why one lane has come further than another, the longest form first; empty where none has."""
    if len({lane.finished for lane in data.lanes if not lane.is_exact}) < 2:
        return ()
    return EQUAL_STEPS


def _form(data: CurveData, look: Look, room: int) -> _Form:
    """Return the fullest form that leaves the lines their share of ``room`` columns, else the shortest."""
    fitting = (form for form in _FORMS if _columns(data, look, form) <= _LARGEST_SHARE * room)
    return next(fitting, _FORMS[-1])


def _columns(data: CurveData, look: Look, form: _Form) -> int:
    longest = max(cell_len(name) for name in _names(data, look, form.name))
    number = cell_len(": ") + NUMBER if form.number else 0
    return 2 + longest + number + (cell_len(_GREEDY) + NUMBER if form.greedy else 0)


def _names(data: CurveData, look: Look, width: int) -> list[str]:
    """Return the names in at most ``width`` cells, with their numbers where they would not tell enough."""
    glyphs = look.glyphs
    names = [to_ascii(lane.name, glyphs) for lane in data.lanes]
    is_enough = look.palette.tells_lanes_apart and glyphs.braille
    if is_enough and all(cell_len(name) <= width for name in names):
        return names
    numbered = (f"{lane.number}) {name}" for lane, name in zip(data.lanes, names, strict=True))
    return [_clipped(name, width + cell_len("1) "), glyphs.ellipsis) for name in numbered]


def _clipped(name: str, width: int, ellipsis: str) -> str:
    short = shortened(name, width, ellipsis)
    return short.replace(f",{ellipsis}", ellipsis).replace(f":{ellipsis}", ellipsis)


def _said(lane: LaneLine, name: str, form: _Form, decimals: int, glyphs: Glyphs) -> str:
    if not form.number:
        return name
    greedy = ""
    if form.greedy and not lane.shown and not lane.is_exact:
        greedy = _figure(lane.greedy_now, lane.greedy_ends, decimals, glyphs)
    # a colon between name and figure, for names end with figures themselves
    figure = _figure(lane.value, lane.greedy_ends, decimals, glyphs)
    return f"{name}: {figure}{_GREEDY if greedy else ''}{greedy}"


def _figure(value: float | None, ends: float | None, decimals: int, glyphs: Glyphs) -> str:
    """Return a return, or that a policy has none because it may never end; empty if neither is known."""
    if value is not None:
        return amount(value, decimals, glyphs)
    return "" if ends is None else no_end(ends, short=True)


def _has_no_line(lane: LaneLine) -> bool:
    return lane.is_exact and lane.greedy_ends is not None


def _place(lane: LaneLine) -> float:
    return -math.inf if lane.value is None else lane.value


def _style(lane: LaneLine, look: Look) -> Style:
    style = look.palette.lanes[lane.number - 1]
    return style + Style(bold=True) if lane.shown else style
