"""The last update as a backup over all outcomes (Sutton & Barto, 2nd ed., section 3.5)."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass, replace

import numpy as np

from rl_tui.agents.catalogue import Lookup, UpdateTerms
from rl_tui.agents.last_step import LastStep
from rl_tui.agents.policies.chances import action_chances
from rl_tui.live.snapshot import AgentView
from rl_tui.worlds.mdp.space import BoolArray, FloatArray
from rl_tui.worlds.mdp.tabular_mdp import UNKNOWN_ACTION
from rl_tui.worlds.world import World

# Estimates before the update


@dataclass(frozen=True, slots=True)
class EstimatesBefore:
    """Estimates of `agent` before its `last` step.

    Only the updated pair is restored; after further updates, others are current ones.
    """

    world: World
    agent: AgentView
    last: LastStep
    terms: UpdateTerms

    def of(self, pairs: range) -> FloatArray | None:
        """Return the estimates of a state's `pairs`, if copied."""
        if not len(pairs) or not self.agent.holds(pairs.start):
            return None
        return self._put_back(self.agent.q, pairs, moved=not self.last.table)

    def looked_up(self, pairs: range) -> tuple[FloatArray, FloatArray] | None:
        """Return each pair's weight in the value of its state, and the estimates."""
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
        """Return the value of `state` in the update, if known."""
        if self.last.planned:  # a planner has just changed the value of the state itself
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
        if len(self.agent.tables) != 2 or not self.last.table:
            return None
        own = self._put_back(self.agent.tables[self.last.table - 1], pairs, moved=True)
        other = self._put_back(self.agent.tables[2 - self.last.table], pairs, moved=False)
        best = own == own.max()
        if self.agent.learned_by[1].ties == "first":
            best = np.arange(len(own)) == int(np.argmax(best))
        return equal_shares(best), other

    def _put_back(self, table: FloatArray, pairs: range, *, moved: bool) -> FloatArray:
        estimates = table[pairs.start : pairs.stop].copy()
        if moved and self.last.updated_pair in pairs:
            estimates[self.last.updated_pair - pairs.start] = self.last.before
        return estimates


def equal_shares(chosen: BoolArray) -> FloatArray:
    """Return equal shares for `chosen` pairs, 0 for others."""
    return np.asarray(chosen / chosen.sum())


# The backup and its leaves


@dataclass(frozen=True, slots=True)
class Leaf:
    """One leaf of a backup diagram.

    Attributes:
        action: Action that happens if the world slips, or −1 if unknown.
        reward: Mean reward, with the standard deviation `noise`.
        value: Value of the next state: 0 after a terminal outcome, None if unknown.
        happened: True for the outcome that was drawn.
    """

    probability: float | None
    action: int
    reward: float
    noise: float
    next_state: int
    terminated: bool
    value: float | None
    happened: bool


@dataclass(frozen=True, slots=True)
class Backup:
    """The backup of `pair` in `state`, with a leaf for each outcome.

    Attributes:
        sampled: Target of the update, or None if it waits or spans several steps.
        expected: Σ p (r + γ V(s′)) with the same estimates, if known.
        lookup: How the algorithm values the next state.
        is_current: True if the leaves have the update's estimates; further updates may have changed them.
    """

    state: int
    pair: int
    leaves: tuple[Leaf, ...]
    gamma: float
    sampled: float | None
    expected: float | None
    lookup: Lookup
    is_current: bool

    @property
    def is_certain(self) -> bool:
        """True if no other outcome was possible."""
        return len(self.leaves) == 1 and self.leaves[0].probability is not None and not self.leaves[0].noise


def expected_target(leaves: tuple[Leaf, ...], gamma: float) -> float | None:
    """Return Σ p (r + γ V(s′)), if all numbers are known."""
    terms = []
    for leaf in leaves:
        if leaf.probability is None or leaf.value is None:
            return None
        terms.append(leaf.probability * (leaf.reward + gamma * leaf.value))
    return math.fsum(terms)


def backup_of(before: EstimatesBefore, mean: FloatArray | None) -> Backup | None:
    """Return the backup of the last step, if it changed an estimate.

    `mean` has the current mean rewards, `[P]`, if they drift.
    """
    last, terms = before.last, before.terms
    if last.planned and not last.learned:
        return None
    one_step = terms.one_step and last.learned
    pair = last.updated_pair if one_step else last.pair
    leaves = _leaves(before, pair)
    if last.planned:
        leaves = _solved(leaves, last.bootstrap)
    elif mean is not None:
        leaves = tuple(replace(leaf, reward=float(mean[pair])) for leaf in leaves)
    expected = last.target if last.planned else expected_target(leaves, last.gamma)
    return Backup(
        state=last.state if pair == last.pair else before.world.space.state_of(pair),
        pair=pair,
        leaves=leaves,
        gamma=last.gamma,
        sampled=last.target if one_step else None,
        expected=expected if one_step or mean is not None else None,
        lookup=terms.lookup,
        is_current=last.planned or not last.others,
    )


def _leaves(before: EstimatesBefore, pair: int) -> tuple[Leaf, ...]:
    last, mdp = before.last, before.world.mdp
    happened = pair == last.pair
    if mdp is None:
        value = _value(before, last.next_state, terminated=last.terminated)
        sample = Leaf(
            None, UNKNOWN_ACTION, last.reward, 0.0, last.next_state, last.terminated, value, happened=True
        )
        return (sample,) if happened else ()
    leaves = []
    for outcome in mdp.outcomes_of(pair):
        next_state, terminated = int(mdp.next_state[outcome]), bool(mdp.terminated[outcome])
        leaves.append(
            Leaf(
                probability=float(mdp.probability[outcome]),
                action=int(mdp.outcome_action[outcome]),
                reward=float(mdp.reward[outcome]),
                noise=float(mdp.reward_std[outcome]),
                next_state=next_state,
                terminated=terminated,
                value=_value(before, next_state, terminated=terminated),
                happened=happened and outcome == last.outcome,
            )
        )
    return tuple(leaves)


def _value(before: EstimatesBefore, state: int, *, terminated: bool) -> float | None:
    if terminated:
        return 0.0
    is_bootstrap = state == before.last.bootstrap_state and before.terms.one_step
    if is_bootstrap and before.terms.lookup is not Lookup.NEXT:
        return before.last.bootstrap
    return before.value(state)


def _solved(leaves: tuple[Leaf, ...], bootstrap: float) -> tuple[Leaf, ...]:
    """Fill in the one unknown value of a planner's leaves from Σ p V(s′)."""
    unknown = [leaf for leaf in leaves if leaf.value is None]
    if len({leaf.next_state for leaf in unknown}) != 1:
        return leaves
    share = math.fsum(leaf.probability or 0.0 for leaf in unknown)
    known = math.fsum((leaf.probability or 0.0) * leaf.value for leaf in leaves if leaf.value is not None)
    found = (bootstrap - known) / share
    return tuple(leaf if leaf.value is not None else replace(leaf, value=found) for leaf in leaves)


def sources(before: EstimatesBefore) -> dict[int, float]:
    """Return the pairs that the bootstrap was read from, if known, with weights that equal ones share."""
    last, lookup = before.last, before.terms.lookup
    if last.planned:
        return _planned_sources(before)
    if last.bootstrap_state != last.next_state:  # no bootstrap, or that of a remembered pair
        return {}
    pairs = before.world.space.pairs_of(last.bootstrap_state)
    estimates = before.of(pairs)
    if lookup in (Lookup.BEST, Lookup.NEXT) and estimates is not None:
        equal = estimates == last.bootstrap
        if equal.any():
            return _positive(pairs, equal_shares(equal))
    found = None if lookup is Lookup.NEXT else before.looked_up(pairs)
    return {} if found is None else _positive(pairs, found[0])


def _planned_sources(before: EstimatesBefore) -> dict[int, float]:
    mdp, last = before.world.mdp, before.last
    found: dict[int, float] = defaultdict(float)
    if mdp is None or not last.learned or before.terms.lookup is not Lookup.BEST:
        return found
    for outcome in mdp.outcomes_of(last.updated_pair):
        state = int(mdp.next_state[outcome])
        looked_up = before.looked_up(mdp.pairs_of(state))
        if mdp.terminated[outcome] or state == last.state or looked_up is None:
            continue
        for pair, weight in _positive(mdp.pairs_of(state), looked_up[0]).items():
            found[pair] += float(mdp.probability[outcome]) * weight
    return found


def _positive(pairs: range, weights: FloatArray) -> dict[int, float]:
    return {pair: float(weight) for pair, weight in zip(pairs, weights, strict=True) if weight > 0.0}
