"""How far from 1 a sum of probabilities may be."""

from __future__ import annotations

from typing import Final

PROBABILITY_TOLERANCE: Final = 1e-9
