"""Where rows were made: the kind of machine, and the versions of what their bits depend on."""

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
"""Where Linux says what it runs on."""
_MODELS: Final = ("model name", "CPU part", "cpu")  # of Intel's kind, ARM's, POWER's


@cache
def this_machine() -> str:
    """Return, as JSON, the kind of machine and the versions here: where they are equal, bits are.

    Logarithms and powers are the C library's, and the solver of exact figures takes what the processor has.
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
    """Return the model of the processor, as far as the system says."""
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
