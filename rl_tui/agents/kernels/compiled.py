"""The only file that knows numba: its decorators and its cache on disk."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import time
import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, ClassVar, Final, ParamSpec, Protocol, TypeVar, cast

import numba
import platformdirs
from numba import types
from numba.core import ir
from numba.core.caching import CompileResultCacheImpl, FunctionCache, UserProvidedCacheLocator
from numba.core.compiler import CompileResult
from numba.core.dispatcher import Dispatcher
from numba.core.errors import NumbaIRAssumptionWarning
from numba.core.ir_utils import alias_analysis_extensions
from numba.core.typing.templates import infer, infer_global, make_overload_template

from rl_tui.common.kiosk import in_kiosk

LONGEST_UNUSED: Final = 30 * 24 * 3600.0
_OURS: Final = re.compile(r"\d[\w.+]*-[0-9a-f]{16}")

Parameters = ParamSpec("Parameters")
Result = TypeVar("Result")
Result_co = TypeVar("Result_co", covariant=True)


class Compiled(Protocol[Parameters, Result_co]):
    """A compiled function. ``py_func`` is the same function, interpreted: bit for bit the same results."""

    py_func: Callable[..., Any]

    def __call__(self, *args: Parameters.args, **kwargs: Parameters.kwargs) -> Result_co:
        """Run the machine code, compiling or reading it from the cache at the first call."""


def cache_folder() -> Path:
    """Return the folder of compiled code, one for each state of the agents' sources, numba and Python.

    Numba itself only watches the file of the function it compiles, so that an edited helper in another file
    would leave stale code behind; the hash over all sources makes that impossible.
    """
    digest = hashlib.sha256()
    package = Path(__file__).parents[2]
    for source in sorted([*package.glob("agents/**/*.py"), *package.glob("lab/**/*.py")]):
        digest.update(source.relative_to(package).as_posix().encode())
        digest.update(source.read_bytes())
    return _base() / "kernels" / f"{numba.__version__}-{digest.hexdigest()[:16]}"


def _base() -> Path:
    chosen = os.environ.get("RL_TUI_CACHE_DIR")
    if chosen:
        return Path(chosen)
    try:
        return platformdirs.user_cache_path("rl-tui", appauthor=False)
    except RuntimeError:  # nobody knows a home
        return Path(os.devnull)


def _writable(folder: Path) -> bool:
    """Tell whether ``folder``, made where it is missing, can be written; its time is then that of now."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / f"writable-{os.getpid()}"
        probe.touch()
        probe.unlink()
    except OSError:
        return False
    return True


# Numba wonders about variables that one branch of an inlined function sets and no other reads. Whether the
# code is right, the comparison with its interpreted form tells.
warnings.simplefilter("ignore", NumbaIRAssumptionWarning)


def prune(kernels: Path, current: Path, now: float) -> None:
    """Remove the folders in ``kernels`` that no program has started from for thirty days, but ``current``.

    ``now`` is in seconds, as file systems count. A program that runs on an old one for longer has its code in
    memory, and compiles what else it needs.
    """
    with suppress(OSError):
        for folder in kernels.iterdir():
            is_ours = _OURS.fullmatch(folder.name) and folder.is_dir() and not folder.is_symlink()
            if is_ours and folder != current and now - folder.stat().st_mtime > LONGEST_UNUSED:
                shutil.rmtree(folder, ignore_errors=True)


FOLDER: Final = cache_folder()
# What a kiosk reads, somebody else has compiled before
READ_ONLY: Final = in_kiosk() or not _writable(FOLDER)
CACHED: Final = FOLDER.is_dir()
if CACHED:
    numba.config.CACHE_DIR = str(FOLDER)
    prune(FOLDER.parent, FOLDER, time.time())


class _ForgivingCache(FunctionCache):  # type: ignore[misc]
    """A cache on disk that rebuilds what it cannot read and does without where it cannot write."""

    def load_overload(self, sig: Any, target_context: Any) -> CompileResult | None:
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # a damaged file raises whatever its bytes happen to spell
            with suppress(OSError):
                self.flush()  # so that the next save starts a new index
            return None

    def save_overload(self, sig: Any, data: CompileResult) -> None:
        try:
            super().save_overload(sig, data)
        except Exception:  # unreadable index, full disk, folder gone: the code in memory is all we need
            return


class _FinishedFolder(UserProvidedCacheLocator):  # type: ignore[misc]
    """Where compiled code is read, and nobody tries whether it could be written."""

    def ensure_cache_path(self) -> None:
        return


class _FinishedImplementation(CompileResultCacheImpl):  # type: ignore[misc]
    _locator_classes: ClassVar = [_FinishedFolder]


class _FinishedCache(FunctionCache):  # type: ignore[misc]
    """A cache on disk that is only read; what is not in it is compiled, and forgotten at the end."""

    _impl_class = _FinishedImplementation

    def load_overload(self, sig: Any, target_context: Any) -> CompileResult | None:
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # damaged, as above
            return None

    def save_overload(self, sig: Any, data: CompileResult) -> None:
        return


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
        kind = _FinishedCache if READ_ONLY else _ForgivingCache
        dispatcher._cache = kind(dispatcher.py_func)
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
