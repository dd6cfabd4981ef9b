"""A world as used by a run: states, actions, drawing and budget."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, NamedTuple

from rl_tui.worlds.drawing import Arms, Drawing

if TYPE_CHECKING:
    from rl_tui.worlds.environment import Environment
    from rl_tui.worlds.mdp.space import FiniteSpace
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


class Prospect(NamedTuple):
    """An observation that may follow a pair.

    `probability` is None if it depends on the past. `rewards` are the possible mean rewards, rising.
    """

    next_state: int
    probability: float | None
    rewards: tuple[float, ...]


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class World:
    """A world made from a scenario and a seed.

    Args:
        space: A TabularMDP if there is a transition table.
        budget: Episodes after which a run on screen ends (pulls of a bandit), or None.
        new_environment: Makes a copy of the environment to simulate.
        prospects: Possible observations after each pair, [P], if several states look the same, or empty.
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
    def is_bandit(self) -> bool:
        """True if its actions are arms."""
        return isinstance(self.drawing, Arms)

    @property
    def is_remade(self) -> bool:
        """True if another run can learn in it."""
        return self.mdp is not None or self.new_environment is not None

    @property
    def nbytes(self) -> int:
        """Bytes of the arrays in its space."""
        values = (getattr(self.space, each.name) for each in fields(self.space))
        return sum(getattr(value, "nbytes", 0) for value in values)
