"""The ladder of speeds that + and − climb."""

from __future__ import annotations

from typing import Final

_LADDER: Final[tuple[float | None, ...]] = (
    *(float(digit * 10**power) for power in range(5) for digit in (1, 3)),
    100_000.0,
    None,
)


def faster(speed: float | None) -> float | None:
    """Return the next higher speed in steps a second; None is as fast as it goes."""
    if speed is None:
        return None
    return next(each for each in _LADDER if each is None or each > speed)


def slower(speed: float | None) -> float | None:
    """Return the next lower speed in steps a second, 1 at the lowest."""
    below = [each for each in _LADDER if each is not None and (speed is None or each < speed)]
    return below[-1] if below else _LADDER[0]
