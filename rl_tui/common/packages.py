"""Packages that the program uses, and advice if one is missing."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Final

NEEDED: Final = frozenset(
    (
        *("click", "gymnasium", "numba", "numpy", "platformdirs"),
        *("pydantic", "rich", "scipy", "textual", "tomlkit"),
    )
)
"""The dependencies in pyproject.toml. Import name and pip name are equal."""
STAYS_INTERPRETED: Final = "Runs stay interpreted, far slower than machine code"


def missing_package(error: BaseException) -> str:
    """Return which required package is missing, and how to install it, or ""."""
    if not isinstance(error, ModuleNotFoundError) or not error.name:
        return ""
    package = error.name.partition(".")[0]
    if package not in NEEDED:
        return ""
    return f"the package {package} is missing; install it: pip install {package}"


def why_interpreted() -> str:
    """Return a sentence if Numba is missing, so that every run is interpreted."""
    if is_installed("numba"):
        return ""
    return f"{STAYS_INTERPRETED}: {missing_package(ModuleNotFoundError(name='numba'))}"


def is_installed(package: str) -> bool:
    """Return True if `package` can be imported, without importing it."""
    return find_spec(package) is not None
