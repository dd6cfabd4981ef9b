"""The last update, rounded for recalculation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

from rl_tui.agents.last_step import LastStep
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.precision import agrees, figure, leading_zeros, magnitude, parsed
from rl_tui.screen.theme.glyphs import Glyphs

_FEWEST: Final = 2
_MOST_FOR_CHANGE: Final = 4  # a smaller change need not be visible in the estimate
_STEADY: Final = 3  # decimals, so that the equation keeps its form from step to step
_FINER: Final = (0, 1, 2)  # additional decimals of terms, compared with results
_DIGITS: Final = 6  # digits after the first one of the largest term: smaller results are shown as 0
_NOISE: Final = 1e-12  # share of the largest term: rounding errors
_FACTOR: Final = 4  # decimals of a long factor


@dataclass(frozen=True, slots=True)
class UpdateText:
    """The texts of before + step_size · (gathered + discount · bootstrap − before) = after."""

    before: str
    step_size: str
    gathered: str
    discount: str
    bootstrap: str
    target: str
    error: str
    after: str


class _Rounding(NamedTuple):
    terms: int
    results: int


def update_text(last: LastStep, alpha: float | str, glyphs: Glyphs, *, bootstraps: bool) -> UpdateText:
    """Write ``last`` with steady decimals: three below 10, fewer above, and more only if needed.

    Results agree within one last digit. Without ``bootstraps``, the target is ``gathered``.
    """
    largest = magnitude(_largest(last))
    most = _DIGITS - largest
    fewest = min(max(_decimals_that_show(last), _STEADY - max(0, largest)), most)
    for rounding in (_Rounding(each + more, each) for each in range(fewest, most + 1) for more in _FINER):
        text = _written(last, alpha, glyphs, rounding, bootstraps=bootstraps)
        if _comes_out(last, text, rounding, glyphs, bootstraps=bootstraps):
            break
    return text


def _written(
    last: LastStep, alpha: float | str, glyphs: Glyphs, rounding: _Rounding, *, bootstraps: bool
) -> UpdateText:
    largest = _largest(last)
    noise, nothing = _NOISE * largest, 0.5 * 10.0 ** (magnitude(largest) - _DIGITS)

    def term(x: float) -> str:
        return figure(x, rounding.terms, glyphs, noise)

    def result(x: float) -> str:
        return figure(x, rounding.results, glyphs, nothing)

    sign = "+" if last.td_error > nothing else ""
    return UpdateText(
        before=term(last.before),
        step_size=_step_size(last, alpha, rounding.results, glyphs),
        gathered=term(last.gathered),
        discount=_factor(last.discount, last.bootstrap, rounding.results, glyphs),
        bootstrap=term(last.bootstrap),
        target=result(last.target) if bootstraps else term(last.target),
        error=sign + result(last.td_error),
        after=result(last.after),
    )


def setting(x: float, glyphs: Glyphs) -> str:
    """Write two decimals at least: ``.10``, ``.125``, ``1``."""
    if _has_no_more_decimals(x, 0):
        return numbers.brief(x, glyphs)
    if _has_no_more_decimals(x, 2):
        return numbers.fixed(x, 2, glyphs, leading_zero=False)
    return numbers.brief(x, glyphs)


def _step_size(last: LastStep, alpha: float | str, decimals: int, glyphs: Glyphs) -> str:
    visits = round(1.0 / last.step_size) if last.step_size > 0.0 else 0
    if last.step_size != alpha and visits and abs(last.step_size * visits - 1.0) < 1e-12:
        return f"1/{visits}"
    return _factor(last.step_size, last.td_error, decimals, glyphs)


def _factor(x: float, factor: float, decimals: int, glyphs: Glyphs) -> str:
    short = setting(x, glyphs)
    if abs(parsed(short, glyphs) - x) <= 1e-12 * abs(x):
        return short
    needed = max(_FACTOR, decimals + 2 + magnitude(factor))
    return figure(x, needed, glyphs, 0.0)


def _largest(last: LastStep) -> float:
    return max(map(abs, (last.before, last.gathered, last.discount * last.bootstrap)))


def _decimals_that_show(last: LastStep) -> int:
    terms = (last.before, last.bootstrap, last.after, last.td_error)
    zeros = leading_zeros(last.before, last.target, last.after)
    most = _MOST_FOR_CHANGE + zeros
    for decimals in range(_FEWEST + zeros, most):
        honest = all(round(term, decimals) % 1.0 or _has_no_more_decimals(term, 0) for term in terms)
        changed = round(last.before, decimals) != round(last.after, decimals)
        error = last.td_error
        precise = abs(error) >= 10.0 ** (1 - decimals) or _has_no_more_decimals(error, decimals)
        if honest and precise and (changed or last.before == last.after):
            return decimals
    return most


def _comes_out(
    last: LastStep, text: UpdateText, rounding: _Rounding, glyphs: Glyphs, *, bootstraps: bool
) -> bool:
    before, gathered, discount, bootstrap = (
        parsed(each, glyphs) for each in (text.before, text.gathered, text.discount, text.bootstrap)
    )
    step_size = last.step_size if "/" in text.step_size else parsed(text.step_size, glyphs)
    target = gathered + (discount * bootstrap if bootstraps else 0.0)
    # the panel continues from printed results: δ = target − before, Q ← before + α · δ
    chained = (
        (target, text.target),
        (target - before, text.error),
        (before + step_size * (target - before), text.after),
        (parsed(text.target, glyphs) - before, text.error),
        (before + step_size * parsed(text.error, glyphs), text.after),
    )
    return all(agrees(worked_out, shown, glyphs, rounding.results) for worked_out, shown in chained)


def _has_no_more_decimals(x: float, decimals: int) -> bool:
    return abs(round(x, decimals) - x) < numbers.NEGLIGIBLE
