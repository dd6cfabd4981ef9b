"""Random finite MDPs for property tests."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp


@st.composite
def worlds(draw: st.DrawFn, most_states: int = 6, noise: bool = True) -> TabularMDP:
    states = draw(st.integers(2, most_states))
    actions = draw(st.integers(1, 4))
    generator = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    transitions = []
    for state in range(states - 1):
        legal = generator.permutation(actions)[: generator.integers(1, actions + 1)]
        for action in legal.tolist():
            targets = generator.integers(0, states, size=generator.integers(1, 4)).tolist()
            weights = generator.dirichlet(np.ones(len(targets))).tolist()
            outcomes = [
                Outcome(
                    weight,
                    target,
                    float(generator.integers(-2, 3)),
                    bool(generator.random() < 0.2),
                    float(generator.integers(0, 2)) * noise,
                    action,
                )
                for weight, target in zip(weights, targets, strict=True)
            ]
            transitions.append(Transition(state, action, outcomes))
    start = {0: 0.5, draw(st.integers(0, states - 2)): 0.5} if draw(st.booleans()) else {0: 1.0}
    if sum(start.values()) < 1.0:
        start = {0: 1.0}
    return tabular_mdp(
        [f"s{state}" for state in range(states)],
        [f"a{action}" for action in range(actions)],
        transitions,
        start,
        draw(st.sampled_from([0, 1, 5, 50])),
    )
