"""The versions on which the bits of a run depend, and how those of a worker differ from the ones here."""

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
"""What has to be of one version everywhere: its name for the installer, and for people. SciPy solves the
exact figures."""
NO_VERSION: Final = ""


def versions_here() -> dict[str, str]:
    """Return the version of each package of ``PACKAGES`` in this process, and of Python without its patch."""
    return {PYTHON: minor(platform.python_version()), **{name: _version(name) for name in PACKAGES}}


def minor(python: str) -> str:
    """Return ``3.11`` of ``3.11.7``: patches of Python change no bits."""
    return ".".join(python.split(".")[:2])


def difference(theirs: Mapping[str, str], ours: Mapping[str, str]) -> str:
    """Return in words where ``theirs`` is not as ``ours``, empty where nothing is."""
    return ", ".join(
        f"has {_said(name, theirs.get(name, NO_VERSION))} where {wanted} is wanted"
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
