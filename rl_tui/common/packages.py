"""Required packages, and advice if one is missing."""

from __future__ import annotations

from typing import Final

NEEDED: Final = frozenset(
    (
        *("click", "gymnasium", "numba", "numpy", "platformdirs"),
        *("pydantic", "rich", "scipy", "textual", "tomlkit"),
    )
)
"""The dependencies in pyproject.toml. Import name and pip name are equal."""


def missing_package(error: BaseException) -> str:
    """Return which required package `error` lacks, and how to install it. Empty for other errors."""
    if not isinstance(error, ModuleNotFoundError) or not error.name:
        return ""
    package = error.name.partition(".")[0]
    if package not in NEEDED:
        return ""
    return f"the package {package} is missing; install it: pip install {package}"
