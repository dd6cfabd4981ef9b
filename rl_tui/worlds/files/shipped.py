"""The folder of shipped scenarios, found with few imports."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from pathlib import Path

SUFFIX: Final = ".toml"
_PACKAGE: Final = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def shipped_folder() -> Path:
    """Return the folder, inside the package or next to it in a clone."""
    from pathlib import Path  # slow to import, compared with this module

    return Path(_folder())


def shipped_names() -> list[str]:
    """Return the sorted ids of the shipped scenarios. Empty if unreadable."""
    try:
        files = os.listdir(_folder())
    except OSError:
        return []
    return sorted(file.removesuffix(SUFFIX) for file in files if file.endswith(SUFFIX))


def _folder() -> str:
    inside = os.path.join(_PACKAGE, "scenarios")
    return inside if os.path.isdir(inside) else os.path.join(os.path.dirname(_PACKAGE), "scenarios")
