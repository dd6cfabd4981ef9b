"""Modules without a file, for imports of what is not installed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any


class MadeModules(MetaPathFinder, Loader):
    """A finder of the modules that `is_made` names, filled with `content`. Each counts as a package."""

    def __init__(self, is_made: Callable[[str], bool], content: Callable[[str], Mapping[str, Any]]) -> None:
        self._is_made, self._content = is_made, content

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the spec of a made module."""
        return ModuleSpec(fullname, self, is_package=True) if self._is_made(fullname) else None

    def exec_module(self, module: ModuleType) -> None:
        """Fill `module`."""
        module.__dict__.update(self._content(module.__name__))
