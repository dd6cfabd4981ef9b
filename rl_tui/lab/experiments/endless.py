"""Worlds in which an episode may never come to an end."""

from __future__ import annotations

import numpy as np

from rl_tui.agents.exact.exact_model import exact_model
from rl_tui.common.streams import streams
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def endless_warning(scenario: Scenario) -> str:
    """Return, in one line, that episodes of ``scenario`` may never end; empty if they do.

    It is no fault: γ below 1 has an exact answer there too.
    """
    mdp = scenario.build(streams(0).world).mdp
    state = None if mdp is None else endless_state(mdp)
    if mdp is None or state is None:
        return ""
    from rl_tui.agents.kernels.stop import LONGEST_EPISODE

    return (
        f"state {mdp.state_names[state]} can never reach an end and there is no time limit: "
        f"training stops after {LONGEST_EPISODE:,} steps of one episode"
    )


def endless_state(mdp: TabularMDP) -> int | None:
    """Return the first state from which no end can be reached, though it can be reached itself.

    None where there is none, or where a time limit cuts every episode off.
    """
    if mdp.time_limit:
        return None
    model = exact_model(mdp)
    every_pair = np.ones(mdp.pairs, dtype=np.bool_)
    to_end = model.steps_to([model.end], every_pair)
    for state in model.live[to_end[model.live] < 0].tolist():
        if np.any(model.steps_to([state], every_pair)[mdp.start_state] >= 0):
            return int(state)
    return None
