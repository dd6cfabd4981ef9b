"""The words of the return curve: its title, the names at the ends of its lines, and the remark below it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from rich.style import Style

from rl_tui.lab.snapshot import Snapshot
from rl_tui.tui import numbers
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.tui.theme.look import Look
from rl_tui.tui.widgets.curve_data import CurveData
from rl_tui.tui.widgets.update_text import setting
from rl_tui.tui.written import written

ROOM_FOR_LONG: Final = 50
ROOM_FOR_NUMBERS: Final = 30
ROOM_FOR_NAMES: Final = 20
_NUMBER: Final = 6  # cells of the widest number beside a name
_ENOUGH_EPISODES: Final = 100


@dataclass(frozen=True, slots=True)
class Label:
    """The name of a line, to stand where the line ends, at ``value``."""

    text: str
    value: float
    style: Style


def decimals_for(low: float, high: float) -> int:
    """Return the decimals that tell values on an axis from ``low`` to ``high`` apart: 2 on 0 .. 1."""
    extent = max(high - low, numbers.NEGLIGIBLE)
    return min(5, max(0, 2 - math.floor(math.log10(extent))))


def amount(x: float, decimals: int, glyphs: Glyphs) -> str:
    """Return ``x`` beside a curve: ``.73``, ``7.5``, ``−12``."""
    if abs(x) < numbers.NEGLIGIBLE:
        return "0"
    text = numbers.fixed(x, decimals, glyphs, leading_zero=False)
    return text if len(text) <= _NUMBER else numbers.value(x, _NUMBER, glyphs)


def labels(data: CurveData, look: Look, decimals: int, room: int) -> list[Label]:
    """Return the names for a plot of ``room`` columns, the most important first; none if it is small."""
    palette = look.palette
    names = _names(data.is_bandit, room)
    if names is None:
        return []
    lines = (
        (names[0], data.greedy_now, palette.greedy_line),
        (names[1], data.mean_now, palette.episodes),
        (names[2], data.optimum, palette.optimum),
    )
    return [
        Label(written(_with_number(name, value, decimals, room, look.glyphs), look.glyphs), value, style)
        for name, value, style in lines
        if value is not None
    ]


def label_columns(data: CurveData, look: Look, room: int) -> int:
    """Return how many columns the names take at most, their distance from the line included."""
    names = _names(data.is_bandit, room)
    if names is None:
        return 0
    number = _NUMBER if room >= ROOM_FOR_NUMBERS else 0
    return 2 + max(len(written(name, look.glyphs)) for name in names) + number


def _names(is_bandit: bool, room: int) -> tuple[str, str, str] | None:
    """Return what greedy line, mean and optimum are called."""
    if room >= ROOM_FOR_LONG:
        if is_bandit:
            return "greedy arm, exact", "pulls, mean", "best arm"
        return "greedy, exact", "episodes, mean", "optimum for this γ"
    if room < ROOM_FOR_NAMES:
        return None
    return ("greedy arm", "mean", "best arm") if is_bandit else ("greedy", "episodes", "optimum")


def _with_number(name: str, value: float, decimals: int, room: int, glyphs: Glyphs) -> str:
    return f"{name} {amount(value, decimals, glyphs)}" if room >= ROOM_FOR_NUMBERS else name


def title(data: CurveData | None, glyphs: Glyphs, decimals: int, width: int) -> str:
    """Return the title of a panel ``width`` cells wide; a narrow one names greedy return and optimum."""
    if data is not None and data.is_bandit:
        return "Reward per pull"
    if width >= ROOM_FOR_LONG or data is None or data.greedy_now is None:
        return "Return per episode"
    optimum = "" if data.optimum is None else f" of {amount(data.optimum, decimals, glyphs)}"
    return f"Return · greedy {amount(data.greedy_now, decimals, glyphs)}{optimum}"


def remark(snapshot: Snapshot, data: CurveData, glyphs: Glyphs, decimals: int) -> tuple[str, ...]:
    """Return what is to be said of the picture, longest form first; empty where there is nothing."""
    if data.hidden:
        return (
            "h adds the best arm and the greedy arm, exact",
            "h adds best and greedy arm",
            "h adds the optimum",
        )
    if data.greedy_now is None or data.mean_now is None or data.finished < _ENOUGH_EPISODES:
        return ()
    gap = data.greedy_now - data.mean_now
    epsilon = snapshot.hyperparameters.epsilon_at(snapshot.episodes)
    cost = amount(gap, decimals, glyphs)
    if not any(digit in cost for digit in "123456789") or gap < 0.0 or epsilon == 0.0:
        return ()
    what, rate = ("a pull" if data.is_bandit else "a return"), setting(round(epsilon, 3), glyphs)
    return (
        f"gap {cost} {what}: mostly what exploring (ε {rate}) costs",
        f"gap {cost}: mostly exploring (ε {rate})",
        f"gap {cost}: mostly exploring",
    )


def empty_words(*, is_bandit: bool) -> tuple[str, ...]:
    """Return what to do before the first episode has ended."""
    if is_bandit:
        return "no arm has been pulled yet:", "space runs, s pulls once"
    return "no episode has ended yet:", "space runs, e runs one episode"


def barren_words(data: CurveData) -> tuple[str, ...]:
    """Return that nothing was ever earned."""
    return "no reward seen yet", f"in {data.finished:,} {'pulls' if data.is_bandit else 'episodes'}"
