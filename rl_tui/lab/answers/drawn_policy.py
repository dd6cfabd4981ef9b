"""A policy that a person draws, action by action."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray


@dataclass(frozen=True, slots=True)
class DrawnPolicy:
    """The numbers of states and of the actions chosen there, by state; elsewhere it acts at random."""

    choices: tuple[tuple[int, int], ...] = ()

    def action_in(self, state: int) -> int | None:
        """Return the action chosen in ``state``, None where there is none."""
        return dict(self.choices).get(state)

    def with_action(self, state: int, action: int | None) -> DrawnPolicy:
        """Return the policy with ``action`` in ``state``; None: with no choice there."""
        chosen = dict(self.choices)
        chosen.pop(state, None)
        if action is not None:
            chosen[state] = action
        return DrawnPolicy(tuple(sorted(chosen.items())))

    def chances(self, space: FiniteSpace) -> FloatArray:
        """Return π(a|s) of each pair of ``space``, [P]; uniform where nothing that is legal was chosen."""
        each = np.diff(space.first_pair)
        policy: FloatArray = 1.0 / np.repeat(each, each)
        for state, action in self.choices:
            pair = space.pair_of(state, action) if state < space.states else None
            if pair is not None:
                policy[space.first_pair[state] : space.first_pair[state + 1]] = 0.0
                policy[pair] = 1.0
        return policy
