"""Where the shipped scenarios are. Nothing is read for it, and little imported."""

from __future__ import annotations

from pathlib import Path
from typing import Final

SUFFIX: Final = ".toml"
_PACKAGE: Final = Path(__file__).parents[2]


def shipped_folder() -> Path:
    """Return the folder of the shipped scenarios: inside the installed package, or beside it in a clone."""
    inside = _PACKAGE / "scenarios"
    return inside if inside.is_dir() else _PACKAGE.parent / "scenarios"
