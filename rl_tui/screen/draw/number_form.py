"""One form for all numbers of a panel, with as many decimals as fit most of them.

Larger numbers get fewer decimals. Small ones become ``<.01`` or ``0⁺`` instead of zero.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from typing import Final, NamedTuple

import numpy as np

from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.precision import leading_zeros
from rl_tui.screen.theme.glyphs import ASCII, UNICODE, Glyphs
from rl_tui.worlds.mdp.space import FloatArray, IntArray

TINY: Final = ("0⁻", "0⁺"), ("0-", "0+")
"""Almost zero, negative and positive, then in ASCII."""
_BULK: Final = 0.8  # share of the numbers whose decimals must fit; others are shortened
_AT_EASE: Final = 1.1  # a form gets finer only if numbers larger by this factor fit too
_BULK_AT_EASE: Final = 0.9  # and if this share of them fits
Values = Sequence[float] | FloatArray


class NumberForm(NamedTuple):
    """How a panel writes its numbers."""

    width: int
    decimals: int
    has_exponent: bool = False
    leading_zero: bool = True
    marks_by_bound: bool = True
    cells: int = 0

    @property
    def fineness(self) -> tuple[bool, int]:
        """A key: finer forms show smaller numbers."""
        return self.has_exponent, self.decimals

    def text(self, x: float, glyphs: Glyphs = UNICODE) -> str:
        """Write ``x`` in this form, or the longest that fits."""
        if not math.isfinite(x):
            return numbers.value(x, self.width, glyphs)
        if abs(x) < numbers.NEGLIGIBLE:
            x = 0.0
        text = self.written(x, glyphs)
        is_short = len(text) > self.width or not self.decimals
        if is_short and 0.0 < abs(x) < 1.0 - numbers.NEGLIGIBLE and not self.has_exponent:
            text = self._fraction(x, glyphs)
        if x and not numbers.has_digits(text):
            text = self._tiny(x, glyphs)
        return text if len(text) <= self.width else numbers.value(x, self.width, glyphs, self.decimals)

    def written(self, x: float, glyphs: Glyphs) -> str:
        """Round a finite ``x``, of any length."""
        if not self.has_exponent:
            return numbers.fixed(x, self.decimals, glyphs, self.leading_zero)
        if not x:
            return "0"
        mantissa, exponent = f"{abs(x):.{self.decimals}e}".split("e")
        return f"{glyphs.minus if x < 0.0 else ''}{mantissa}e{int(exponent)}"

    def _fraction(self, x: float, glyphs: Glyphs) -> str:
        text = ""
        for decimals in range(self.shown_decimals, 0, -1):
            nearest = math.copysign(min(abs(x), 1.0 - 10.0**-decimals), x)
            text = numbers.fixed(nearest, decimals, glyphs, leading_zero=False)
            if len(text) <= self.width:
                break
        return text

    @property
    def shown_decimals(self) -> int:
        """The decimals of fractions, at least one."""
        return max(1, self.decimals)

    def _tiny(self, x: float, glyphs: Glyphs) -> str:
        if self.marks_by_bound:
            least = _least(self.shown_decimals, glyphs)
            return f">{glyphs.minus}{least}" if x < 0.0 else f"<{least}"
        return TINY[glyphs is ASCII][x > 0.0]


class SteadyForms:
    """Steady forms, so that columns do not jump."""

    def __init__(self) -> None:
        self._forms: dict[Hashable, NumberForm] = {}

    def clear(self) -> None:
        """Forget all forms."""
        self._forms.clear()

    def form(self, key: Hashable, values: Values, width: int, most: int = numbers.DECIMALS) -> NumberForm:
        """Return the earlier form under ``key`` if it still fits, else a new one."""
        form, before = number_form(values, width, most), self._forms.get(key)
        if before is not None and before.width == width:
            if form.fineness > before.fineness:
                at_ease = _form(_AT_EASE * np.asarray(values), width, most, _BULK_AT_EASE)
                form = at_ease if at_ease.fineness > before.fineness else before
            form = form._replace(cells=max(form.cells, before.cells))  # longer numbers may come again
            if form.fineness == before.fineness:
                form = form._replace(
                    leading_zero=form.leading_zero and before.leading_zero,
                    marks_by_bound=form.marks_by_bound and before.marks_by_bound,
                )
        self._forms[key] = form
        return form


def number_form(values: Values, width: int, most: int = numbers.DECIMALS) -> NumberForm:
    """Return the form for the finite ``values``.

    It has ``most`` decimals if they fit four of five numbers, more if all are below .01.
    """
    return _form(np.asarray(values, dtype=np.float64), width, most, _BULK)


def _form(values: FloatArray, width: int, most: int, bulk: float) -> NumberForm:
    values = values[np.isfinite(values) & (np.abs(values) >= numbers.NEGLIGIBLE)]
    ends = [float(values.min()), float(values.max())] if len(values) else [0.0, 0.0]
    largest = max(map(abs, ends))
    wanted = most + max(0, leading_zeros(largest) - 1) if largest else most
    form = _plain(values, ends, width, wanted, bulk)
    if 0.0 < largest < 10.0**-form.decimals:
        exponents = (NumberForm(width, decimals, has_exponent=True) for decimals in (1, 0))
        form = next((each for each in exponents if _fit(each, ends)), form)
    room = len(_least(form.shown_decimals, UNICODE)) + (2 if ends[0] < 0.0 else 1)
    cells = max(len(form.text(end)) for end in (*ends, 0.0)) if _fit(form, ends) else width
    return form._replace(cells=cells, marks_by_bound=room <= width)


def _plain(values: FloatArray, ends: list[float], width: int, wanted: int, bulk: float) -> NumberForm:
    leads = (True, False) if width >= numbers.ROOM_FOR_ZERO else (False,)
    for decimals in range(wanted, -1, -1):
        for leading_zero in leads:
            form = NumberForm(width, decimals, leading_zero=leading_zero)
            fitting = np.count_nonzero(_lengths(form, values) <= width) if len(values) else 0
            if _fit(form, ends) or 0 < bulk * len(values) <= fitting:
                return form
    return NumberForm(width, 0, leading_zero=False)


def _fit(form: NumberForm, ends: list[float]) -> bool:
    return all(len(form.written(end, UNICODE)) <= form.width for end in ends)


def _lengths(form: NumberForm, values: FloatArray) -> IntArray:
    rounded = np.round(np.abs(values), form.decimals)
    whole = np.floor(np.log10(np.maximum(rounded, 1.0))).astype(np.int64) + 1
    if form.decimals and not form.leading_zero:
        whole -= rounded < 1.0
    return whole + (values < 0.0) + (1 + form.decimals if form.decimals else 0)


def _least(decimals: int, glyphs: Glyphs) -> str:
    return numbers.fixed(10.0**-decimals, decimals, glyphs, leading_zero=False)
