"""Rows and columns of the drawings of Gymnasium's own environments, known before Gymnasium is imported."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.limits import MOST_STATES
from rl_tui.worlds.gym.stepped.layout import product_shape

if TYPE_CHECKING:
    from rl_tui.worlds.gym.section import GymnasiumSection

_BY_TABLE: Final[Mapping[str, tuple[int, int]]] = {
    "FrozenLake": (4, 4),
    "FrozenLake8x8": (8, 8),
    "CliffWalking": (4, 12),
    "Taxi": (29, 23),
}
"""By id, without its version."""
_BLACKJACK: Final = "Blackjack"
_BLACKJACK_TABLE: Final = (19, 21)
_BLACKJACK_PARTS: Final = (32, 11, 2)  # sums, cards of the dealer, usable ace or not


def known_shape(section: GymnasiumSection) -> tuple[int, int] | None:
    """Return rows and columns of the drawing of ``section``, None if they are not known."""
    if section.bins is not None:
        sizes = section.bins.sizes
        return product_shape(sizes) if math.prod(sizes) <= MOST_STATES else None  # the world will be refused
    name = re.sub(r"-v\d+$", "", section.id)
    if name == _BLACKJACK:
        return _BLACKJACK_TABLE if section.table else product_shape(_BLACKJACK_PARTS)
    if section.table is False or name not in _BY_TABLE:
        return None
    return _map_shape(section.kwargs) or _BY_TABLE[name]


def _map_shape(kwargs: Mapping[str, Any]) -> tuple[int, int] | None:
    """Return the shape of the lake that ``kwargs`` ask for; None if they ask for none."""
    lines, name = kwargs.get("desc"), kwargs.get("map_name")
    if isinstance(lines, list) and lines and isinstance(lines[0], str):
        return len(lines), len(lines[0])
    found = re.fullmatch(r"(\d{1,2})x(\d{1,2})", name) if isinstance(name, str) else None
    return None if found is None else (int(found[1]), int(found[2]))
