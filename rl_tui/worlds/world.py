"""A world as used by a run: states, actions, drawing and budget."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, NamedTuple

from rl_tui.worlds.drawing import Drawing

if TYPE_CHECKING:
    from rl_tui.worlds.environment import Environment
    from rl_tui.worlds.mdp.space import FiniteSpace
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


class Prospect(NamedTuple):
    """An observation that may follow a pair.

    `probability` is None if it depends on the past. `rewards` are the possible mean rewards, rising; several
    if they depend on the past too.
    """

    next_state: int
    probability: float | None
    rewards: tuple[float, ...]


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class World:
    """A world made from a scenario and a seed.

    Args:
        space: States and actions. It is a TabularMDP if there is a transition table.
        drawing: How the world is drawn.
        budget: Episodes after which a run on screen ends (pulls of a bandit), or None.
        new_environment: Makes a copy of the environment to simulate, without a transition table.
        prospects: Possible observations after each pair, [P], if several states look the same; otherwise
            empty.
    """

    space: FiniteSpace
    drawing: Drawing
    budget: int | None = None
    new_environment: Callable[[], Environment] | None = None
    prospects: tuple[tuple[Prospect, ...], ...] = ()
    mdp: TabularMDP | None = field(init=False, repr=False)
    """The transition table, which is `space` itself, or None."""

    def __post_init__(self) -> None:
        from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

        object.__setattr__(self, "mdp", self.space if isinstance(self.space, TabularMDP) else None)

    @property
    def nbytes(self) -> int:
        """Memory of the arrays in its space, in bytes."""
        values = (getattr(self.space, each.name) for each in fields(self.space))
        return sum(getattr(value, "nbytes", 0) for value in values)
