"""How numba keeps machine code in the cache, and reads it from there."""

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
    """The cache has no such machine code, and it is not to be compiled here."""


class Saves:
    """What became of the machine code that this process compiled."""

    kept = 0
    """How many functions, each for some types of arguments, are in the cache."""
    failed = False
    """Whether the cache did not take some."""


SAVES: Final = Saves()


class _Thread(threading.local):
    """What one thread is about."""

    only_loads = False


_THREAD: Final = _Thread()


@contextmanager
def only_loading() -> Iterator[None]:
    """Let this thread raise NotCachedError in place of compiling anything that is cached."""
    _THREAD.only_loads = True
    try:
        yield
    finally:
        _THREAD.only_loads = False


class _Shared(_CacheLocator):  # type: ignore[misc]
    """Where the machine code of the program's own functions is, which does not depend on where it stands.

    Numba has a file's path, and a hash over it, for what here the name of the folder says.
    """

    def __init__(self, function: Callable[..., Any], file: str) -> None:
        self._py_file = file  # numba's warnings tell it
        self._module, self._line = function.__module__, function.__code__.co_firstlineno

    def get_cache_path(self) -> str:
        return str(FOLDER / self._module)

    def get_source_stamp(self) -> str:
        return FOLDER.name

    def get_disambiguator(self) -> str:
        return str(self._line)

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> _Shared | None:
        # What is no file was not looked into for the folder's name
        ours = function.__module__.startswith(f"{NAME}.") and Path(file).exists()
        return cls(function, file) if ours else None


class _FinishedFolder(UserProvidedCacheLocator):  # type: ignore[misc]
    """Where compiled code is read, and whether it could be written is not tried."""

    def ensure_cache_path(self) -> None:
        return


class _Implementation(CompileResultCacheImpl):  # type: ignore[misc]
    _locator_classes: ClassVar = [_Shared, *CompileResultCacheImpl._locator_classes]


class _FinishedImplementation(CompileResultCacheImpl):  # type: ignore[misc]
    _locator_classes: ClassVar = [_Shared, _FinishedFolder]


class _ForgivingCache(FunctionCache):  # type: ignore[misc]
    """A cache on disk that rebuilds what it cannot read and does without where it cannot write."""

    _impl_class = _Implementation

    def load_overload(self, sig: Any, target_context: Any) -> CompileResult | None:
        try:
            found = super().load_overload(sig, target_context)
        except Exception:  # a damaged file raises whatever its bytes happen to spell
            with suppress(OSError):
                self.flush()  # so that the next save starts a new index
            found = None
        return _for_types(sig, found)

    def save_overload(self, sig: Any, data: CompileResult) -> None:
        try:
            with _saving_alone(), closed_to_others():
                super().save_overload(sig, data)
            SAVES.kept += 1
        except Exception:  # unreadable index, full disk, folder gone: the code in memory is all we need
            SAVES.failed = True


class _FinishedCache(FunctionCache):  # type: ignore[misc]
    """A cache on disk that is only read; what is not in it is compiled, and forgotten at the end."""

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
    """Return what was ``found`` if it is for the types of ``sig``; raise NotCachedError where it must be.

    Two programs that save at the same moment may give the same number to code for different types.
    """
    if found is not None and tuple(found.signature.args) == tuple(normalize_signature(sig)[0]):
        return found
    if _THREAD.only_loads:
        raise NotCachedError
    return None


@contextmanager
def _saving_alone() -> Iterator[None]:
    """Wait until no other process saves: the index of a function would lose what one of two adds at once.

    A process that was stopped while it saves is not waited for, and neither is any where there are no locks.
    """
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
    """Return the cache of the machine code of ``function``, where code is ``CACHED`` at all."""
    with closed_to_others():
        return (_FinishedCache if READ_ONLY else _ForgivingCache)(function)
