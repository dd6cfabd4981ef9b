"""Where rows were made: the kind of machine, and the versions of what their bits depend on."""

from __future__ import annotations

import json
import platform
import sys
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Final

_PACKAGES: Final = ("numpy", "numba", "scipy", "gymnasium")


@cache
def this_machine() -> str:
    """Return, as JSON, the kind of machine and the versions here: where they are equal, bits are."""
    from rl_tui import __version__

    said = {
        "system": platform.system(),
        "machine": platform.machine(),
        "python": ".".join(map(str, sys.version_info[:3])),
        "rl_tui": __version__,
        **{package: _version(package) for package in _PACKAGES},
    }
    return json.dumps(said, sort_keys=True)


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""
