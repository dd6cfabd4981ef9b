"""A number as learners type it: decimals, fractions, a minus of print."""

from __future__ import annotations

import math
import re
from typing import Final

_FRACTION: Final = re.compile(r"([+-]?\d{1,9}(?:\.\d{1,9})?)\s*/\s*(\d{1,9}(?:\.\d{1,9})?)", re.ASCII)
_NUMBER: Final = re.compile(r"[+-]?(?:\d{1,15}(?:\.\d{0,15})?|\.\d{1,15})(?:[eE][+-]?\d{1,3})?", re.ASCII)
EXPECTED: Final = "type a number, such as 0.5, -2 or 1/3"
NO_COMMA: Final = "write a decimal point and no comma: 0.5, or 184616"


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
    if "," in written and _NUMBER.fullmatch(written.replace(",", "")):
        raise ValueError(NO_COMMA)
    raise ValueError(EXPECTED)
