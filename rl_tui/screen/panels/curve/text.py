"""The words of the return curve: its title, the names at the ends of its lines, and the remark below it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np
from rich.style import Style

from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.history import RECENT
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.braille import Steps
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.kit.snapshot_facts import recent_name
from rl_tui.screen.panels.curve import words
from rl_tui.screen.panels.curve.data import CurveData
from rl_tui.screen.panels.policies.names import POLICY_NAMES
from rl_tui.screen.panels.policies.notes import cost_of_exploring
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look

ROOM_FOR_LONG: Final = 50
ROOM_FOR_NUMBERS: Final = 30
ROOM_FOR_NAMES: Final = 20
NUMBER: Final = 6  # cells of the widest number beside a name
_MOST_DECIMALS: Final = 5
_LEAST_FIXED: Final = 2e-4  # extent of an axis whose numbers have no exponents
_STUDIED_NAMES: Final = [name.line for name in POLICY_NAMES.values()]


@dataclass(frozen=True, slots=True)
class LineLabel:
    """The name of a line, to stand where the line ends, at ``value``."""

    text: str
    value: float
    style: Style


def decimals_for(low: float, high: float) -> int:
    """Return the decimals that tell values on an axis from ``low`` to ``high`` apart: 2 on 0 .. 1.

    More than 5 are too many to be written: then all have exponents.
    """
    extent = max(high - low, numbers.NEGLIGIBLE)
    decimals = max(0, 2 - math.floor(math.log10(extent)))
    return min(_MOST_DECIMALS, decimals) if extent >= _LEAST_FIXED else decimals


def amount(x: float, decimals: int, glyphs: Glyphs) -> str:
    """Return ``x`` beside a curve: ``.73``, ``7.5``, ``−12``, ``<.01``."""
    if abs(x) < numbers.NEGLIGIBLE:
        return "0"
    if decimals > _MOST_DECIMALS:
        return numbers.scientific(x, 1, glyphs)
    text = numbers.fixed(x, decimals, glyphs, leading_zero=False)
    if not numbers.has_digits(text):
        least = numbers.fixed(10.0**-decimals, decimals, glyphs, leading_zero=False)
        return f">{glyphs.minus}{least}" if x < 0.0 else f"<{least}"
    text = text if len(text) <= NUMBER else numbers.value(x, NUMBER, glyphs)
    return numbers.whole(x, glyphs) if text.removeprefix(glyphs.minus).isdigit() else text


def no_end(ends: float, *, short: bool = False) -> str:
    """Return what stands in place of the return of a policy that has none: it ``ends`` so likely (0 to 1)."""
    if ends > 0.0:
        share = numbers.percent(ends)
        return f"{share} end" if short else f"ends in {share}"
    return words.NO_END if short else words.NEVER_ENDS


def labels(
    data: CurveData, look: Look, decimals: int, room: int, *, greedy: bool = True, mean: bool = True
) -> list[LineLabel]:
    """Return the names for a plot of ``room`` columns, the most important first; none if it is small.

    ``greedy`` and ``mean`` tell whether those two lines are named.
    """
    palette = look.palette
    names = _names(data, room)
    if names is None:
        return []
    lines: list[tuple[str, float | None, Style]] = [
        (names[0], data.greedy_now if greedy else None, palette.greedy_line),
        (names[1], data.mean_now if mean else None, palette.episodes),
        (names[2], data.optimum, palette.optimum),
    ]
    if data.studied is not None:
        lines.insert(2, (data.studied.name, data.studied.value, palette.good))
    if mean:  # lanes have theirs in the remark
        lines += [
            (f"{each.seeds} seeds{each.until if room >= ROOM_FOR_LONG else ''}", each.value, palette.dim)
            for each in data.seeds
        ]
    most = label_columns(data, look, room, mean=mean) - 2
    found = [
        LineLabel(
            to_ascii(_with_number(name, value, decimals, room, most, look.glyphs), look.glyphs), value, style
        )
        for name, value, style in lines
        if value is not None
    ]
    if not greedy or data.greedy_ends is None:
        return found
    text = f"greedy: {no_end(data.greedy_ends, short=room < ROOM_FOR_LONG)}"
    return [LineLabel(to_ascii(text, look.glyphs), -math.inf, palette.greedy_line), *found]


def label_columns(data: CurveData, look: Look, room: int, *, mean: bool = True) -> int:
    """Return how many columns the names take at most, their distance from the line included.

    It does not change on the way, lest the whole plot be squeezed by a longer name. ``mean`` tells whether
    the mean is named.
    """
    if room < ROOM_FOR_NAMES:
        return 0
    number = 1 + NUMBER if room >= ROOM_FOR_NUMBERS else 0
    greedy, recent, best = _usual_names(data.is_bandit, room, f"{recent_name(RECENT)}:")
    names = [greedy, *([recent] if mean else []), best, *(_STUDIED_NAMES if data.is_studying else [])]
    return 2 + max(len(to_ascii(name, look.glyphs)) for name in names) + number


def _names(data: CurveData, room: int) -> tuple[str, str, str] | None:
    """Return what greedy line, mean and optimum are called; mere ties have no figure."""
    if room < ROOM_FOR_NAMES:
        return None
    names = _usual_names(data.is_bandit, room, f"{recent_name(data.finished)}:")
    return names if data.is_decided or room < ROOM_FOR_NUMBERS else (words.TIES, *names[1:])


def _usual_names(is_bandit: bool, room: int, recent: str) -> tuple[str, str, str]:
    if room >= ROOM_FOR_LONG:
        if is_bandit:
            return words.GREEDY_ARM, f"pulls, {recent}", words.BEST_ARM
        return words.GREEDY, f"episodes, {recent}", words.OPTIMUM
    mean = recent if room >= ROOM_FOR_NUMBERS else "pulls" if is_bandit else "episodes"
    return ("greedy arm", mean, words.BEST_ARM) if is_bandit else ("greedy", mean, words.SHORT_OPTIMUM)


def figure_names() -> tuple[str, ...]:
    """Return all names beside which a number stands, in any room."""
    rooms = (ROOM_FOR_NUMBERS, ROOM_FOR_LONG)
    forms = (
        _usual_names(bandit, room, f"{recent_name(RECENT)}:") for bandit in (False, True) for room in rooms
    )
    return tuple(dict.fromkeys(name for form in forms for name in form))


def _with_number(name: str, value: float, decimals: int, room: int, most: int, glyphs: Glyphs) -> str:
    """Return ``name`` with its number, which is written out where both take ``most`` columns at the most."""
    if room < ROOM_FOR_NUMBERS or name == words.TIES:
        return name
    text, long = amount(value, decimals, glyphs), numbers.whole(value, glyphs)
    fits = not decimals and len(text) < len(long) <= most - len(name) - 1
    return f"{name} {long if fits else text}"


def titles(
    data: CurveData, glyphs: Glyphs, decimals: int, width: int, *, with_figures: bool
) -> tuple[str, ...]:
    """Return titles for ``width`` cells, the longest first.

    A narrow one names greedy return and optimum, if it may be ``with_figures``.
    """
    usual = words.TITLES[data.unit]
    if data.unit != "episode" or width >= ROOM_FOR_LONG or not with_figures:
        return usual
    if data.greedy_ends is not None:
        greedy = f"greedy {no_end(data.greedy_ends)}"
    elif data.greedy_now is not None and data.is_decided:
        greedy = f"greedy {amount(data.greedy_now, decimals, glyphs)}"
    else:
        return usual
    alone = f"{usual[-1]} · {greedy}"
    if data.optimum is None:
        return alone, usual[-1]
    both = f"{greedy} · {words.SHORT_OPTIMUM} {amount(data.optimum, decimals, glyphs)}"
    return f"{usual[-1]} · {both}", both, alone, usual[-1]


def remark(
    snapshot: Snapshot, data: CurveData, glyphs: Glyphs, decimals: int, *, with_figures: bool = True
) -> tuple[str, ...]:
    """Return what is to be said of the picture, longest form first; empty where there is nothing."""
    if data.hides_optimum and not data.has_key:
        return words.KEPT_BACK
    if data.hides_optimum:
        return words.HIDDEN_ARMS if data.is_bandit else words.HIDDEN_OPTIMUM
    if data.greedy_now is None or data.finished < RECENT or not data.is_decided:
        return ()
    if snapshot.program is not None:
        return ()  # how somebody's program explores is not known
    values = snapshot.agent.hyperparameters
    by_epsilon = POLICY_BY_ID[values.policy].explores_by_epsilon
    if by_epsilon and values.epsilon_at(snapshot.counters.episodes) == 0.0:
        return ()
    what = "a pull" if data.is_bandit else "an episode"
    if data.acting_now is None:
        return _gap(data, what, glyphs, decimals) if with_figures else ()
    cost = data.greedy_now - data.acting_now
    if not _is_seen(cost, decimals):
        return ()
    if not with_figures:
        return words.COST_AT_PAUSE
    said, short = cost_of_exploring(cost, amount(abs(cost), decimals, glyphs), snapshot, glyphs)
    return f"{said} {what}: greedy less as it acts", f"{said} {what}", said, short


def _gap(data: CurveData, what: str, glyphs: Glyphs, decimals: int) -> tuple[str, ...]:
    """Return the gap between greedy policy and episodes, where what exploring costs was not asked for."""
    if data.greedy_now is None or data.mean_now is None or not _has_learned(data):
        return ()
    gap = data.greedy_now - data.mean_now
    if not _is_seen(gap, decimals) or gap < 0.0:
        return ()
    said = amount(gap, decimals, glyphs)
    long, short = words.COST_BY_KEY
    return f"gap {said} {what} · {long}", f"gap {said} · {short}", f"gap {said}"


def _is_seen(x: float, decimals: int) -> bool:
    """Return whether so many decimals tell ``x`` from 0."""
    return abs(x) >= numbers.NEGLIGIBLE and (
        decimals > _MOST_DECIMALS or numbers.has_digits(f"{x:.{decimals}f}")
    )


def below_note(
    data: CurveData, plot: Plot, glyphs: Glyphs, decimals: int, *, with_figures: bool = True
) -> tuple[str, ...]:
    """Return which lines of ``plot`` go below its axis and how far, the longest form first; empty if none."""
    lines = zip(data.line_names, data.lines, strict=True)
    below = sorted(
        (float(np.nanmin(line.low)), name, bool(line.low[-1] < plot.scale.low))
        for name, line in lines
        if plot.below(line).any()
    )
    if not below or not data.furthest:
        return ()
    lowest, down = below[0][1], glyphs.down
    figures = [
        f"{name}, {'down to' if is_still else 'once'} {amount(value, decimals, glyphs)}"
        for value, name, is_still in below
    ]
    names = f"{down} {words.BELOW_AXIS}: {' and '.join(name for _, name, _ in below)}"
    if not with_figures:
        return names, f"{down} {lowest} below", f"{down} below"
    return (
        f"{down} {words.BELOW_AXIS}: {' and '.join(figures)}",
        f"{down} {figures[0]}",
        f"{down} {lowest} below",
    )


def gap_note(data: CurveData, plot: Plot) -> tuple[str, ...]:
    """Return why the greedy line of ``plot`` has gaps, the longest form first; empty if it has none."""
    greedy = data.lines[data.line_names.index("greedy")]
    later = Steps(*(each[1:] for each in greedy))  # before anything is learned there is nothing to say
    if not data.furthest or not np.isnan(later.low[:-1]).any() or not plot.has_gap(later):
        return ()
    if not data.has_estimates:
        return words.NO_LINE_WITHOUT_TABLE
    return words.NO_LINE_WITHOUT_END


def all_words(said: tuple[str, ...], below: tuple[str, ...], gap: tuple[str, ...]) -> tuple[str, ...]:
    """Return forms of all three in one line, then of fewer: where the line is short ``below`` is kept.

    It explains a sign of the picture.
    """
    if not below:
        return (*_joined(said, gap), *said, *gap)
    return (*_joined(said, below, gap), *_joined(below, gap), *_joined(said, below), *below)


def _joined(*parts: tuple[str, ...]) -> tuple[str, ...]:
    """Return a form of each of ``parts`` in one line, those of the first kept longest."""
    return tuple(" · ".join(forms) for forms in product(*parts))


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
        return words.NOTHING_LEARNED, f"in {data.finished:,} {data.unit}s, Y tells why"
    finished = "finished " if data.unit == "episode" else ""
    return words.NO_REWARD, f"in {data.finished:,} {finished}{data.unit}s"
