"""The words of the curve: its title, the labels right of the plot, and its notes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from rich.style import Style

from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.history import RECENT
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.braille import Steps
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.draw.scale import Scale
from rl_tui.screen.panels.curve import words
from rl_tui.screen.panels.curve.data import CurveData
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look

NUMBER: Final = 6  # cells of the widest number in a sentence
_LEAST_NUMBER, _MOST_NUMBER = 3, 5  # cells of a number in a label
_ROOM_FOR_GAP: Final = 15  # columns of labels that begin two columns behind the plot
_TWO_DIGITS: Final = 4.0  # times an axis: from .25 on it counts as 1, which has two decimals
_MOST_DECIMALS: Final = 5
_LEAST_FIXED: Final = 2e-4  # extent of an axis whose numbers have no exponents


@dataclass(frozen=True, slots=True)
class LineLabel:
    """A label right of the plot, ``gap`` columns behind it, in the row of ``value`` (−∞: in any)."""

    text: str
    value: float
    style: Style
    gap: int


def decimals_for(low: float, high: float) -> int:
    """Return the decimals that tell values on an axis from ``low`` to ``high`` apart: 2 on 0 .. 1.

    More than 5 are too many to be written: then all have exponents.
    """
    extent = max(high - low, numbers.NEGLIGIBLE)
    decimals = max(0, 2 - math.floor(math.log10(extent)))
    return min(_MOST_DECIMALS, decimals) if extent >= _LEAST_FIXED else decimals


def decimals_of_labels(scale: Scale) -> int:
    """Return the decimals of the labels right of the plot: two digits tell them apart."""
    return decimals_for(0.0, _TWO_DIGITS * (scale.high - scale.low))


def amount(x: float, decimals: int, glyphs: Glyphs, width: int = NUMBER) -> str:
    """Return ``x`` beside a curve, mostly in ``width`` cells: ``.73``, ``7.5``, ``−12``, ``<.01``."""
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


def no_end(ends: float, *, short: bool = False) -> str:
    """Return what stands in place of the return of a policy that has none: it ``ends`` so likely (0 to 1)."""
    if ends > 0.0:
        share = numbers.percent(ends)
        return f"{share} end" if short else f"ends in {share}"
    return words.NO_END if short else words.NEVER_ENDS


def label_gap(columns: int) -> int:
    """Return how many of the ``columns`` of the labels are between them and the plot."""
    return 1 + (columns >= _ROOM_FOR_GAP)


def labels(
    data: CurveData, look: Look, decimals: int, columns: int, *, greedy: bool = True, mean: bool = True
) -> list[LineLabel]:
    """Return the labels in so many ``columns``, the most important first; none without room.

    ``greedy`` and ``mean`` say whether the greedy line and the mean of the episodes have one.
    """
    if not columns:
        return []
    palette, gap = look.palette, label_gap(columns)
    room = columns - gap
    named: list[tuple[str, float | None, Style]] = [
        (words.GREEDY, data.greedy_now if greedy else None, palette.greedy_line),
        (words.AGENT, data.mean_now if mean and data.unit != "sweep" else None, palette.episodes),
        (
            words.BEST_ARM[columns < _ROOM_FOR_GAP] if data.is_bandit else words.OPTIMAL,
            data.optimum,
            palette.dim,
        ),
    ]
    if data.studied is not None:
        named.insert(2, (data.studied.name, data.studied.value, palette.good))
    if mean:
        named += [(f"{each.seeds} seeds", each.value, palette.dim) for each in data.seeds]
    found = []
    for name, value, style in named:
        if value is not None:
            is_tie = name == words.GREEDY and not data.is_decided
            most = max(_LEAST_NUMBER, min(_MOST_NUMBER, room - len(name) - 1))
            number = words.TIES if is_tie else amount(value, decimals, look.glyphs, most)
            found.append(LineLabel(_in_room(name, number, room), value, style, gap))
    if not greedy or data.greedy_ends is None:
        return found
    text = no_end(data.greedy_ends, short=True)
    if len(words.GREEDY) + 1 + len(text) <= room:
        text = _in_room(words.GREEDY, text, room)
    return [LineLabel(text, -math.inf, palette.greedy_line, gap), *found]


def _in_room(name: str, number: str, room: int) -> str:
    """Return ``name`` and, at the right, ``number`` in ``room`` cells."""
    left = room - len(number) - 1
    return f"{name[:left]:<{left}} {number}"


def heads(data: CurveData, *, has_band: bool) -> tuple[str, ...]:
    """Return the title with its caption, the longest first."""
    title = words.STEPS if data.is_of_steps else words.TITLES[data.unit]
    if data.unit == "sweep":
        return f"{title} · {words.AFTER_SWEEP}", title
    names = (words.MEAN_AND_BAND, words.MEAN) if has_band else (words.MEAN,)
    drawn = [f"{name} of the last {data.mean.window}" for name in names]
    return f"{title} · of each {data.unit}, {drawn[0]}", *(f"{title} · {each}" for each in drawn), title


def remark(
    snapshot: Snapshot, data: CurveData, glyphs: Glyphs, decimals: int, *, with_figures: bool = True
) -> tuple[str, ...]:
    """Return the note on exploring or on what is hidden, the longest form first; empty if there is none."""
    if data.hides_optimum and not data.has_key:
        return words.KEPT_BACK
    if data.is_of_steps:
        return ()
    if data.hides_optimum:
        return words.HIDDEN_ARMS if data.is_bandit else words.HIDDEN_OPTIMUM
    if data.greedy_now is None or data.finished < RECENT or not data.is_decided:
        return ()
    if snapshot.program is not None:
        return ()  # how your program explores is not known
    values = snapshot.agent.hyperparameters
    by_epsilon = POLICY_BY_ID[values.policy].explores_by_epsilon
    if by_epsilon and values.epsilon_at(snapshot.counters.episodes) == 0.0:
        return ()
    if data.acting_now is None:
        return _gap(data, snapshot.results.return_last_100, glyphs, decimals) if with_figures else ()
    cost = data.greedy_now - data.acting_now
    if not _is_seen(cost, decimals):
        return ()
    if not with_figures:
        return words.COST_AT_PAUSE
    said = f"cost of exploring: {amount(cost, decimals, glyphs)}"
    return f"{said} per {data.unit}", said


def _gap(data: CurveData, last_100: float | None, glyphs: Glyphs, decimals: int) -> tuple[str, ...]:
    """Return the gap between greedy policy and the last 100 episodes, if the cost of exploring is unknown."""
    if data.greedy_now is None or last_100 is None or not _has_learned(data):
        return ()
    gap = data.greedy_now - last_100
    if not _is_seen(gap, decimals) or gap < 0.0:
        return ()
    said = f"gap: {amount(gap, decimals, glyphs)}"
    return f"{said} per {data.unit} · {words.COST_BY_KEY}", f"{said} · {words.COST_BY_KEY}", said


def _is_seen(x: float, decimals: int) -> bool:
    """Return whether so many decimals tell ``x`` from 0."""
    return abs(x) >= numbers.NEGLIGIBLE and (
        decimals > _MOST_DECIMALS or numbers.has_digits(f"{x:.{decimals}f}")
    )


def below_note(data: CurveData, plot: Plot, glyphs: Glyphs, decimals: int) -> tuple[str, ...]:
    """Return how far the greedy line of ``plot`` goes below its axis; empty if it does not."""
    greedy = data.lines[0]
    if not data.furthest or not plot.below(greedy).any():
        return ()
    lowest = amount(float(np.nanmin(greedy.low)), decimals, glyphs)
    return (f"{glyphs.off_axis[0]} greedy down to {lowest}",)


def gap_note(data: CurveData, plot: Plot) -> tuple[str, ...]:
    """Return why the greedy line of ``plot`` has gaps, the longest form first; empty if it has none."""
    later = Steps(*(each[1:] for each in data.lines[0]))  # before anything is learned there is nothing to say
    if not data.furthest or not np.isnan(later.low[:-1]).any() or not plot.has_gap(later):
        return ()
    return words.NO_LINE_WITHOUT_END if data.has_estimates else words.NO_LINE_WITHOUT_TABLE


def _has_learned(data: CurveData) -> bool:
    """Return whether the gap may be laid to exploring rather than to what is not known yet.

    That is claimed only of a greedy policy that is more than ties and that, over all the episodes whose mean
    is shown, falls short of the optimum by no more than a third of the optimum's size: .5 and up of .75, −16
    and up of −12.
    """
    if data.greedy_now is None or data.optimum is None or data.barren or not data.is_decided:
        return False
    if data.finished - data.world_since < RECENT:
        return False  # some of them are of another world
    recent = data.greedy.low[data.greedy.end > data.finished - RECENT]
    least = data.optimum - abs(data.optimum) / 3 - numbers.NEGLIGIBLE
    return data.greedy_now >= least and bool((recent >= least).all())


def empty_words(unit: str) -> tuple[str, ...]:
    """Return what to do before the first pull, sweep or episode has ended."""
    if unit == "sweep":
        return words.NO_SWEEP_YET
    if unit == "pull":
        return words.NO_PULL_YET
    return words.NO_EPISODE_YET


def barren_words(data: CurveData) -> tuple[str, ...]:
    """Return that no estimate has moved, and by which key to ask why, or that nothing was ever earned."""
    if data.unlearned:
        return words.NOTHING_LEARNED, f"after {data.finished:,} {data.unit}s; Y explains why"
    return words.NO_REWARD, f"after {data.finished:,} {data.unit}s"
