"""One form for all numbers of a panel: as many decimals as the largest leaves room for, the same for each.

What such a form would round to zero and is none keeps a sign of it: ``<.01``, ``>−.01``, and where that has
no room ``0⁺``, ``0⁻``. Exponents are written only where all numbers are that small.
"""

from __future__ import annotations

import math
from collections.abc import Hashable
from typing import Final, NamedTuple

from rl_tui.tui.draw import numbers
from rl_tui.tui.draw.precision import leading_zeros
from rl_tui.tui.theme.glyphs import ASCII, UNICODE, Glyphs

_AT_EASE: Final = 2.0  # so many times larger numbers must fit too before a form gets finer again


class NumberForm(NamedTuple):
    """How the numbers of a panel are written, in at most ``width`` cells each.

    ``decimals`` are those of every number, of its mantissa where it ``has_exponent``; with ``leading_zero``
    fractions are 0.54, else .54. ``cells`` are what the longest number takes, ``marks_by_bound`` says that
    there is room for ``<.01``.
    """

    width: int
    decimals: int
    has_exponent: bool = False
    leading_zero: bool = True
    marks_by_bound: bool = True
    cells: int = 0

    @property
    def fineness(self) -> tuple[bool, int]:
        """How small a number this form shows, to compare with others."""
        return self.has_exponent, self.decimals

    def text(self, x: float, glyphs: Glyphs = UNICODE) -> str:
        """Return ``x`` in this form; what is too large for it in the longest form that fits."""
        if not math.isfinite(x):
            return numbers.value(x, self.width, glyphs)
        if abs(x) < numbers.NEGLIGIBLE:
            x = 0.0
        text = self.written(x, glyphs)
        if x and not numbers.has_digits(text):
            text = self._tiny(x, glyphs)
        return text if len(text) <= self.width else numbers.value(x, self.width, glyphs, self.decimals)

    def written(self, x: float, glyphs: Glyphs) -> str:
        """Return a finite ``x`` rounded to these decimals, of any length."""
        if not self.has_exponent:
            return numbers.fixed(x, self.decimals, glyphs, self.leading_zero)
        if not x:
            return "0"
        mantissa, exponent = f"{abs(x):.{self.decimals}e}".split("e")
        return f"{glyphs.minus if x < 0.0 else ''}{mantissa}e{int(exponent)}"

    def _tiny(self, x: float, glyphs: Glyphs) -> str:
        """Return a number that the decimals cannot tell from 0."""
        if self.marks_by_bound:
            least = numbers.fixed(10.0**-self.decimals, self.decimals, glyphs, leading_zero=False)
            return f">{glyphs.minus}{least}" if x < 0.0 else f"<{least}"
        signs = ("0-", "0+") if glyphs is ASCII else ("0⁻", "0⁺")
        return signs[x > 0.0]


class SteadyForms:
    """The forms in force in a panel, so that its columns do not jump while numbers grow and shrink.

    A form gets coarser or wider as soon as it has to. It gets finer again only where numbers twice as large
    would fit too. What belongs together has one ``key``.
    """

    def __init__(self) -> None:
        self._forms: dict[Hashable, NumberForm] = {}

    def clear(self) -> None:
        """Forget all forms: another run begins."""
        self._forms.clear()

    def form(
        self, key: Hashable, low: float, high: float, width: int, most: int = numbers.DECIMALS
    ) -> NumberForm:
        """Return what :func:`number_form` does, or the form that was in force under ``key``."""
        form, before = number_form(low, high, width, most), self._forms.get(key)
        if before is not None and before.width == width:
            if form.fineness > before.fineness:
                at_ease = number_form(_AT_EASE * low, _AT_EASE * high, width, most)
                form = at_ease if at_ease.fineness > before.fineness else before
            if form.fineness == before.fineness:
                # what fitted without leading zeros, or took more cells, may come again
                form = form._replace(
                    cells=max(form.cells, before.cells),
                    leading_zero=form.leading_zero and before.leading_zero,
                    marks_by_bound=form.marks_by_bound and before.marks_by_bound,
                )
        self._forms[key] = form
        return form


def number_form(low: float, high: float, width: int, most: int = numbers.DECIMALS) -> NumberForm:
    """Return the form for numbers from ``low`` to ``high`` (finite) in ``width`` cells.

    It has ``most`` decimals where they fit, more where even the largest number is below .01, and an exponent
    where the largest would not be seen otherwise.
    """
    ends = [0.0 if abs(end) < numbers.NEGLIGIBLE else end for end in (low, high)]
    largest = max(map(abs, ends))
    wanted = most + max(0, leading_zeros(largest) - 1) if largest else most
    form = _plain(ends, width, wanted)
    if 0.0 < largest < 10.0**-form.decimals:
        exponents = (NumberForm(width, decimals, has_exponent=True) for decimals in (1, 0))
        form = next((each for each in exponents if _fits(each, ends)), form)
    longest = f">-{10.0**-form.decimals:.{form.decimals}f}".replace("0.", ".")
    room = len(longest) if ends[0] < 0.0 else len(longest) - 1
    cells = max(len(form.text(end, UNICODE)) for end in ends)
    return form._replace(cells=cells, marks_by_bound=room <= width)


def _plain(ends: list[float], width: int, wanted: int) -> NumberForm:
    leads = (True, False) if width >= numbers.ROOM_FOR_ZERO else (False,)
    for decimals in range(wanted, -1, -1):
        for leading_zero in leads:
            form = NumberForm(width, decimals, leading_zero=leading_zero)
            if _fits(form, ends):
                return form
    return NumberForm(width, 0, leading_zero=False)


def _fits(form: NumberForm, ends: list[float]) -> bool:
    return all(len(form.written(end, UNICODE)) <= form.width for end in ends)
