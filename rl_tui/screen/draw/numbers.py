"""Numbers for people, never too wide."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Final

from rl_tui.screen.theme.glyphs import UNICODE, Glyphs

DECIMALS: Final = 3
NEGLIGIBLE: Final = 1e-9  # precision of the exact answers; smaller differences mean nothing
ROOM_FOR_ZERO: Final = 5  # from this width on fractions are written 0.54, below it .54
_COMMA_FROM: Final = 10_000
_FIGURE_DECIMALS: Final = ((3, 1.0), (2, 100.0), (1, 1_000.0))  # decimals of metrics below that bound
_LEAST_FIGURE: Final = 6  # cells of a shortened metric
_THOUSANDS_TO: Final = 1e6  # larger numbers are easier to read with an exponent
_DIGITS: Final = frozenset("123456789")
_SCALES: Final = ((1.0, ""), (1e3, "k"), (1e6, "M"), (1e9, "G"), (1e12, "T"))


def value(x: float, width: int, glyphs: Glyphs = UNICODE, decimals: int = DECIMALS) -> str:
    """Write the most decimals: ``.54``, ``−1.20``, ``1.2e6``."""
    if not math.isfinite(x):
        text = "nan" if math.isnan(x) else "inf" if x > 0 else f"{glyphs.minus}inf"
        return text if len(text) <= width else "#" * width
    if abs(x) < NEGLIGIBLE:
        x = 0.0
    leading_zero = width >= ROOM_FOR_ZERO
    plain = _widest_that_fits(
        (fixed(x, each, glyphs, leading_zero) for each in range(decimals, -1, -1)), width
    )
    if plain and (x == 0.0 or has_digits(plain)):
        return plain
    forms = _with_exponent(x, glyphs) if abs(x) < 1.0 else _in_short(x, glyphs)
    return _widest_that_fits(forms, width) or plain or "#" * width


def missing(glyphs: Glyphs) -> str:
    """Return the dash for a missing number."""
    return "-" if glyphs.name == "ascii" else "–"


def figure(x: float, width: int, glyphs: Glyphs = UNICODE) -> str:
    """Write an exact metric (≥ 6 cells): ``.119``, ``13.00``, ``−1.3e5``."""
    size = abs(x)
    decimals = next((each for each, end in _FIGURE_DECIMALS if round(size, each) < end), 0)
    text = fixed(x, decimals, glyphs, leading_zero=False) if decimals else whole(x, glyphs)
    if not has_digits(text):
        return "0" if size < NEGLIGIBLE else value(x, _LEAST_FIGURE, glyphs)
    return text if len(text) <= width else value(x, _LEAST_FIGURE, glyphs)


def whole(x: float, glyphs: Glyphs = UNICODE) -> str:
    """Write no decimals, but commas from 10,000 on: ``−6146``, ``−65,375``."""
    text = fixed(x, 0, glyphs)
    return f"{x:,.0f}".replace("-", glyphs.minus) if abs(float(f"{x:.0f}")) >= _COMMA_FROM else text


def fixed(x: float, decimals: int, glyphs: Glyphs = UNICODE, leading_zero: bool = True) -> str:
    """Write ``x`` (``.54`` without ``leading_zero``), but never ``−0``."""
    text = f"{x:.{decimals}f}"
    if text.startswith("-"):
        text = f"{glyphs.minus}{text[1:]}" if has_digits(text) else text[1:]
    return text if leading_zero else _without_leading_zero(text)


def brief(x: float, glyphs: Glyphs = UNICODE, leading_zero: bool = False, decimals: int = 6) -> str:
    """Write the fewest decimals: ``−2``, ``.1``, ``.333333``."""
    if abs(x) >= 1e7 or 0.0 < abs(x) < 10.0**-decimals:
        return scientific(x, 2, glyphs)
    text = fixed(x, decimals, glyphs)
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return text if leading_zero else _without_leading_zero(text)


def scientific(x: float, decimals: int, glyphs: Glyphs = UNICODE) -> str:
    """Write an exponent: ``2.73e-5``, ``−3e11``."""
    mantissa, exponent = f"{x:.{decimals}e}".split("e")
    if "." in mantissa:
        mantissa = mantissa.rstrip("0").rstrip(".")
    return f"{mantissa}e{int(exponent)}".replace("-", glyphs.minus, 1 if x < 0 else 0)


def count(n: int, width: int | None = None) -> str:
    """Write ``n`` ≥ 0 with commas, or short: ``12.3k``."""
    text = f"{n:,}"
    if width is None or len(text) <= width:
        return text
    forms = [_scaled(n, decimals, "") for decimals in (1, 0)]
    return next((form for form in forms if len(form) <= width), forms[-1])


def rate(steps_per_second: float) -> str:
    """Write a short speed: ``38 M/s``, ``950/s``."""
    return f"{_speed(steps_per_second, short=True)}/s"


def long_rate(steps_per_second: float) -> str:
    """Write ``37.4 M steps/s``, ``950 steps/s``."""
    return f"{_speed(steps_per_second, short=False)} steps/s"


def percent(share: float) -> str:
    """Write a share (0 to 1) in per cent, 0 % and 100 % only if exact."""
    whole = round(100.0 * share)
    if whole == 100 and share < 1.0:
        return ">99 %"
    if whole == 0 and share > 0.0:
        return "<1 %"
    return f"{whole} %"


def _speed(x: float, short: bool) -> str:
    exact = _scaled(x, 1, " ")
    number, _, unit = exact.partition(" ")
    return exact if float(number) < 10 or (unit and not short) else _scaled(x, 0, " ")


def _scaled(x: float, decimals: int, gap: str) -> str:
    texts = [(f"{x / scale:.{decimals}f}", unit) for scale, unit in _SCALES]
    text, unit = next((each for each in texts if float(each[0]) < 1_000), texts[-1])
    return f"{text}{gap}{unit}" if unit else text


def _in_short(x: float, glyphs: Glyphs) -> list[str]:
    exponents = _with_exponent(x, glyphs)
    longer = [form for form in exponents if "." in form or abs(x) >= _THOUSANDS_TO]
    shortest = exponents[-1]
    units = [(x / scale, unit) for scale, unit in _SCALES[1:]]
    whole = [fixed(part, 0, glyphs) + unit for part, unit in units if 1.0 <= abs(part) < 999.5]
    tenths = [
        fixed(part, 1, glyphs, leading_zero=False) + unit for part, unit in units if 0.095 <= abs(part) < 0.95
    ]
    bound = [f"<{glyphs.minus}1T" if x < 0.0 else ">1T"] if abs(x) > 1e12 else []
    return [*longer, *whole, shortest, *tenths, *bound]


def _with_exponent(x: float, glyphs: Glyphs) -> list[str]:
    return [scientific(x, decimals, glyphs) for decimals in (2, 1, 0)]


def _without_leading_zero(text: str) -> str:
    return text.replace("0.", ".", 1) if text.lstrip("−-").startswith("0.") else text


def _widest_that_fits(forms: Iterable[str], width: int) -> str:
    return next((form for form in forms if len(form) <= width), "")


def has_digits(text: str) -> bool:
    """Return whether a digit is not 0."""
    return not _DIGITS.isdisjoint(text)
