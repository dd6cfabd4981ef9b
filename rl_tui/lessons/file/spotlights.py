"""What a page may put a spotlight on."""

from __future__ import annotations

from typing import Final

SPOTLIGHTS: Final = (
    "world",
    "table",
    "curve",
    "timeline",
    "budget",
    "controls",
    "last_step",
    "microscope",
    "many_seeds",
    "discount",
    "policies",
    "program",
    "findings",
    "output",
)
"""The ids of the panels; a test holds them to the catalogue of panels."""
