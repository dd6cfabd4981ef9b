"""Numbers of one equation, rounded so that it holds as printed."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

from rl_tui.screen.draw import numbers
from rl_tui.screen.theme.glyphs import Glyphs

_LONGEST: Final = 6  # decimals that are always written out
_SMALL: Final = 1e-3  # smaller numbers get more decimals only if that is shorter than an exponent
_LARGEST: Final = 1e6  # from here on numbers have an exponent
_SLACK: Final = 1e-6  # of a digit: error of binary fractions


def figure(x: float, decimals: int, glyphs: Glyphs, nothing: float = numbers.NEGLIGIBLE) -> str:
    """Round ``x`` to ``decimals`` (−3: to thousands): ``.000130``, ``1.3e-8``, ``−3e11``.

    Numbers up to ``nothing`` become 0. Tiny ones keep three digits.
    """
    if not math.isfinite(x):
        return str(x).replace("-", glyphs.minus)
    if abs(x) <= nothing:
        return "0"
    rounded, short = round(x, decimals), round(x, 1)
    if abs(x) < _LARGEST and (decimals > 0 or not rounded) and short and abs(short - x) <= nothing:
        return numbers.brief(short, glyphs)
    if not rounded:
        return numbers.scientific(x, 2, glyphs)
    exponent = numbers.scientific(rounded, max(0, magnitude(rounded) + decimals), glyphs)
    if decimals < 0 or (decimals == 0 and abs(rounded) >= _LARGEST):
        return exponent
    plain = numbers.fixed(x, max(0, decimals), glyphs, leading_zero=False)
    is_short = decimals <= _LONGEST or abs(rounded) >= _SMALL or len(plain) <= len(exponent)
    return plain if is_short else exponent


def column_figure(x: float, decimals: int, glyphs: Glyphs) -> str:
    """Write exactly ``decimals`` decimals: ``.542``, ``0``, ``−1.250``."""
    if abs(x) < numbers.NEGLIGIBLE:
        return "0"
    if abs(x) >= _LARGEST:
        return numbers.value(x, 8, glyphs)
    text = numbers.fixed(x, decimals, glyphs, leading_zero=False)
    return text if numbers.has_digits(text) else numbers.value(x, 6, glyphs)


def parsed(text: str, glyphs: Glyphs) -> float:
    """Read a printed number."""
    return float(text.replace(glyphs.minus, "-"))


def agrees(worked_out: float, shown: str, glyphs: Glyphs, decimals: int, digits: float = 1.0) -> bool:
    """Return whether both agree within ``digits`` of the last decimal."""
    known = parsed(shown, glyphs)
    unit = float(10.0**-decimals)
    if 0.0 < abs(known) <= 0.5 * unit:
        unit = last_digit(shown)
    allowed: float = (digits + _SLACK) * unit
    return abs(worked_out - known) <= allowed


def comes_to(worked_out: float, shown: str, glyphs: Glyphs) -> bool:
    """Return whether both agree within the last printed digit."""
    return abs(worked_out - parsed(shown, glyphs)) <= last_digit(shown)


def in_brackets(number: str, glyphs: Glyphs) -> str:
    """Put a negative number in brackets."""
    return f"({number})" if number.startswith(glyphs.minus) else number


def magnitude(x: float) -> int:
    """Return the first digit's power of ten: −3 for .0042, 0 for 0."""
    return math.floor(math.log10(abs(x))) if x else 0


def leading_zeros(*values: float) -> int:
    """Return the largest number's zeros after the point, negative for large ones."""
    largest = magnitude(max((abs(each) for each in values if math.isfinite(each)), default=0.0))
    return max(0, -1 - largest) if largest < math.log10(_LARGEST) else -largest


def last_digit(text: str) -> float:
    """Return the last digit's unit: .01 for ``.36``."""
    mantissa, _, exponent = text.partition("e")
    return 10.0 ** (int(exponent or "0") - len(mantissa.partition(".")[2]))


def fewest_decimals(fewest: int, most: int, is_enough: Callable[[int], bool]) -> int:
    """Return the fewest sufficient decimals, or ``most``."""
    return next(filter(is_enough, range(fewest, most)), most)
