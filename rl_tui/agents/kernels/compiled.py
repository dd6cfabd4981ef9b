"""The decorators of what is compiled; with ``cache.py`` and ``cache_key.py`` all that knows numba."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any, ParamSpec, Protocol, TypeVar, cast

import numba
from numba import types
from numba.core import ir
from numba.core.dispatcher import Dispatcher
from numba.core.errors import NumbaIRAssumptionWarning
from numba.core.ir_utils import alias_analysis_extensions
from numba.core.typing.templates import infer, infer_global, make_overload_template

from rl_tui.agents.kernels.cache import CACHED, cache_of

Parameters = ParamSpec("Parameters")
Result = TypeVar("Result")
Result_co = TypeVar("Result_co", covariant=True)


class Compiled(Protocol[Parameters, Result_co]):
    """A compiled function. ``py_func`` is the same function, interpreted: bit for bit the same results."""

    py_func: Callable[..., Any]

    def __call__(self, *args: Parameters.args, **kwargs: Parameters.kwargs) -> Result_co:
        """Run the machine code, compiling or reading it from the cache at the first call."""


# Numba wonders about variables that one branch of an inlined function sets and no other reads. Whether the
# code is right, the comparison with its interpreted form tells.
warnings.simplefilter("ignore", NumbaIRAssumptionWarning)


def _keep_written(
    write: Any, args: Any, typemap: Any, func_ir: Any, alias_map: Any, arg_aliases: set[str]
) -> None:
    """Tell numba's elimination of dead code that the array of ``write`` is an argument's.

    It follows what an inlined function is given, but not always what it returns: what is written to an array
    of a NamedTuple that came back from one would silently be left out.
    """
    arg_aliases.add(write.target.name)


alias_analysis_extensions[ir.SetItem] = _keep_written


def compiled(function: Callable[Parameters, Result]) -> Compiled[Parameters, Result]:
    """Compile ``function`` at its first call: without the GIL, strict IEEE arithmetic, cached on disk."""
    dispatcher = numba.njit(nogil=True, fastmath=False, error_model="numpy", _nrt=False)(function)
    if CACHED and not numba.config.DISABLE_JIT:
        dispatcher._cache = cache_of(dispatcher.py_func)
    return cast("Compiled[Parameters, Result]", dispatcher)


def entry(function: Compiled[Parameters, Result], *example: Any) -> Callable[..., Result]:
    """Return ``function`` for arguments of just these types, by position; compiles it if need be.

    A call then does not ask for their types, which for a dozen arrays takes longer than looking into them:
    measured, 8 µs in place of 31. Other types give nonsense.
    """
    if not isinstance(function, Dispatcher):  # interpreted
        return function
    machine_code: Callable[..., Result] = function.compile(tuple(numba.typeof(each) for each in example))
    return machine_code


def _inline(function: Callable[..., Any], implementation: Callable[..., Any]) -> None:
    """Let compiled code inline what ``implementation``, given types of arguments, returns for ``function``.

    It is numba's ``overload(function, inline="always")``, but for the time it takes. That types what is
    inlined anew whenever a call of it is looked at, which happens several times at every level of inlining;
    here it is typed once for each types of arguments. And that compiles it on its own, only to see whether it
    can be, which takes longer than all the rest; here whatever it is inlined into will tell.
    """
    template = make_overload_template(function, implementation, {}, strict=False, inline="always")
    type_anew, known = template.generic, dict[Any, Any]()

    def type_once(self: Any, args: Any, kws: Any) -> Any:
        key = self.context, tuple(args), tuple(kws.items())
        if key not in known:
            known[key] = type_anew(self, args, kws)
        return known[key]

    template.generic = type_once
    template._get_jit_decorator = lambda _: _only_typed
    infer(template)
    infer_global(function, types.Function(template))


def _only_typed(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Do as ``numba.njit``, for a function that is to be typed but not compiled on its own.

    A numba that looks elsewhere for whether it may compile just does compile it.
    """

    def decorate(function: Callable[..., Any]) -> Any:
        dispatcher = numba.njit(**options)(function)
        # Its own disable_compile wants something compiled first
        dispatcher._can_compile = False
        return dispatcher

    return decorate


def inlined(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """Let compiled code call ``function`` by inlining it; Python calls it as it is.

    A call costs two to four times the work it does, since every array's reference is counted at every call.
    """

    def implementation(*_: object) -> Callable[Parameters, Result]:
        return function

    _inline(function, implementation)
    return function


def inlined_by_type(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """Make ``function`` a family of inlined functions, one for each NamedTuple type of its first argument.

    Members join with :func:`member_of`; types without a member get ``function`` itself. The choice is made
    while compiling and costs nothing when running.
    """
    family: dict[type, Callable[..., Any]] = {}

    def dispatch(first: Any, *rest: Any) -> Any:
        return family.get(type(first), function)(first, *rest)

    def implementation(first: Any, *_: object) -> Callable[..., Any] | None:
        return family.get(first.instance_class, function) if isinstance(first, types.BaseNamedTuple) else None

    dispatch.__name__, dispatch.__qualname__ = function.__name__, function.__qualname__
    dispatch.__doc__, dispatch.__module__ = function.__doc__, function.__module__
    dispatch.__dict__["family"] = family
    _inline(dispatch, implementation)
    return cast("Callable[Parameters, Result]", dispatch)


def has_member(dispatch: Callable[..., Any], first_type: type) -> bool:
    """Return whether a ``first_type`` has a member of its own in the family ``dispatch``."""
    return first_type in dispatch.__dict__["family"]


def member_of(
    dispatch: Callable[..., Any], first_type: type
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Let ``dispatch`` choose the decorated function where its first argument is a ``first_type``."""
    # Before it looks closer, Numba tells NamedTuples apart by the names of type and fields: of two algorithms
    # that both remember a Memory(q, visits), one would run the other's code
    first_type.__name__ = f"{first_type.__module__}.{first_type.__qualname__}"

    def join(function: Callable[..., Any]) -> Callable[..., Any]:
        dispatch.__dict__["family"][first_type] = function
        return function

    return join
