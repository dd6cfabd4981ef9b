"""Titles, labels and notes of the curve."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from rich.cells import cell_len
from rich.style import Style

from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.history import RECENT
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.braille import Steps
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.draw.scale import Scale
from rl_tui.screen.kit.panel import MAY_NEVER_END
from rl_tui.screen.kit.snapshot_facts import recent_name
from rl_tui.screen.panels.curve.area import area_of
from rl_tui.screen.panels.curve.data import CurveData, LaneLine
from rl_tui.screen.panels.curve.seed_band import seed_remark
from rl_tui.screen.panels.policies.studied import policy_ink
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look

RETURN: Final = "Return"
REWARD: Final = "Reward"
STEPS: Final = "Steps"
ERROR: Final = "Error"
RMS: Final = "RMS of V"
SWEEPS: Final = "Greedy return"
TITLES: Final = {"episode": RETURN, "pull": REWARD, "sweep": SWEEPS}  # by the unit of the horizontal axis
MEAN: Final = "mean"
MEAN_AND_BAND: Final = "mean and middle half"
AFTER_SWEEP: Final = "exact, after each sweep"

GREEDY: Final = "greedy"
AGENT: Final = "agent"
OPTIMAL: Final = "optimal"
BEST_ARM: Final = ("best arm", "best")
TIES: Final = "tied"
NO_END: Final = "no end"

HIDDEN_ARMS: Final = ("w h: show the best arm", "w h: best arm")
HIDDEN_OPTIMUM: Final = ("w h: show the optimal return", "w h: optimal")
KEPT_BACK: Final = ("exact values: hidden by the lesson", "exact values: hidden")

COST: Final = "cost of exploring"
COST_AT_PAUSE: Final = (f"{COST}: pause to see",)
EXACT_COST_BY_KEY: Final = "t p: exact"
NO_LINE_WITHOUT_TABLE: Final = ("no greedy line: your program has no table", "no table: no greedy line")
NO_LINE_WITHOUT_END: Final = (
    f"gap in greedy: that policy {MAY_NEVER_END}",
    f"gap in greedy: {MAY_NEVER_END}",
)

BELOW_AXIS: Final = "below the axis"
ABOVE_AXIS: Final = "above the axis"
OFF_AXIS: Final = "off the axis"

NOTHING_YET: Final = {
    "sweep": ("no sweep has ended:", "space: run · e: sweep"),
    "pull": ("no arm was pulled:", "space: run · s: pull"),
    "episode": ("no episode has ended:", "space: run · e: episode"),
}
NOTHING_EVER: Final = ("no episode ended:", "your program has ended")
PREDICT: Final = "enter: predict first"
NOTHING_LEARNED: Final = "nothing learned"
NO_REWARD: Final = "no reward yet"
CUT_OFF: Final = "all stop at the limit:"

ONE_SEED: Final = "one seed"
COUNTS_SEEDS: Final = "t m: many seeds"
EQUAL_STEPS: Final = ("equal steps per run, not equal episodes", "equal steps per run")


NUMBER: Final = 6  # cells of the widest number in a sentence
_LEAST_NUMBER, _MOST_NUMBER = 3, 5  # cells of a number in a label
_ROOM_FOR_GAP: Final = 15  # columns of labels from which their gap has two columns
_TWO_DIGITS: Final = 4.0  # times the axis: an axis of .25 counts as 1, which has two decimals
_MOST_DECIMALS: Final = 5
_LEAST_FIXED: Final = 2e-4  # length of an axis whose numbers have no exponents


@dataclass(frozen=True, slots=True)
class LineLabel:
    """A label in the row of ``value`` (−∞: any)."""

    text: str
    value: float
    style: Style
    gap: int


def decimals_for(extent: float) -> int:
    """Return decimals that distinguish values. Over 5 mean exponents."""
    extent = max(extent, numbers.NEGLIGIBLE)
    decimals = max(0, 2 - math.floor(math.log10(extent)))
    return min(_MOST_DECIMALS, decimals) if extent >= _LEAST_FIXED else decimals


def decimals_of_labels(scale: Scale) -> int:
    """Return decimals for two significant digits."""
    return decimals_for(_TWO_DIGITS * (scale.high - scale.low))


def amount(x: float, decimals: int, glyphs: Glyphs, width: int = NUMBER) -> str:
    """Write ``x`` in short: ``.73``, ``−12``, ``<.01``."""
    if abs(x) < numbers.NEGLIGIBLE:
        return "0"
    if decimals > _MOST_DECIMALS:
        return numbers.scientific(x, 1, glyphs)
    text = numbers.fixed(x, decimals, glyphs, leading_zero=False)
    if not numbers.has_digits(text):
        least = numbers.fixed(10.0**-decimals, decimals, glyphs, leading_zero=False)
        return f">{glyphs.minus}{least}" if x < 0.0 else f"<{least}"
    text = text if len(text) <= width else numbers.value(x, width, glyphs)
    return numbers.whole(x, glyphs) if text.removeprefix(glyphs.minus).isdigit() else text


def no_end(ends: float) -> str:
    """Describe a policy that ends with this chance."""
    return f"{numbers.percent(ends)} end" if ends > 0.0 else NO_END


def label_gap(columns: int) -> int:
    """Return the gap between plot and labels."""
    return 1 + (columns >= _ROOM_FOR_GAP)


def labels(
    data: CurveData, look: Look, decimals: int, columns: int, *, greedy: str = GREEDY, mean: bool = True
) -> list[LineLabel]:
    """Return the fitting labels, most important first. ``greedy``: name of the greedy line, if it has one."""
    if not columns:
        return []
    palette, gap = look.palette, label_gap(columns)
    room = columns - gap
    named: list[tuple[str, float | None, Style]] = [
        (greedy, data.greedy_now if greedy else None, palette.greedy_line),
        (
            ERROR.lower() if data.is_of_errors else AGENT,
            data.mean_now if mean and data.unit != "sweep" else None,
            palette.episodes,
        ),
        (BEST_ARM[columns < _ROOM_FOR_GAP] if data.is_bandit else OPTIMAL, data.optimum, palette.dim),
    ]
    if data.studied is not None:
        ink = policy_ink(data.studied.kind, palette)
        named.insert(2, (data.studied.name, data.studied.value, ink))
    if mean:
        named += [(f"{each.seeds} seeds", each.value, palette.dim) for each in data.seeds]
    found = []
    for name, value, style in named:
        if value is not None:
            is_tie = name == greedy and not data.is_decided
            most = max(_LEAST_NUMBER, min(_MOST_NUMBER, room - len(name) - 1))
            number = TIES if is_tie else amount(value, decimals, look.glyphs, most)
            found.append(LineLabel(_in_room(name, number, room), value, style, gap))
    if not greedy or data.greedy_ends is None:
        return found
    text = no_end(data.greedy_ends)
    if len(greedy) + 1 + len(text) <= room:
        text = _in_room(greedy, text, room)
    return [LineLabel(text, -math.inf, palette.greedy_line, gap), *found]


def _in_room(name: str, number: str, room: int) -> str:
    left = room - len(number) - 1
    return f"{name[:left]:<{left}} {number}"


def heads(data: CurveData, *, has_band: bool) -> tuple[str, ...]:
    """Return titles with captions, longest first."""
    if data.is_of_errors:
        return f"{ERROR} · {RMS} over all states", f"{ERROR} · {RMS}", ERROR
    title = STEPS if data.is_of_steps else TITLES[data.unit]
    if data.unit == "sweep":
        return f"{title} · {AFTER_SWEEP}", title
    names = (MEAN_AND_BAND, MEAN) if has_band else (MEAN,)
    drawn = [f"{name} of the last {data.mean.window}" for name in names]
    return f"{title} · of each {data.unit}, {drawn[0]}", *(f"{title} · {each}" for each in drawn), title


def remark(
    snapshot: Snapshot, data: CurveData, glyphs: Glyphs, decimals: int, *, with_figures: bool = True
) -> tuple[str, ...]:
    """Return a note on exploring or hidden values."""
    if data.hides_optimum and not data.has_key:
        return KEPT_BACK
    if data.is_of_steps or data.is_of_errors:
        return ()
    if data.hides_optimum:
        return HIDDEN_ARMS if data.is_bandit else HIDDEN_OPTIMUM
    if data.greedy_now is None or data.finished < RECENT or not data.is_decided:
        return ()
    if snapshot.program is not None:
        return ()  # unknown for a watched program
    values = snapshot.agent.hyperparameters
    by_epsilon = POLICY_BY_ID[values.policy].explores_by_epsilon
    if by_epsilon and values.epsilon_at(snapshot.counters.episodes) == 0.0:
        return ()
    if data.acting_now is None:
        return _gap(data, glyphs, decimals) if with_figures else ()
    cost = data.greedy_now - data.acting_now
    if not _is_seen(cost, decimals):
        return ()
    if not with_figures:
        return COST_AT_PAUSE
    return (f"{COST}: {amount(cost, decimals, glyphs)}",)


def _gap(data: CurveData, glyphs: Glyphs, decimals: int) -> tuple[str, ...]:
    if data.greedy_now is None or data.mean_now is None or not _has_learned(data):
        return ()
    gap = data.greedy_now - data.mean_now
    if not _is_seen(gap, decimals) or gap < 0.0:
        return ()
    said = f"{COST}: about {amount(gap, decimals, glyphs)}"
    return f"{said} · {EXACT_COST_BY_KEY}", said


def _is_seen(x: float, decimals: int) -> bool:
    return abs(x) >= numbers.NEGLIGIBLE and (
        decimals > _MOST_DECIMALS or numbers.has_digits(f"{x:.{decimals}f}")
    )


def off_axis_note(
    data: CurveData, plot: Plot, glyphs: Glyphs, decimals: int, *, with_figures: bool
) -> tuple[str, ...]:
    """Describe the marks at the ends of the axis."""
    if not data.furthest:
        return ()
    below, above = [*glyphs.off_axis]
    area = area_of(plot, data.mean) if len(data.mean.means) and not data.lanes else None
    is_below = any(plot.below(line).any() for line in data.lines)
    if area is not None and area.above.any():
        return (f"{below} {above} {OFF_AXIS}" if is_below else f"{above} {ABOVE_AXIS}",)
    if not is_below:
        return ()
    plain, greedy = f"{below} {BELOW_AXIS}", data.lines[0]
    if not with_figures or not plot.below(greedy).any():
        return (plain,)
    lowest = amount(float(np.nanmin(greedy.low)), decimals, glyphs)
    return f"{below} greedy down to {lowest}", plain


def gap_note(data: CurveData, plot: Plot) -> tuple[str, ...]:
    """Return why the greedy line has gaps."""
    later = Steps(*(each[1:] for each in data.lines[0]))  # a gap before any learning needs no note
    if not data.furthest or not np.isnan(later.low[:-1]).any() or not plot.has_gap(later):
        return ()
    return NO_LINE_WITHOUT_END if data.has_estimates else NO_LINE_WITHOUT_TABLE


def _has_learned(data: CurveData) -> bool:
    """Return whether exploring causes the gap: greedy is near the optimum, not all ties."""
    if data.greedy_now is None or data.optimum is None or data.barren or not data.is_decided:
        return False
    if data.finished - data.world_since < RECENT:
        return False  # some of them belong to another world
    recent = data.greedy.low[data.greedy.end > data.finished - RECENT]
    least = data.optimum - abs(data.optimum) / 3 - numbers.NEGLIGIBLE
    return data.greedy_now >= least and bool((recent >= least).all())


def nothing_yet(data: CurveData) -> tuple[str, str]:
    """Return what is missing before the first episode, pull or sweep has ended, and the key that helps."""
    if data.is_over:
        return NOTHING_EVER
    what, keys = NOTHING_YET[data.unit]
    return what, PREDICT if data.waits_for_prediction else keys


def barren_words(data: CurveData, glyphs: Glyphs) -> tuple[str, ...]:
    """Explain why the curve says little."""
    if data.unlearned:
        return NOTHING_LEARNED, f"after {data.finished:,} {data.unit}s;", "t y explains why"
    if data.barren:
        return NO_REWARD, f"after {data.finished:,} {data.unit}s"
    earned = amount(float(data.curve.return_mean[-1]), 0, glyphs)
    return CUT_OFF, f"return {earned}"


# Labels and titles of several runs


_GREEDY: Final = ", greedy "
_LARGEST_SHARE: Final = 0.5  # share of the plot, for names
_TITLE_NAME: Final = 16  # cells of a shortened name in a title
_ROOM_FOR_NAMES: Final = 20
_GAP: Final = 2  # columns between plot and labels
_OTHERS: Final = 18  # columns of labels that belong to no run


class _Form(NamedTuple):
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
    """Return fitting labels, the shown run first."""
    names = [lane.name for lane in data.lanes]
    form = next((each for each in _FORMS if _columns(names, look, each) <= columns), None)
    if form is None:
        return []
    shown = _names(names, look, form.name)
    lanes = sorted(zip(data.lanes, shown, strict=True), key=lambda each: not each[0].shown)
    found = []
    for lane, name in lanes:
        if lane.value is not None or (lane.is_exact and lane.greedy_ends is not None):
            value, ink = -math.inf if lane.value is None else lane.value, look.palette.lanes[lane.number - 1]
            style = ink + Style(bold=True) if lane.shown else ink
            found.append(LineLabel(_said(lane, name, form, decimals, look.glyphs), value, style, _GAP))
    run = next(lane for lane in data.lanes if lane.shown)
    greedy = "" if run.is_exact else f"{look.glyphs.cursor}{run.number} {GREEDY}"
    return [*found, *labels(data, look, decimals, min(columns, _OTHERS), greedy=greedy, mean=False)]


def _lane_columns(names: Sequence[str], look: Look, room: int) -> int:
    if room < _ROOM_FOR_NAMES:
        return 0
    widths = [_columns(names, look, form) for form in _FORMS]
    return next((each for each in widths if each <= _LARGEST_SHARE * room), widths[-1])


def lane_heads(data: CurveData, usual: Sequence[str], glyphs: Glyphs) -> tuple[str, ...]:
    """Return titles that name the shown run."""
    shown, title = next(lane for lane in data.lanes if lane.shown), usual[-1]
    short = f"{len(data.lanes)} runs, {glyphs.cursor}{shown.number}"
    named = f"{short} {shown.name}"
    clipped = f"{short} {_clipped(shown.name, _TITLE_NAME, glyphs.ellipsis)}"
    return f"{title} · {named}", f"{title} · {clipped}", f"{title} · {short}", title


def lane_remark(data: CurveData, look: Look, *, counts_seeds: bool = True) -> tuple[str, ...]:
    """Return a note on the labels' numbers."""
    if not data.furthest:
        return ()
    if data.seeds:
        return seed_remark(data.seeds, look)
    finished = (lane.finished for lane in data.lanes if not lane.is_exact)
    recent = recent_name(*finished, most=data.mean.window)
    if any(lane.is_exact for lane in data.lanes):
        return (f"mean of the {recent}, or exact", "mean or exact")
    one = f"mean of the {recent} of {ONE_SEED}"
    if data.hides_optimum and data.has_key:
        return (f"{one} · {HIDDEN_OPTIMUM[-1]}", one, ONE_SEED)
    return (f"{one} · {COUNTS_SEEDS}", one, ONE_SEED) if counts_seeds else (one, ONE_SEED)


def steps_note(data: CurveData) -> tuple[str, ...]:
    """Return why episode counts differ between runs."""
    if len({lane.finished for lane in data.lanes if not lane.is_exact}) < 2:
        return ()
    return EQUAL_STEPS


def _columns(names: Sequence[str], look: Look, form: _Form) -> int:
    longest = max(cell_len(name) for name in _names(names, look, form.name))
    number = cell_len(": ") + NUMBER if form.number else 0
    return _GAP + longest + number + (cell_len(_GREEDY) + NUMBER if form.greedy else 0)


def _names(names: Sequence[str], look: Look, width: int) -> list[str]:
    glyphs = look.glyphs
    names = [glyphs.spelled(name) for name in names]
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
    # the colon separates the number from names that end with a digit
    figure = _figure(lane.value, lane.greedy_ends, decimals, glyphs)
    return f"{name}: {figure}{_GREEDY if greedy else ''}{greedy}"


def _figure(value: float | None, ends: float | None, decimals: int, glyphs: Glyphs) -> str:
    if value is not None:
        return amount(value, decimals, glyphs)
    return "" if ends is None else no_end(ends)


# The columns of the plot


LEFT: Final = 5  # columns of the numbers left of the plot
_LABELS: Final = ((60, 15), (36, 14))  # least width, and columns of the labels at the right


class PlotColumns(NamedTuple):
    """The plot from column ``left`` on, then labels."""

    left: int
    columns: int
    labels: int


def plot_columns(snapshot: Snapshot, look: Look, width: int) -> PlotColumns:
    """Divide the columns, which stay during a run."""
    left = LEFT if width >= 2 * LEFT else 0
    lanes = snapshot.run_group.lanes
    labels = next((columns for least, columns in _LABELS if width >= least), 0)
    if lanes:
        labels = max(labels, _lane_columns([lane.name for lane in lanes], look, width - left))
    return PlotColumns(left, max(1, width - left - labels), labels)
