"""Compilation of kernels with numba, which takes half a second to import.

Only this module and ``machine_cache.py`` use its compiler. A process without machine code never imports it.
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

# Numba warns about variables that one branch of an inlined function sets and others do not read. Tests
# compare the code with its interpreted form
warnings.simplefilter("ignore", NumbaIRAssumptionWarning)


def _keep_written(
    write: Any, args: Any, typemap: Any, func_ir: Any, alias_map: Any, arg_aliases: set[str]
) -> None:
    # Numba's dead-code elimination would remove writes to an array of a returned NamedTuple
    arg_aliases.add(write.target.name)


alias_analysis_extensions[ir.SetItem] = _keep_written


def _borrow_generator(kind: Any, generator: Any, context: Any) -> Any:
    # Without the 64 bytes that Numba allocates per call and never frees. The caller holds the generator
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
    """Return the compiled form of `function`: no GIL, strict IEEE arithmetic, cached on disk.

    It is compiled or read from the cache on the first call with some types, or by ``compile``.

    Raises:
        KeyError: The function is not marked as compiled.
    """
    with _LOCK:
        _take_in_marks()
    return _DISPATCHERS[function]


def entry(function: Callable[..., Any], *example: Any) -> Callable[..., Any]:
    """Return the machine code of `function` for exactly the types of `example`, made now if needed.

    Calls skip the type check: 8 µs instead of 31 for a dozen arrays. Other types give undefined results.
    """
    machine_code: Callable[..., Any] = dispatcher_of(function).compile(
        tuple(numba.typeof(each) for each in example)
    )
    return machine_code


def _take_in_marks() -> None:
    # One thread at a time
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
                no_cfunc_wrapper=True,  # only C code would need it
                no_cpython_wrapper=function in CALLED_BY_KERNELS,
            )(function)
            if CACHED:
                dispatcher._cache = cache_of(function)
            _DISPATCHERS[function] = dispatcher
            infer_global(function, types.Dispatcher(dispatcher))


def _choice(family: Family) -> Callable[..., Callable[..., Any] | None]:
    def chosen(first: Any, *_: object) -> Callable[..., Any] | None:
        is_known = isinstance(first, types.BaseNamedTuple)
        return family.members.get(first.instance_class, family.otherwise) if is_known else None

    return chosen


def _inline(function: Callable[..., Any], implementation: Callable[..., Any]) -> None:
    # As numba's `overload(function, inline="always")`, but types the inlined code only once
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
    # As `numba.njit`, for a function that is typed but never compiled separately. If numba ignores this flag,
    # it is merely compiled as well
    def decorate(function: Callable[..., Any]) -> Any:
        dispatcher = numba.njit(**options)(function)
        # numba's disable_compile requires a compiled signature
        dispatcher._can_compile = False
        return dispatcher

    return decorate
