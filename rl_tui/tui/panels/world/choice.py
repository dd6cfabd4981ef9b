"""What a person chose to see in maps."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class MapChoice:
    """Kept while the program runs, for all worlds alike.

    ``shows_actions`` says that cells show Q of every action, where they have room, in place of V and arrows.
    """

    shows_actions: bool = False
