"""The marks of what is compiled; the functions themselves stay plain, and Python calls them as they are.

So every kernel has an interpreted form, bit for bit the same, which needs no compiler. It knows nothing of
numba: ``jit.py`` makes the machine code of what is marked here.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, NamedTuple, ParamSpec, TypeVar, cast

Parameters = ParamSpec("Parameters")
Result = TypeVar("Result")

COMPILED: Final[list[Callable[..., Any]]] = []
"""What machine code calls: compiled once for each types of arguments, and shared by all that call it."""

CALLED_FROM_PYTHON: Final[dict[Callable[..., Any], Callable[[], tuple[Any, ...]]]] = {}
"""Those of them that Python calls, and what gives an example of their arguments, whose types never differ."""

CALLED_BY_KERNELS: Final = set[Callable[..., Any]]()
"""Those of them that nothing but machine code calls."""

INLINED: Final[list[Callable[..., Any]]] = []
"""What machine code inlines."""

FAMILIES: Final[list[Family]] = []
"""What machine code inlines after a choice by the type of the first argument."""


class Family(NamedTuple):
    """What ``dispatch`` chooses from: ``members`` by the type of the first argument, else ``otherwise``."""

    dispatch: Callable[..., Any]
    members: dict[type, Callable[..., Any]]
    otherwise: Callable[..., Any]


def compiled(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """Mark ``function`` as one that machine code calls."""
    COMPILED.append(function)
    return function


def compiled_for(
    example: Callable[[], tuple[Any, ...]],
) -> Callable[[Callable[Parameters, Result]], Callable[Parameters, Result]]:
    """Mark a function as :func:`compiled`, and as one that Python calls with types that are always the same.

    They are those of the arguments that ``example`` returns, by position. Python calls it by
    :func:`rl_tui.agents.kernels.machine_code.fastest`.
    """

    def mark(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
        CALLED_FROM_PYTHON[function] = example
        return compiled(function)

    return mark


def for_kernels(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """Mark ``function`` as :func:`compiled`, and as one whose machine code nothing but kernels calls.

    It takes less time to compile, since Python's objects need not be taken apart.
    """
    CALLED_BY_KERNELS.add(function)
    return compiled(function)


def inlined(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """Mark ``function`` as one that machine code inlines.

    A call costs two to four times the work it does, since every array's reference is counted at every call.
    """
    INLINED.append(function)
    return function


def inlined_by_type(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """Make ``function`` a family of inlined functions, one for each NamedTuple type of its first argument.

    Members join with :func:`member_of`; types without a member get ``function`` itself. Machine code has the
    choice made while it is compiled, and pays nothing for it.
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
    """Return whether a ``first_type`` has a member of its own in the family ``dispatch``."""
    return first_type in dispatch.__dict__["members"]


def member_of(
    dispatch: Callable[..., Any], first_type: type
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Let ``dispatch`` choose the decorated function where its first argument is a ``first_type``."""
    # Before it looks closer, Numba tells NamedTuples apart by the names of type and fields: of two algorithms
    # that both remember a Memory(q, visits), one would run the other's code
    first_type.__name__ = f"{first_type.__module__}.{first_type.__qualname__}"

    def join(function: Callable[..., Any]) -> Callable[..., Any]:
        dispatch.__dict__["members"][first_type] = function
        return function

    return join
