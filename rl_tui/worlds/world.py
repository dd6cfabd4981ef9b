"""A world as a run holds it: its table, its drawing and its budget."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rl_tui.worlds.drawing import Drawing

if TYPE_CHECKING:
    from rl_tui.worlds.mdp import TabularMDP


@dataclass(frozen=True, slots=True, eq=False)
class World:
    """What one seed made of a scenario.

    ``budget`` is the number of episodes after which a run on screen ends (the pulls of a bandit), None for no
    end.
    """

    mdp: TabularMDP
    drawing: Drawing
    budget: int | None = None
