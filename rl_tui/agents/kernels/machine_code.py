"""Which kernels this process has as machine code. All others run interpreted, with the same bits.

It knows nothing of numba until machine code is asked for.
"""

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
"""Whether this process is to have no machine code: then a debugger can step through the kernels."""


class Batching(StrEnum):
    """How many runs are advanced by one call."""

    NONE = ""
    """There is one run."""
    ONE_BY_ONE = "one by one"
    """Each in its turn to the end, by the loop of a single one."""
    IN_TURN = "in turn"
    """A step each: where they share a world in which every state has four actions."""


class Loop(NamedTuple):
    """What machine code of the agent–environment loop is compiled for; planners have no ``policy``."""

    algorithm: str
    policy: str
    stepped: bool
    batching: Batching = Batching.NONE


SHARED: Final = Loop("shared", "", stepped=False)
"""What every run needs besides its loop, as if it were one: it is in the cache some seconds before that."""

COMPILED_LOOPS: Final = set[Loop]()
"""Those that this process has as machine code."""

_MACHINE_CODE: Final[dict[Callable[..., Any], Callable[..., Any]]] = {}


@cache
def interpreted(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """Return ``function`` as Python runs it.

    As in machine code, a number that runs away becomes inf or NaN, without a warning.
    """
    return np.errstate(all="ignore")(function)


def fastest(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """Return the machine code of ``function`` where this process has it, else its interpreted form."""
    return _MACHINE_CODE.get(function) or interpreted(function)


def machine_code(function: Callable[Parameters, Result], *example: Any) -> Callable[Parameters, Result]:
    """Return the machine code of ``function``, which is compiled, or read from the cache, when it is called.

    With an ``example`` of its arguments that is done at once, and what is returned takes just these types:
    see :func:`rl_tui.agents.compiling.jit.entry`.
    """
    if ALWAYS_INTERPRETED:
        return interpreted(function)
    from rl_tui.agents.compiling.jit import dispatcher_of, entry

    return entry(function, *example) if example else dispatcher_of(function)


def use_machine_code(function: Callable[..., Any], *example: Any) -> None:
    """Let :func:`fastest` return machine code from now on.

    With an ``example`` of its arguments it is compiled, or read from the cache, at once.
    """
    machine_code(function, *example)
    _MACHINE_CODE[function] = machine_code(function)


def use_machine_code_from_python() -> None:
    """Let :func:`fastest` return machine code of all that Python calls, of what has been imported."""
    for function, example in CALLED_FROM_PYTHON.items():
        use_machine_code(function, *example())
