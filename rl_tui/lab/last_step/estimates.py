"""The estimates as the last update found them, worked back from those of a snapshot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rl_tui.agents.last_step import LastStep
from rl_tui.agents.policies.chances import action_chances
from rl_tui.agents.update_terms import Lookup, UpdateTerms
from rl_tui.lab.live.snapshot import AgentView
from rl_tui.worlds.mdp.space import BoolArray, FloatArray
from rl_tui.worlds.world import World


@dataclass(frozen=True, slots=True)
class EstimatesBefore:
    """What ``agent`` estimated before its ``last`` step taught it, for the pairs of one state at a time.

    ``terms`` say what the update looks up. Only the estimate that the step names is put back: where it made
    further updates, the others are as they are now.
    """

    world: World
    agent: AgentView
    last: LastStep
    terms: UpdateTerms

    def of(self, pairs: range) -> FloatArray | None:
        """Return the estimates of ``pairs``, None where there are none or the snapshot does not have them."""
        if not len(pairs) or not self.agent.holds(pairs.start):
            return None
        return self._put_back(self.agent.q, pairs, moved=not self.last.table)

    def looked_up(self, pairs: range) -> tuple[FloatArray, FloatArray] | None:
        """Return how much each of ``pairs`` counts in the value of their state, and their estimates.

        None where that is not known.
        """
        if self.terms.lookup is Lookup.OTHER:
            return self._judged(pairs)
        estimates = self.of(pairs)
        if estimates is None:
            return None
        if self.terms.lookup is Lookup.BEST:
            return equal_shares(estimates == estimates.max()), estimates
        visits = self.agent.visits[pairs.start : pairs.stop]
        policy = action_chances(self.agent.learned_by[1], self.last.epsilon, estimates, visits)
        return None if policy is None else (policy, estimates)

    def value(self, state: int) -> float | None:
        """Return what the update took ``state`` to be worth, as far as that is known."""
        if self.last.planned:  # of the state itself it has just changed
            is_known = state != self.last.state and len(self.agent.values)
            return float(self.agent.values[state]) if is_known else None
        pairs = self.world.space.pairs_of(state)
        if not len(pairs):
            return 0.0
        found = self.looked_up(pairs)
        if found is None:
            return None
        weights, estimates = found
        return float(estimates.max() if self.terms.lookup is Lookup.BEST else weights @ estimates)

    def _judged(self, pairs: range) -> tuple[FloatArray, FloatArray] | None:
        """Return which pairs are best in the table that learns, as shares, and the estimates of the other."""
        if len(self.agent.tables) != 2 or not self.last.table:
            return None
        own = self._put_back(self.agent.tables[self.last.table - 1], pairs, moved=True)
        other = self._put_back(self.agent.tables[2 - self.last.table], pairs, moved=False)
        best = own == own.max()
        if self.agent.learned_by[1].ties == "first":
            best = np.arange(len(own)) == int(np.argmax(best))
        return equal_shares(best), other

    def _put_back(self, table: FloatArray, pairs: range, *, moved: bool) -> FloatArray:
        """Return what ``table`` had for ``pairs``; ``moved`` says that it is the one that was updated."""
        estimates = table[pairs.start : pairs.stop].copy()
        if moved and self.last.updated_pair in pairs:
            estimates[self.last.updated_pair - pairs.start] = self.last.before
        return estimates


def equal_shares(chosen: BoolArray) -> FloatArray:
    """Return the same share for each of those ``chosen``, 0 for the others."""
    return np.asarray(chosen / chosen.sum())
