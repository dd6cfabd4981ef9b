"""A policy that a person draws, action by action."""

from __future__ import annotations

from dataclasses import dataclass

from rl_tui.agents.exact.policies import policy_of_choices
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray


@dataclass(frozen=True, slots=True)
class DrawnPolicy:
    """The numbers of states and of the actions chosen there, by state; elsewhere it acts at random."""

    choices: tuple[tuple[int, int], ...] = ()

    def with_action(self, state: int, action: int | None) -> DrawnPolicy:
        """Return the policy with ``action`` in ``state``; None: with no choice there."""
        chosen = dict(self.choices)
        chosen.pop(state, None)
        if action is not None:
            chosen[state] = action
        return DrawnPolicy(tuple(sorted(chosen.items())))

    def fitting(self, space: FiniteSpace) -> DrawnPolicy:
        """Return the policy without what is no legal choice in ``space``."""
        legal = self.pairs(space)
        return DrawnPolicy(tuple(choice for choice in self.choices if choice[0] in legal))

    def pairs(self, space: FiniteSpace) -> dict[int, int]:
        """Return the pair chosen in each state of ``space`` in which what was chosen is legal."""
        chosen = {
            state: space.pair_of(state, action) for state, action in self.choices if state < space.states
        }
        return {state: pair for state, pair in chosen.items() if pair is not None}

    def chances(self, space: FiniteSpace) -> FloatArray:
        """Return π(a|s) of each pair of ``space``, [P]; uniform where nothing that is legal was chosen."""
        return policy_of_choices(space, self.pairs(space))
