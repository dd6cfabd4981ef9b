"""The machine code of the kernels; with ``machine_cache.py`` all that knows numba.

It takes half a second to import and makes nothing by itself: a process that has no use for machine code never
imports it.
"""

from __future__ import annotations

import threading
import warnings
from collections.abc import Callable
from typing import Any, Final

import numba
from numba import types
from numba.core import boxing, cgutils, ir
from numba.core.dispatcher import Dispatcher
from numba.core.errors import NumbaIRAssumptionWarning
from numba.core.ir_utils import alias_analysis_extensions
from numba.core.pythonapi import _unboxers
from numba.core.typing.templates import infer, infer_global, make_overload_template

from rl_tui.agents.compiling.machine_cache import CACHED, cache_of
from rl_tui.agents.compiling.native import NATIVE, always
from rl_tui.agents.kernels.compiled import CALLED_BY_KERNELS, COMPILED, FAMILIES, INLINED, Family

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


def _borrow_generator(kind: Any, generator: Any, context: Any) -> Any:
    """Take ``generator`` into a kernel without a note that it is held, where nothing would take that back.

    Numba makes one at every call, of 64 bytes, and drops it only in code that counts references, which the
    kernels do without. Their caller holds the generator all the while.
    """
    if context.context.enable_nrt:
        return boxing.unbox_numpy_random_generator(kind, generator, context)
    context.pyapi.nrt_meminfo_new_from_pyobject = lambda *_: cgutils.voidptr_t(None)
    try:
        return boxing.unbox_numpy_random_generator(kind, generator, context)
    finally:
        del context.pyapi.nrt_meminfo_new_from_pyobject


_unboxers.functions[types.NumPyRandomGeneratorType] = _borrow_generator


_DISPATCHERS: Final[dict[Callable[..., Any], Dispatcher]] = {}
_LOCK: Final = threading.Lock()
_KNOWN: Final = set[Callable[..., Any]]()


def dispatcher_of(function: Callable[..., Any]) -> Dispatcher:
    """Return the compiled form of ``function``: without the GIL, strict IEEE arithmetic, cached on disk.

    Machine code is compiled, or read from the cache, when it is first called with arguments of some types, or
    by ``compile``. Raises KeyError for a function that is not marked as compiled.
    """
    with _LOCK:
        _take_in_marks()
    return _DISPATCHERS[function]


def entry(function: Callable[..., Any], *example: Any) -> Callable[..., Any]:
    """Return the machine code of ``function`` for arguments of just these types, by position.

    It is compiled or read from the cache if need be. A call then does not ask for their types, which for a
    dozen arrays takes longer than looking into them: measured, 8 µs in place of 31. Other types
    give nonsense.
    """
    machine_code: Callable[..., Any] = dispatcher_of(function).compile(
        tuple(numba.typeof(each) for each in example)
    )
    return machine_code


def _take_in_marks() -> None:
    """Tell numba's typing of all that was marked since the last time; for one thread at a time."""
    for function in INLINED:
        if function not in _KNOWN:
            _inline(function, NATIVE.get(function) or always(function))
            _KNOWN.add(function)
    for family in FAMILIES:
        if family.dispatch not in _KNOWN:
            _inline(family.dispatch, _choice(family))
            _KNOWN.add(family.dispatch)
    for function in COMPILED:
        if function not in _DISPATCHERS:
            dispatcher = numba.njit(
                nogil=True,
                fastmath=False,
                error_model="numpy",
                _nrt=False,
                no_cfunc_wrapper=True,  # for C, which calls none
                no_cpython_wrapper=function in CALLED_BY_KERNELS,
            )(function)
            if CACHED:
                dispatcher._cache = cache_of(function)
            _DISPATCHERS[function] = dispatcher
            infer_global(function, types.Dispatcher(dispatcher))


def _choice(family: Family) -> Callable[..., Callable[..., Any] | None]:
    """Return what chooses from ``family`` by the type of the first argument."""

    def chosen(first: Any, *_: object) -> Callable[..., Any] | None:
        is_known = isinstance(first, types.BaseNamedTuple)
        return family.members.get(first.instance_class, family.otherwise) if is_known else None

    return chosen


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
