"""The kernels that this process has as machine code. Others run interpreted, with the same bits."""

from __future__ import annotations

import os
from collections.abc import Callable
from enum import StrEnum
from functools import cache
from typing import Any, Final, NamedTuple, ParamSpec, TypeVar

import numpy as np

from rl_tui.agents.kernels.compiled import CALLED_FROM_PYTHON

Parameters = ParamSpec("Parameters")
Result = TypeVar("Result")

ALWAYS_INTERPRETED: Final = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")
"""True if this process must not use machine code, so that a debugger can step through kernels."""


class Batching(StrEnum):
    """How many runs one call advances."""

    NONE = ""
    """A single run."""
    ONE_BY_ONE = "one by one"
    """Each run to its end, by the loop of a single run."""
    IN_TURN = "in turn"
    """One step each in turn, for runs that share a world with four actions in every state."""


class Loop(NamedTuple):
    """The key of a compiled loop. Planners have no `policy`."""

    algorithm: str
    policy: str
    stepped: bool
    batching: Batching = Batching.NONE


SHARED: Final = Loop("shared", "", stepped=False)
"""The code that every run needs in addition to its loop. It reaches the cache some seconds earlier."""

COMPILED_LOOPS: Final = set[Loop]()
"""Loops that this process has as machine code."""

_MACHINE_CODE: Final[dict[Callable[..., Any], Callable[..., Any]]] = {}


@cache
def interpreted(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """Return `function` as run by Python, without warnings of overflow, as in machine code."""
    return np.errstate(all="ignore")(function)


def fastest(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """Return `function` as machine code if this process has it, else interpreted."""
    return _MACHINE_CODE.get(function) or interpreted(function)


def machine_code(function: Callable[Parameters, Result], *example: Any) -> Callable[Parameters, Result]:
    """Return the machine code of `function`, compiled or read from the cache on the first call.

    With `example` arguments this happens now, for these types only; see
    :func:`rl_tui.agents.compiling.jit.entry`.
    """
    if ALWAYS_INTERPRETED:
        return interpreted(function)
    from rl_tui.agents.compiling.jit import dispatcher_of, entry

    return entry(function, *example) if example else dispatcher_of(function)


def use_machine_code(function: Callable[..., Any], *example: Any) -> None:
    """Let :func:`fastest` return machine code of `function`, made now if there is an `example`."""
    machine_code(function, *example)
    _MACHINE_CODE[function] = machine_code(function)


def use_machine_code_from_python() -> None:
    """Let :func:`fastest` return machine code for all that Python calls."""
    for function, example in CALLED_FROM_PYTHON.items():
        use_machine_code(function, *example())
