"""The update of the last step in numbers, rounded so that it can be checked with a calculator."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from rl_tui.agents.last_step import LastStep
from rl_tui.tui import numbers
from rl_tui.tui.theme.glyphs import Glyphs

_FEWEST: Final = 2
_MOST: Final = 6
_MOST_FOR_CHANGE: Final = 4  # a change that only shows further behind is shown as none
_ROOM_FOR_EXPONENT: Final = 7
_LARGEST: Final = 1e6  # beyond this numbers are written with an exponent, and nobody checks them by hand


@dataclass(frozen=True, slots=True)
class UpdateText:
    """The terms of before + step_size · (gathered + discount · bootstrap − before) = after, as written."""

    before: str
    step_size: str
    gathered: str
    discount: str
    bootstrap: str
    target: str
    error: str
    after: str


@dataclass(frozen=True, slots=True)
class _Rounding:
    """How many decimals the terms of the right-hand side and the results get."""

    terms: int
    results: int


def update_text(last: LastStep, alpha: float | str, glyphs: Glyphs, *, bootstraps: bool) -> UpdateText:
    """Write the numbers of ``last`` with as few decimals (2 to 6) as let the printed arithmetic come out.

    What is worked out from the printed terms, rounded like the printed results, is the printed target, δ and
    new estimate. ``alpha`` is the step size in force: a step of 1/N that is not it is written as a fraction.
    Without ``bootstraps`` the target is what was gathered.
    """
    rounding = _rounding(last, bootstraps)
    terms, results = rounding.terms, rounding.results

    def written(x: float, decimals: int) -> str:
        if abs(x) < numbers.NEGLIGIBLE:
            return "0"
        if abs(x) >= _LARGEST:
            return numbers.value(x, 8, glyphs)
        if _has_no_more_decimals(x, 1):
            return numbers.brief(x, glyphs)
        if _vanishes(x, decimals):
            return numbers.value(x, _ROOM_FOR_EXPONENT, glyphs)
        return numbers.fixed(x, decimals, glyphs, leading_zero=False)

    error = last.td_error
    sign = "+" if error >= numbers.NEGLIGIBLE else ""
    return UpdateText(
        before=written(last.before, terms),
        step_size=step_size_text(last.step_size, alpha, glyphs),
        gathered=written(last.gathered, terms),
        discount=setting(_discount_as_printed(last), glyphs),
        bootstrap=written(last.bootstrap, terms),
        target=written(last.target, results if bootstraps else terms),
        error=sign + written(error, results),
        after=written(last.after, results),
    )


def setting(x: float, glyphs: Glyphs) -> str:
    """Return a hyper-parameter with two decimals, more where it has more: ``.10``, ``.125``, ``1``."""
    if _has_no_more_decimals(x, 0):
        return numbers.brief(x, glyphs)
    if _has_no_more_decimals(x, 2):
        return numbers.fixed(x, 2, glyphs, leading_zero=False)
    return numbers.brief(x, glyphs)


def step_size_text(step_size: float, alpha: float | str, glyphs: Glyphs) -> str:
    """Return ``1/842`` where the step was the sample average's, otherwise the number."""
    visits = round(1.0 / step_size) if step_size > 0.0 else 0
    if step_size != alpha and abs(step_size * visits - 1.0) < 1e-12:
        return f"1/{visits}"
    return setting(step_size, glyphs)


def _rounding(last: LastStep, bootstraps: bool) -> _Rounding:
    """Return the first rounding that comes out, the coarsest one if none does."""
    candidates = list(_candidates(_decimals_that_show(last)))
    return next((each for each in candidates if _comes_out(last, each, bootstraps)), candidates[0])


def _candidates(fewest: int) -> Iterator[_Rounding]:
    for results in range(fewest, _MOST + 1):
        for terms in range(results, min(results + 2, _MOST) + 1):
            yield _Rounding(terms, results)


def _decimals_that_show(last: LastStep) -> int:
    """Return the fewest decimals with which no term looks whole that is not, and the change is seen.

    That is as far as four decimals show it. Of δ two digits are seen, so that it is no rough guess.
    """
    terms = (last.before, last.bootstrap, last.after, last.td_error)
    for decimals in range(_FEWEST, _MOST_FOR_CHANGE):
        honest = all(round(term, decimals) % 1.0 or _has_no_more_decimals(term, 0) for term in terms)
        changed = round(last.before, decimals) != round(last.after, decimals)
        error = last.td_error
        precise = abs(error) >= 10.0 ** (1 - decimals) or _has_no_more_decimals(error, decimals)
        if honest and precise and (changed or last.before == last.after):
            return decimals
    return _MOST_FOR_CHANGE


def _comes_out(last: LastStep, rounding: _Rounding, bootstraps: bool) -> bool:
    before, gathered, bootstrap = (
        _as_printed(x, rounding.terms) for x in (last.before, last.gathered, last.bootstrap)
    )
    target = gathered + (_discount_as_printed(last) * bootstrap if bootstraps else 0.0)
    error = target - before
    after = before + last.step_size * error
    printed_target = _as_printed(last.target, rounding.results) if bootstraps else target
    printed_error, printed_after = (_as_printed(x, rounding.results) for x in (last.td_error, last.after))
    # the inspector's chain works on from printed results: δ = target − before, Q ← before + α · δ
    chained = (
        (target, printed_target),
        (error, printed_error),
        (after, printed_after),
        (printed_target - before, printed_error),
        (before + last.step_size * printed_error, printed_after),
    )
    allowed = 0.5 * 10.0**-rounding.results + numbers.NEGLIGIBLE
    return all(abs(worked_out - printed) <= allowed for worked_out, printed in chained)


def _discount_as_printed(last: LastStep) -> float:
    """Return γ as it is, its powers with four decimals."""
    return last.discount if last.discount == last.gamma else round(last.discount, 4)


def _as_printed(x: float, decimals: int) -> float:
    if _has_no_more_decimals(x, 1) or _vanishes(x, decimals):
        return x
    return round(x, decimals)


def _vanishes(x: float, decimals: int) -> bool:
    """Tell whether so many decimals would show nothing of ``x``, which is then written with an exponent."""
    return numbers.NEGLIGIBLE <= abs(x) < 0.5 * 10.0**-decimals


def _has_no_more_decimals(x: float, decimals: int) -> bool:
    return abs(round(x, decimals) - x) < numbers.NEGLIGIBLE
