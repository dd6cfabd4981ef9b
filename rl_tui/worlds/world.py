"""A world as a run holds it: its states and actions, its drawing and its budget."""

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
    """A state that may be seen after a pair.

    ``probability`` is None where it depends on how one came there; ``rewards`` are the mean rewards that may
    come with it, ascending: more than one where they depend on that, too.
    """

    next_state: int
    probability: float | None
    rewards: tuple[float, ...]


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class World:
    """What one seed made of a scenario.

    ``space`` is a TabularMDP wherever what actions lead to is known; else ``new_environment`` makes a copy of
    the environment that has to be stepped to find out. ``budget`` is the number of episodes after which a run
    on screen ends (the pulls of a bandit), None for no end. ``prospects``, [P], say what may be seen after
    each pair where several states look alike to the agent, so that it depends on how one came there; empty
    where none do.
    """

    space: FiniteSpace
    drawing: Drawing
    budget: int | None = None
    new_environment: Callable[[], Environment] | None = None
    prospects: tuple[tuple[Prospect, ...], ...] = ()
    mdp: TabularMDP | None = field(init=False, repr=False)
    """The transition table, which then is ``space`` itself; None where there is none."""

    def __post_init__(self) -> None:
        from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

        object.__setattr__(self, "mdp", self.space if isinstance(self.space, TabularMDP) else None)

    @property
    def nbytes(self) -> int:
        """How much memory the arrays of its space take."""
        values = (getattr(self.space, each.name) for each in fields(self.space))
        return sum(getattr(value, "nbytes", 0) for value in values)
