"""The words of runs side by side on the curve: labels of their lines, and titles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

from rich.cells import cell_len
from rich.style import Style

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.kit.snapshot_facts import recent_name
from rl_tui.screen.panels.curve.data import CurveData, LaneLine
from rl_tui.screen.panels.curve.seed_band import seed_remark
from rl_tui.screen.panels.curve.text import NUMBER, LineLabel, amount, labels, no_end
from rl_tui.screen.panels.curve.words import COUNTS_SEEDS, EQUAL_STEPS, HIDDEN_OPTIMUM, ONE_SEED
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look

_GREEDY: Final = ", greedy "
_LARGEST_SHARE: Final = 0.5  # of the plot that names may take
_TITLE_NAME: Final = 16  # cells of a shortened name in a title
_ROOM_FOR_NAMES: Final = 20
_GAP: Final = 2  # columns between plot and labels
_OTHERS: Final = 16  # columns of the labels that are no run's


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


def lane_labels(data: CurveData, look: Look, decimals: int, columns: int) -> list[LineLabel]:
    """Return the labels in ``columns``: the run shown, the other runs, then the rest."""
    names = [lane.name for lane in data.lanes]
    form = next((each for each in _FORMS if _columns(names, look, each) <= columns), None)
    if form is None:
        return []
    shown = _names(names, look, form.name)
    lanes = sorted(zip(data.lanes, shown, strict=True), key=lambda each: not each[0].shown)
    found = [
        LineLabel(_said(lane, name, form, decimals, look.glyphs), _place(lane), _style(lane, look), _GAP)
        for lane, name in lanes
        if lane.value is not None or _has_no_line(lane)
    ]
    has_greedy = not any(lane.shown and lane.is_exact for lane in data.lanes)
    return [*found, *labels(data, look, decimals, min(columns, _OTHERS), greedy=has_greedy, mean=False)]


def lane_columns(names: Sequence[str], look: Look, room: int) -> int:
    """Return how many of ``room`` columns the labels of runs with these ``names`` take.

    They take the fullest form that leaves the lines their share, else the shortest; none if it is small.
    """
    if room < _ROOM_FOR_NAMES:
        return 0
    widths = [_columns(names, look, form) for form in _FORMS]
    return next((each for each in widths if each <= _LARGEST_SHARE * room), widths[-1])


def lane_heads(data: CurveData, usual: Sequence[str], glyphs: Glyphs) -> tuple[str, ...]:
    """Return titles that say which run is shown, the longest first; ``usual`` are those of a single one."""
    shown, title = next(lane for lane in data.lanes if lane.shown), usual[-1]
    short = f"{len(data.lanes)} runs, {glyphs.cursor}{shown.number}"
    named = f"{short} {shown.name}"
    clipped = f"{short} {_clipped(shown.name, _TITLE_NAME, glyphs.ellipsis)}"
    return f"{title} · {named}", f"{title} · {clipped}", f"{title} · {short}", title


def lane_remark(data: CurveData, look: Look, *, counts_seeds: bool = True) -> tuple[str, ...]:
    """Return what the numbers of the labels are, and of how many seeds, the longest form first.

    ``counts_seeds`` says that M does for these runs.
    """
    if not data.furthest:
        return ()
    if data.seeds:
        return seed_remark(data.seeds, look)
    recent = recent_name(*(lane.finished for lane in data.lanes if not lane.is_exact))
    if any(lane.is_exact for lane in data.lanes):
        return (f"mean of the {recent}, or exact", "mean or exact")
    one = f"mean of the {recent} of {ONE_SEED}"
    if data.hides_optimum and data.has_key:
        return (f"{one} · {HIDDEN_OPTIMUM[-1]}", one, ONE_SEED)
    return (f"{one} · {COUNTS_SEEDS}", one, ONE_SEED) if counts_seeds else (one, ONE_SEED)


def steps_note(data: CurveData) -> tuple[str, ...]:
    """Return why one lane has come further than another, the longest form first; empty where none has."""
    if len({lane.finished for lane in data.lanes if not lane.is_exact}) < 2:
        return ()
    return EQUAL_STEPS


def _columns(names: Sequence[str], look: Look, form: _Form) -> int:
    longest = max(cell_len(name) for name in _names(names, look, form.name))
    number = cell_len(": ") + NUMBER if form.number else 0
    return _GAP + longest + number + (cell_len(_GREEDY) + NUMBER if form.greedy else 0)


def _names(names: Sequence[str], look: Look, width: int) -> list[str]:
    """Return the names in at most ``width`` cells, with their numbers where they would not tell enough."""
    glyphs = look.glyphs
    names = [to_ascii(name, glyphs) for name in names]
    is_enough = look.palette.tells_lanes_apart and glyphs.braille
    if is_enough and all(cell_len(name) <= width for name in names):
        return names
    numbered = (f"{number}) {name}" for number, name in enumerate(names, 1))
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


# The columns of the plot


LEFT: Final = 5
"""Columns of the numbers left of the plot."""
_LABELS: Final = ((60, 15), (36, 13))  # columns of the labels at the right, by the least width


class PlotColumns(NamedTuple):
    """The plot has ``columns`` from column ``left`` on; behind them are ``labels`` columns of labels."""

    left: int
    columns: int
    labels: int


def plot_columns(snapshot: Snapshot, look: Look, width: int) -> PlotColumns:
    """Return the columns of the plot in ``width`` cells, which do not change while a run goes on."""
    left = LEFT if width >= 2 * LEFT else 0
    lanes = snapshot.run_group.lanes
    labels = next((columns for least, columns in _LABELS if width >= least), 0)
    if lanes:
        labels = max(labels, lane_columns([lane.name for lane in lanes], look, width - left))
    return PlotColumns(left, max(1, width - left - labels), labels)
