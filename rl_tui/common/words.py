"""Formatting of counts and times."""

from __future__ import annotations

from typing import Final

_UNITS: Final = (("s", 1), ("min", 60), ("h", 3_600), ("days", 86_400), ("years", 31_557_600))
_MOST_OF_A_UNIT: Final = 120  # larger values use the next unit
_SHORT: Final = (("", 1), ("k", 10**3), ("M", 10**6), ("G", 10**9), ("T", 10**12))


def counted(count: int, thing: str) -> str:
    """Return a count with its noun: ``1 step``, ``1,200 steps``."""
    return f"{count:,} {thing}{'' if count == 1 else 's'}"


def lasting(seconds: float) -> str:
    """Return a duration in whole units: ``1 s``, ``40 min``, ``3 days``, ``12 years``."""
    word, size = next((each for each in _UNITS if seconds < _MOST_OF_A_UNIT * each[1]), _UNITS[-1])
    return f"{max(1, round(seconds / size)):,} {word}"


def short_count(count: int) -> str:
    """Return a count in at most six characters below 10^16: ``950``, ``1.2k``, ``1000T``."""
    letter, size = next((each for each in reversed(_SHORT) if count >= each[1]), _SHORT[0])
    digits = 1 if size > 1 and count < 100 * size else 0
    return f"{count / size:.{digits}f}{letter}"
