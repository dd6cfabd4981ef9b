"""Storing numba's machine code in the cache, and reading it."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, ClassVar, Final

import numba
from numba.core.caching import (
    CompileResultCacheImpl,
    FunctionCache,
    UserProvidedCacheLocator,
    _CacheLocator,
)
from numba.core.compiler import CompileResult
from numba.core.sigutils import normalize_signature

from rl_tui.agents.compiling.base_folder import closed_to_others
from rl_tui.agents.compiling.cache_folder import cache_folder, prune, takes_code
from rl_tui.agents.compiling.cache_key import NAME
from rl_tui.common.files import FileLock

_LONGEST_SAVE: Final = 5.0  # seconds
FOLDER: Final = cache_folder()
READ_ONLY: Final = not takes_code()
CACHED: Final = FOLDER.is_dir()
if CACHED:
    numba.config.CACHE_DIR = str(FOLDER)
    prune(FOLDER.parent, FOLDER, time.time())


class NotCachedError(Exception):
    """Missing machine code that must not be compiled here."""


class Saves:
    """Counts of machine code compiled and stored by this process."""

    kept = 0
    """Number of functions, each for some types, that were stored."""
    failed = False
    """True if the cache could not store some of them."""


SAVES: Final = Saves()


class _Thread(threading.local):
    only_loads = False


_THREAD: Final = _Thread()


@contextmanager
def only_loading() -> Iterator[None]:
    """Raise NotCachedError in this thread instead of compiling."""
    _THREAD.only_loads = True
    try:
        yield
    finally:
        _THREAD.only_loads = False


class _Shared(_CacheLocator):  # type: ignore[misc]
    """The cache location of our own functions, independent of the installation path."""

    def __init__(self, function: Callable[..., Any], file: str) -> None:
        self._py_file = file  # numba's warnings print it
        self._module, self._line = function.__module__, function.__code__.co_firstlineno

    def get_cache_path(self) -> str:
        return str(FOLDER / self._module)

    def get_source_stamp(self) -> str:
        return FOLDER.name

    def get_disambiguator(self) -> str:
        return str(self._line)

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> _Shared | None:
        # a module without a file is not part of the cache key
        ours = function.__module__.startswith(f"{NAME}.") and Path(file).exists()
        return cls(function, file) if ours else None


class _FinishedFolder(UserProvidedCacheLocator):  # type: ignore[misc]
    """A read-only cache location that is not tested for writing."""

    def ensure_cache_path(self) -> None:
        return


class _Implementation(CompileResultCacheImpl):  # type: ignore[misc]
    _locator_classes: ClassVar = [_Shared, *CompileResultCacheImpl._locator_classes]


class _FinishedImplementation(CompileResultCacheImpl):  # type: ignore[misc]
    _locator_classes: ClassVar = [_Shared, _FinishedFolder]


class _ForgivingCache(FunctionCache):  # type: ignore[misc]
    """A cache that rebuilds unreadable files and tolerates write errors."""

    _impl_class = _Implementation

    def load_overload(self, sig: Any, target_context: Any) -> CompileResult | None:
        try:
            found = super().load_overload(sig, target_context)
        except Exception:  # a damaged file may raise anything
            with suppress(OSError):
                self.flush()  # the next save then starts a new index
            found = None
        return _for_types(sig, found)

    def save_overload(self, sig: Any, data: CompileResult) -> None:
        try:
            with _saving_alone(), closed_to_others():
                super().save_overload(sig, data)
            SAVES.kept += 1
        except Exception:  # unreadable index, full disk or missing folder: the code in memory is enough
            SAVES.failed = True


class _FinishedCache(FunctionCache):  # type: ignore[misc]
    """A cache that is only read. Missing code is compiled and not stored."""

    _impl_class = _FinishedImplementation

    def load_overload(self, sig: Any, target_context: Any) -> CompileResult | None:
        try:
            found = super().load_overload(sig, target_context)
        except Exception:  # damaged, as above
            found = None
        return _for_types(sig, found)

    def save_overload(self, sig: Any, data: CompileResult) -> None:
        return


def _for_types(sig: Any, found: CompileResult | None) -> CompileResult | None:
    # Raises NotCachedError if required
    if found is not None and tuple(found.signature.args) == tuple(normalize_signature(sig)[0]):
        return found
    if _THREAD.only_loads:
        raise NotCachedError
    return None


@contextmanager
def _saving_alone() -> Iterator[None]:
    # Parallel saves would lose index entries, so wait a few seconds at most
    lock = FileLock(FOLDER / "saving")
    try:
        with suppress(OSError):
            longest = time.monotonic() + _LONGEST_SAVE
            while not lock.acquire() and time.monotonic() < longest:
                time.sleep(_LONGEST_SAVE / 1000)
        yield
    finally:
        lock.release()


def cache_of(function: Callable[..., Any]) -> FunctionCache:
    """Return the existing cache for the machine code of `function`."""
    with closed_to_others():
        return (_FinishedCache if READ_ONLY else _ForgivingCache)(function)
