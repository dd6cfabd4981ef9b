"""The machine and versions with which rows were made."""

from __future__ import annotations

import json
import platform
import sys
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Final

_PACKAGES: Final = ("numpy", "numba", "scipy", "gymnasium")
PROCESSORS: Final = Path("/proc/cpuinfo")
"""Linux file that describes the processor."""
_MODELS: Final = ("model name", "CPU part", "cpu")  # keys of Intel, ARM and POWER


@cache
def this_machine() -> str:
    """Return the kind of machine and the versions as JSON: equal ones give equal bits.

    Logarithms and powers depend on the C library, the exact solver on the processor.
    """
    from rl_tui import __version__

    said = {
        "system": platform.system(),
        "machine": platform.machine(),
        "processor": _processor(),
        "libc": " ".join(platform.libc_ver()).strip(),
        "python": ".".join(map(str, sys.version_info[:3])),
        "rl_tui": __version__,
        **{package: _version(package) for package in _PACKAGES},
    }
    return json.dumps(said, sort_keys=True)


def _processor() -> str:
    try:
        lines = PROCESSORS.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return platform.processor()
    said = dict(reversed([[part.strip() for part in line.split(":", 1)] for line in lines if ":" in line]))
    return next((said[name] for name in _MODELS if said.get(name)), "")


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""
