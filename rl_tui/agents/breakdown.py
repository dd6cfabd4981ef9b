"""Why a learner will not go on, in words."""

from __future__ import annotations

import numpy as np

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.kernels.stop import Stop
from rl_tui.agents.last_step import LastStep
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray


def breakdown(stop: Stop, algorithm: str, last: LastStep, space: FiniteSpace, q: FloatArray) -> str:
    """Return why ``algorithm`` stopped for good after the step ``last``, as a sentence; empty if it did not.

    ``q``, [P], are its estimates.
    """
    if stop is Stop.DIVERGED:
        pair = int(np.argmax(np.nan_to_num(np.abs(q), nan=np.inf)))
        chosen = BY_ID[algorithm]
        traces = "lambda" in chosen.parameters
        remedy = "discount" if chosen.planner else "step size or λ" if traces else "step size"
        return (
            f"Q({space.pair_name(pair)}) left ±1e12 at step {last.step:,}: "
            f"take a smaller {remedy} or start again"
        )
    if stop is Stop.ENDLESS_EPISODE:
        return f"episode {last.episode:,} has not ended after 10,000,000 steps, at step {last.step:,}"
    if stop is Stop.MEMORY_FULL:
        return (
            f"{BY_ID[algorithm].name} remembers 1,000,000 steps of an episode, and episode "
            f"{last.episode:,} has not ended, at step {last.step:,}"
        )
    return ""
