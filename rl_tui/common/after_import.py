"""A module of ours that is to be imported as soon as another package is, but not before."""

from __future__ import annotations

import sys

# typing itself takes longer to import than all of this
TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from importlib.machinery import ModuleSpec
    from types import ModuleType


def import_after(package: str, module: str) -> None:
    """Import ``module`` once ``package`` has been imported: at once where it is there already.

    ``package`` itself is not imported for it.
    """
    if package in sys.modules:
        __import__(module)
    else:
        sys.meta_path.insert(0, _ImportAfter(package, module))


class _ImportAfter:
    """Finds the one package where the other finders do, and adds the module to what its import does."""

    def __init__(self, package: str, module: str) -> None:
        self._package = package
        self._module = module

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return where the package is, None for any other."""
        if fullname != self._package:
            return None
        others = (each for each in sys.meta_path if not isinstance(each, _ImportAfter))
        found = (each.find_spec(fullname, path, target) for each in others)
        spec = next((each for each in found if each is not None), None)
        if spec is None or spec.loader is None:
            return spec
        execute = spec.loader.exec_module

        def execute_and_import(module: ModuleType) -> None:
            execute(module)
            # where it is being imported itself, and asked for the package, it goes on after this
            __import__(self._module)

        # a loader is made for one spec: who only asks where the package is runs neither
        spec.loader.exec_module = execute_and_import  # type: ignore[method-assign]
        return spec
