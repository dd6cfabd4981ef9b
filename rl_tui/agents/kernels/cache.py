"""The cache of machine code on disk, which clones of the program and its images can share."""

from __future__ import annotations

import os
import re
import shutil
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, ClassVar, Final

import numba
import platformdirs
from numba.core.caching import (
    CompileResultCacheImpl,
    FunctionCache,
    UserProvidedCacheLocator,
    _CacheLocator,
)
from numba.core.compiler import CompileResult
from numba.core.sigutils import normalize_signature

from rl_tui.agents.kernels.cache_key import NAME, cache_key
from rl_tui.common.kiosk import in_kiosk

LONGEST_UNUSED: Final = 30 * 24 * 3600.0
_OURS: Final = re.compile(r"\d[\w.+]*-[0-9a-f]{16}")


def cache_folder() -> Path:
    """Return the folder of compiled code, one for each state of what the code comes from, numba and NumPy.

    Numba itself only watches the file of the function it compiles, so that an edited helper in another file
    would leave stale code behind. Within the folder it keeps machine code for other processors and other
    versions of Python apart.
    """
    return _base() / "kernels" / cache_key()


def _base() -> Path:
    chosen = os.environ.get("RL_TUI_CACHE_DIR")
    if chosen:
        return Path(chosen)
    try:
        return platformdirs.user_cache_path("rl-tui", appauthor=False)
    except RuntimeError:  # there is no home
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
            return _for_types(sig, super().load_overload(sig, target_context))
        except Exception:  # a damaged file raises whatever its bytes happen to spell
            with suppress(OSError):
                self.flush()  # so that the next save starts a new index
            return None

    def save_overload(self, sig: Any, data: CompileResult) -> None:
        try:
            super().save_overload(sig, data)
        except Exception:  # unreadable index, full disk, folder gone: the code in memory is all we need
            return


class _FinishedCache(FunctionCache):  # type: ignore[misc]
    """A cache on disk that is only read; what is not in it is compiled, and forgotten at the end."""

    _impl_class = _FinishedImplementation

    def load_overload(self, sig: Any, target_context: Any) -> CompileResult | None:
        try:
            return _for_types(sig, super().load_overload(sig, target_context))
        except Exception:  # damaged, as above
            return None

    def save_overload(self, sig: Any, data: CompileResult) -> None:
        return


def _for_types(sig: Any, found: CompileResult | None) -> CompileResult | None:
    """Return what was ``found`` if it is for the types of ``sig``.

    Two programs that save at the same moment may give the same number to code for different types.
    """
    if found is None or tuple(found.signature.args) != tuple(normalize_signature(sig)[0]):
        return None
    return found


def cache_of(function: Callable[..., Any]) -> FunctionCache:
    """Return the cache of the machine code of ``function``, where code is ``CACHED`` at all."""
    return (_FinishedCache if READ_ONLY else _ForgivingCache)(function)
