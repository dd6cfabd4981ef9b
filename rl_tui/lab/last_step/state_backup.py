"""The backup of a state by a planner: its Bellman equation, with all numbers that went into it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from rl_tui.agents.last_step import LastStep
from rl_tui.agents.sweep_phases import SweepPhase
from rl_tui.lab.live.snapshot import AgentView
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.world import World

_TOLERANCE: Final = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class StateBackup:
    """The backup of ``state`` (Sutton & Barto, 2nd ed., equations 4.5, 4.9 and 4.10).

    ``phase`` is None in value iteration. ``pairs`` are those of the state, and all arrays [n], one number
    each: ``q`` = Σ p [r + γ V(s′)], which is ``reward`` + ``gamma`` · ``bootstrap``, and ``chance``, π(a|s)
    as it is after the backup; of value iteration it is shared among the best. ``value`` is V(s) after it.
    ``is_split`` says that reward and bootstrap are known: not where rewards drift.
    """

    state: int
    phase: SweepPhase | None
    pairs: range
    q: FloatArray
    reward: FloatArray
    bootstrap: FloatArray
    gamma: float
    chance: FloatArray
    value: float
    is_split: bool


def state_backup_of(world: World, agent: AgentView, last: LastStep) -> StateBackup | None:
    """Return the backup that ``last`` was; None where it was none, or its numbers are not known any more."""
    mdp, algorithm = world.mdp, agent.row
    pairs = world.space.pairs_of(last.state)
    if not last.planned or not last.learned or mdp is None or agent.learned_by[0] != algorithm.id:
        return None
    if not len(pairs) or not agent.holds(pairs.start):
        return None
    q = agent.q[pairs.start : pairs.stop]
    if agent.q[last.updated_pair] != last.after or not np.isfinite(q).all():
        return None  # another algorithm may have learned since
    if algorithm.takes_orders:
        if agent.sweep is None or not len(agent.policy) or not len(agent.values):
            return None
        chance, value = agent.policy[pairs.start : pairs.stop], float(agent.values[last.state])
        expected = float(chance @ q)
        is_kept = abs(expected - value) <= _TOLERANCE * max(1.0, abs(value))
        if agent.sweep == "evaluation" and not is_kept:
            return None
    else:
        best = q == q.max()
        chance, value = np.asarray(best / best.sum()), float(q.max())
        if value != last.after:
            return None
    first = mdp.outcomes_of(pairs.start).start
    outcomes = slice(first, mdp.outcomes_of(pairs[-1]).stop)
    owner = mdp.outcome_pair[outcomes] - pairs.start
    weighed = mdp.probability[outcomes] * mdp.reward[outcomes]
    reward: FloatArray = np.bincount(owner, weighed, minlength=len(pairs)).astype(np.float64)
    bootstrap = (q - reward) / last.gamma if last.gamma else np.zeros(len(pairs))
    return StateBackup(
        state=last.state,
        phase=agent.sweep if algorithm.takes_orders else None,
        pairs=pairs,
        q=q,
        reward=reward,
        bootstrap=bootstrap,
        gamma=last.gamma,
        chance=chance,
        value=value,
        is_split=not mdp.drift_std and last.gamma > 0.0,
    )
