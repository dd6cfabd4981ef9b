"""The packages that rl-tui needs, and what to do where one of them is missing."""

from __future__ import annotations

from typing import Final

NEEDED: Final = frozenset(
    (
        *("click", "gymnasium", "numba", "numpy", "platformdirs"),
        *("pydantic", "rich", "scipy", "textual", "tomlkit"),
    )
)
"""Those of pyproject.toml: each is imported by the name by which pip knows it."""


def missing_package(error: BaseException) -> str:
    """Return which needed package ``error`` misses and how to install it; nothing for any other error."""
    if not isinstance(error, ModuleNotFoundError) or not error.name:
        return ""
    package = error.name.partition(".")[0]
    if package not in NEEDED:
        return ""
    return f"the package {package} is missing; install it: pip install {package}"
