"""Decorators that mark functions for compilation by ``jit.py``. Python still calls the plain functions.

So every kernel has an interpreted form with the same bits, without numba.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, NamedTuple, ParamSpec, TypeVar, cast

Parameters = ParamSpec("Parameters")
Result = TypeVar("Result")

COMPILED: Final[list[Callable[..., Any]]] = []
"""Functions called by machine code, compiled once per argument types and shared."""

CALLED_FROM_PYTHON: Final[dict[Callable[..., Any], Callable[[], tuple[Any, ...]]]] = {}
"""Those called by Python, with a function that returns example arguments. Their types never vary."""

CALLED_BY_KERNELS: Final = set[Callable[..., Any]]()
"""Those called only by machine code."""

INLINED: Final[list[Callable[..., Any]]] = []
"""Functions that machine code inlines."""

FAMILIES: Final[list[Family]] = []
"""Functions that machine code inlines after a choice by the type of the first argument."""


class Family(NamedTuple):
    """A function `dispatch` with `members` by type of the first argument, else `otherwise`."""

    dispatch: Callable[..., Any]
    members: dict[type, Callable[..., Any]]
    otherwise: Callable[..., Any]


def compiled(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """Mark `function` as called by machine code."""
    COMPILED.append(function)
    return function


def compiled_for(
    example: Callable[[], tuple[Any, ...]],
) -> Callable[[Callable[Parameters, Result]], Callable[Parameters, Result]]:
    """Mark a function as :func:`compiled`, and as called from Python with the types of `example`.

    Python calls it through :func:`rl_tui.agents.kernels.machine_code.fastest`.
    """

    def mark(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
        CALLED_FROM_PYTHON[function] = example
        return compiled(function)

    return mark


def for_kernels(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """Mark `function` as called only by kernels: without conversion of Python objects it compiles faster."""
    CALLED_BY_KERNELS.add(function)
    return compiled(function)


def inlined(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """Mark `function` as inlined by machine code.

    A call would cost more than its work, because it counts the references of all arrays.
    """
    INLINED.append(function)
    return function


def inlined_by_type(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """Make `function` a family of inlined functions, chosen by the type of the first argument.

    Members join with :func:`member_of`; other types use `function` itself. Machine code chooses when it is
    compiled.
    """
    members: dict[type, Callable[..., Any]] = {}

    def dispatch(first: Any, *rest: Any) -> Any:
        return members.get(type(first), function)(first, *rest)

    dispatch.__name__, dispatch.__qualname__ = function.__name__, function.__qualname__
    dispatch.__doc__, dispatch.__module__ = function.__doc__, function.__module__
    dispatch.__dict__["members"] = members
    FAMILIES.append(Family(dispatch, members, function))
    return cast("Callable[Parameters, Result]", dispatch)


def has_member(dispatch: Callable[..., Any], first_type: type) -> bool:
    """Return True if `first_type` has its own member in the family."""
    return first_type in dispatch.__dict__["members"]


def member_of(
    dispatch: Callable[..., Any], first_type: type
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Add the decorated function to the family, for `first_type`."""
    # Numba compares NamedTuples by type name and fields. Without unique names, two algorithms with a
    # Memory(q, visits) would share code
    first_type.__name__ = f"{first_type.__module__}.{first_type.__qualname__}"

    def join(function: Callable[..., Any]) -> Callable[..., Any]:
        dispatch.__dict__["members"][first_type] = function
        return function

    return join
