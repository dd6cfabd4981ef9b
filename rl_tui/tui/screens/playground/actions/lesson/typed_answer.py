"""A number as learners type it: decimals, fractions, a minus of print."""

from __future__ import annotations

import math
import re
from typing import Final

_FRACTION: Final = re.compile(r"([+-]?\d{1,9}(?:\.\d{1,9})?)\s*/\s*(\d{1,9}(?:\.\d{1,9})?)")
_NUMBER: Final = re.compile(r"[+-]?(?:\d{1,15}(?:\.\d{0,15})?|\.\d{1,15})(?:[eE][+-]?\d{1,3})?")
_THOUSANDS: Final = re.compile(r"[+-]?\d{1,3}(?:,\d{3})+")
EXPECTED: Final = "type a number, such as 0.5, -2 or 1/3"
DECIMAL_POINT: Final = "write a decimal point, not a comma: 0.5"


def read_answer(text: str) -> float:
    """Return the number that ``text`` is; raises ValueError with what to type where it is none."""
    written = text.strip().replace("−", "-").replace("–", "-")
    if fraction := _FRACTION.fullmatch(written):
        below = float(fraction[2])
        if below == 0.0:
            raise ValueError("nothing can be divided by 0")
        return float(fraction[1]) / below
    if _NUMBER.fullmatch(written) and math.isfinite(value := float(written)):
        return value
    if _THOUSANDS.fullmatch(written) and not re.fullmatch(r"[+-]?0,\d+", written):
        return float(written.replace(",", ""))
    if re.fullmatch(r"[+-]?\d*,\d+", written):
        raise ValueError(DECIMAL_POINT)
    raise ValueError(EXPECTED)
