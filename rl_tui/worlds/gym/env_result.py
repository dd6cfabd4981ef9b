"""The results of an environment's reset and step, checked before an agent learns from them."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np

from rl_tui.common.findings import one_line
from rl_tui.worlds.gym.registered import text_of

LONGEST_SHOWN: Final = 80
_VALUES: Final = 5


class UnsoundResultError(Exception):
    """A result of the wrong form; the message goes on after the environment's name."""


def parts_of(result: Any) -> tuple[Any, ...]:
    """Return observation, reward, terminated, truncated and info. Raises UnsoundResultError."""
    if not isinstance(result, tuple | list) or len(result) != _VALUES:
        found = f"{len(result)} values" if isinstance(result, tuple | list) else seen(result)
        raise UnsoundResultError(
            f"answered {found} to a step, which is not observation, reward, terminated, truncated and info"
        )
    return tuple(result)


def first_observation(result: Any) -> Any:
    """Return the observation of a reset, which returns observation and info."""
    if not isinstance(result, tuple | list) or len(result) != 2:
        raise UnsoundResultError(f"answered {seen(result)} to a reset, which is not observation and info")
    return result[0]


def reward_of(value: Any) -> float:
    """Return a reward as a finite number. Raises UnsoundResultError where it is none."""
    if type(value) is float and math.isfinite(value):
        return value
    number = number_of(value)
    if not math.isfinite(number):
        raise UnsoundResultError(f"gave a reward of {seen(value)}, which is not a finite number")
    return number


def number_of(value: Any) -> float:
    """Return a value of an environment as a number, NaN where it is none."""
    if isinstance(value, str | bytes | bytearray):
        return math.nan
    try:
        return float(_single(value))
    except Exception:  # float() of a foreign object may raise anything
        return math.nan


def truth_of(value: Any, what: str) -> bool:
    """Return ``what``, terminated or truncated, as true or false. Raises UnsoundResultError."""
    if value is True or value is False:
        return bool(value)
    single = _single(value)
    if isinstance(single, bool | int | float | np.bool_ | np.number) and single in (0, 1):
        return bool(single)
    raise UnsoundResultError(f"answered {what} = {seen(value)}, which is neither true nor false")


def seen(value: Any) -> str:
    """Return a value of an environment as a short line that is safe to print."""
    text = repr(value) if isinstance(value, str) else text_of(value)
    return one_line(text, LONGEST_SHOWN)


def _single(value: Any) -> Any:
    """Return the only number of an array of one, which Python would not take for a number for much longer."""
    return value.item() if isinstance(value, np.ndarray) and value.size == 1 else value
