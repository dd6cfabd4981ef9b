"""Numbers in texts, compared up to their last digit."""

from __future__ import annotations

import math
import re
import unicodedata
from dataclasses import dataclass
from typing import Final

_RAISED: Final = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_NUMBER: Final = re.compile(
    r"(?P<sign>[-+]?)(?P<digits>[0-9]{1,3}(?:,[0-9]{3})+(?:\.[0-9]+)?|[0-9]+(?:\.[0-9]*)?|\.[0-9]+)"
    r"(?:[eE](?P<power>[-+]?[0-9]{1,2})|·10(?P<raised>⁻?[⁰¹²³⁴⁵⁶⁷⁸⁹]{1,2}))?"
)
_POWER_OF_TEN: Final = re.compile(r"(?P<sign>[-+]?)10(?P<raised>⁻?[⁰¹²³⁴⁵⁶⁷⁸⁹]{1,2})")
_FRACTION: Final = re.compile(r"([-+]?[0-9]{1,9})/([0-9]{1,9})")
_EXACT: Final = 1e-9
"""Relative tolerance for fractions and numbers between two digits."""


@dataclass(frozen=True, slots=True)
class WrittenNumber:
    """A number in a text. `unit` is one of its last digit, 0 if exact. `error` follows ±."""

    value: float
    unit: float
    error: WrittenNumber | None = None

    def agrees_with(self, exact: float) -> bool:
        """Return True if `exact`, rounded like this, equals it."""
        slack = _EXACT * max(abs(exact), abs(self.value), self.unit)
        return math.isfinite(exact) and abs(exact - self.value) <= self.unit / 2 + slack


def written_number(text: str) -> WrittenNumber | None:
    """Parse a number, such as `−1.5`, `+4.0`, `184,616`, `52 %`, `14/17`, `5.4·10⁻⁶`, `70.9 ± 0.7`, `⅓`.

    After `≈`, trailing zeros of a whole number are not significant. Return None if `text` is not a number.
    """
    mean, plus_minus, error = text.partition("±")
    if not plus_minus:
        return _single(mean)
    whole = text.strip()
    if whole.startswith("(") and whole.endswith(") %"):  # (70.9 ± 0.7) %
        mean, _, error = (f"{part} %" for part in whole[1:-3].partition("±"))
    number, width = _single(mean), _single(error)
    if number is None or width is None:
        return None
    if error.strip().endswith("%") and not mean.strip().endswith("%"):  # 70.9 ± 0.7 %
        number = WrittenNumber(number.value / 100, number.unit / 100)
    return WrittenNumber(number.value, number.unit, width)


def _single(text: str) -> WrittenNumber | None:
    plain = text.strip().replace("−", "-")
    is_rough = plain.startswith("≈")
    plain = plain.removeprefix("≈").strip()
    scale = 0.01 if plain.endswith("%") else 1.0
    plain = plain.removesuffix("%").strip()
    if len(plain) == 1 and not plain.isdecimal():  # ⅓
        value = unicodedata.numeric(plain, math.nan)
        return None if math.isnan(value) else WrittenNumber(value * scale, 0.0)
    fraction = _FRACTION.fullmatch(plain)
    if fraction is not None:
        return WrittenNumber(int(fraction[1]) / int(fraction[2]) * scale, 0.0) if int(fraction[2]) else None
    power = _POWER_OF_TEN.fullmatch(plain)
    if power is not None:
        value = 10.0 ** int(power["raised"].translate(_RAISED))
        return WrittenNumber(-value if power["sign"] == "-" else value, value)
    match = _NUMBER.fullmatch(plain)
    if match is None:
        return None
    digits = match["digits"].replace(",", "")
    exponent = int(match["power"] or (match["raised"] or "0").translate(_RAISED))
    value = float(f"{match['sign']}{digits}e{exponent}") * scale
    return WrittenNumber(value, _last_digit(digits, is_rough=is_rough) * 10.0**exponent * scale)


def _last_digit(digits: str, *, is_rough: bool) -> float:
    whole, point, decimals = digits.partition(".")
    if point:
        return 10.0 ** -len(decimals)
    zeros = len(whole) - len(whole.rstrip("0"))
    return 10.0**zeros if is_rough and zeros < len(whole) else 1.0


def in_digits_of(exact: float, written: str) -> str:
    """Format `exact` with six digits, or as a percentage like `written`."""
    if not math.isfinite(exact):
        return str(exact)
    if "%" in written:
        return f"{exact * 100:.4g} %"
    number = f"{exact:,.0f}" if exact == int(exact) and abs(exact) < 1e15 else f"{exact:.6g}"
    return number.replace("-", "−")
