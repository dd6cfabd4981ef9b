"""Callbacks that run once a foreign module has been imported."""

from __future__ import annotations

import sys

# importing typing takes longer than this whole module
TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from importlib.machinery import ModuleSpec
    from types import ModuleType
    from typing import Any

    OnImport = Callable[[ModuleType], object]


def after_import(name: str, do: OnImport) -> None:
    """Call `do` with the module `name`, now if it is imported, and after each import."""
    module = sys.modules.get(name)
    if module is None:
        sys.meta_path.insert(0, _AfterImport(name, do))
    else:
        do(module)


class _AfterImport:
    """A finder that wraps the loader of one module."""

    def __init__(self, name: str, do: OnImport) -> None:
        self._name = name
        self._do = do

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the spec of this module only."""
        if fullname != self._name:
            return None
        behind = sys.meta_path[sys.meta_path.index(self) + 1 :]
        found = (each.find_spec(fullname, path, target) for each in behind)
        spec = next((each for each in found if each is not None), None)
        if spec is not None and hasattr(spec.loader, "exec_module"):
            spec.loader = _Loader(spec.loader, self._do)  # type: ignore[assignment]
        return spec


class _Loader:
    """Call `do` after loading, then restore the original loader."""

    def __init__(self, loader: Any, do: OnImport) -> None:
        self._loader = loader
        self._do = do

    def __getattr__(self, name: str) -> Any:
        return getattr(self._loader, name)

    def exec_module(self, module: ModuleType) -> None:
        """Load `module`, then call the callback."""
        assert module.__spec__ is not None
        module.__spec__.loader = module.__loader__ = self._loader
        self._loader.exec_module(module)
        self._do(module)
