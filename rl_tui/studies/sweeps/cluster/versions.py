"""The versions on which the bits of a run depend."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from typing import Final

PYTHON: Final = "Python"
PACKAGES: Final[Mapping[str, str]] = {
    "rl-tui": "rl-tui",
    "numba": "Numba",
    "numpy": "NumPy",
    "scipy": "SciPy",
}
"""Packages that need equal versions everywhere: name for the installer, and for people. SciPy solves the
exact results.
"""
NO_VERSION: Final = ""


def versions_here() -> dict[str, str]:
    """Return the versions of `PACKAGES` and of Python, without its patch."""
    return {PYTHON: minor(platform.python_version()), **{name: _version(name) for name in PACKAGES}}


def minor(python: str) -> str:
    """Return `3.11` for `3.11.7`: patches of Python change no bits."""
    return ".".join(python.split(".")[:2])


def difference(theirs: Mapping[str, str], ours: Mapping[str, str]) -> str:
    """Describe the differences of `theirs` from `ours`, or return ""."""
    return ", ".join(
        f"has {_said(name, theirs.get(name, NO_VERSION))} instead of {wanted}"
        for name, wanted in ours.items()
        if theirs.get(name, NO_VERSION) != wanted
    )


def _said(name: str, found: str) -> str:
    said = PACKAGES.get(name, name)
    return f"{said} {found}" if found else f"no {said}"


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return NO_VERSION
