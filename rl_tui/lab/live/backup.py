"""The last update as a backup over all that might have happened (Sutton & Barto, 2nd ed., section 3.5)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.last_step import LastStep
from rl_tui.agents.policies.chances import action_chances
from rl_tui.agents.update_terms import Lookup
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import UNKNOWN_ACTION, TabularMDP


@dataclass(frozen=True, slots=True)
class Leaf:
    """One thing that may follow a pair: the end of one line of a backup diagram.

    ``probability`` is None where nobody knows it. ``action`` is what really happens where the world slips, −1
    if not known; ``noise`` the standard deviation of the reward around ``reward``. ``value`` is what the
    algorithm takes the next state to be worth: 0 after an end, None where it is not known. ``happened`` marks
    what the environment drew.
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
    """The backup of ``pair`` in ``state``, a leaf an outcome, with γ as it was.

    ``sampled`` is the target of the update, None where it waits or spans several steps; ``expected`` is
    Σ p (r + γ V(s′)) over the leaves, with the same estimates, None where it is not known. ``is_current``
    says that these are the estimates that the update saw: further updates of the same step may have moved
    them since.
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
        """Whether nothing but this could have followed."""
        return len(self.leaves) == 1 and self.leaves[0].probability is not None and not self.leaves[0].noise


def expected_target(leaves: tuple[Leaf, ...], gamma: float) -> float | None:
    """Return Σ p (r + γ V(s′)) over ``leaves``, None where one of their numbers is not known."""
    terms = []
    for leaf in leaves:
        if leaf.probability is None or leaf.value is None:
            return None
        terms.append(leaf.probability * (leaf.reward + gamma * leaf.value))
    return math.fsum(terms)


def backup_of(snapshot: Snapshot) -> Backup | None:
    """Return the backup of the last step, None where there is none: before the first, or without its pair."""
    last = snapshot.counters.last_step
    if last is None or (last.planned and not last.learned):
        return None
    algorithm, _ = snapshot.agent.learned_by
    terms = BY_ID[algorithm].update
    is_elsewhere = last.planned or (terms.remembered and last.learned)
    pair = last.updated_pair if is_elsewhere else last.pair
    leaves = _leaves(snapshot, last, pair)
    expected: float | None
    one_step = terms.one_step and last.learned
    mdp, solution = snapshot.world.mdp, snapshot.exact_answer.solution
    if last.planned:
        leaves, expected = _solved(leaves, last), last.target
    elif mdp is not None and mdp.drift_std and solution is not None:
        expected = float(solution.q[pair])  # the mean as it is now; the model has where it began
        leaves = tuple(replace(leaf, reward=expected) for leaf in leaves)
    else:
        expected = expected_target(leaves, last.gamma) if one_step else None
    return Backup(
        state=last.state if pair == last.pair else snapshot.world.space.state_of(pair),
        pair=pair,
        leaves=leaves,
        gamma=last.gamma,
        sampled=last.target if one_step else None,
        expected=expected,
        lookup=terms.lookup,
        is_current=last.planned or not last.others,
    )


def sources(snapshot: Snapshot) -> dict[int, float]:
    """Return the pairs that the bootstrap of the last update was read from, each with its weight in it.

    Of several equal ones that may have been it each has an equal share. Nothing where the update looked up
    nothing, or where nobody knows any more what it saw.
    """
    last = snapshot.counters.last_step
    if last is None or not last.learned:
        return {}
    terms = BY_ID[snapshot.agent.learned_by[0]].update
    if last.planned:
        return _planned_sources(snapshot, last, terms.lookup)
    if terms.remembered and last.updated_pair != last.pair:
        return {}
    if last.terminated and (terms.one_step or last.bootstrap == 0.0):
        return {}
    pairs = snapshot.world.space.pairs_of(last.next_state)
    seen = _seen(snapshot, last, pairs)
    if seen is None or not len(pairs):
        return {}
    if terms.lookup is Lookup.MEAN:
        weights = _chances(snapshot, last, pairs, seen)
        return {} if weights is None else _positive(pairs, weights)
    if terms.lookup is Lookup.OTHER:
        judged = _judged(snapshot, last, pairs)
        return {} if judged is None else _positive(pairs, judged[0])
    found = seen == last.bootstrap
    if not found.any():
        if terms.lookup is not Lookup.BEST:
            return {}
        found = seen == seen.max()
    return _positive(pairs, found / found.sum())


def _leaves(snapshot: Snapshot, last: LastStep, pair: int) -> tuple[Leaf, ...]:
    mdp = snapshot.world.mdp
    happened = last.outcome if pair == last.pair else UNKNOWN_ACTION
    if mdp is None:
        sample = Leaf(
            None, UNKNOWN_ACTION, last.reward, 0.0, last.next_state, last.terminated, None, happened=True
        )
        value = 0.0 if last.terminated else _value(snapshot, last, last.next_state)
        return (replace(sample, value=value),) if pair == last.pair else ()
    return tuple(
        _leaf(snapshot, last, mdp, outcome, outcome == happened) for outcome in mdp.outcomes_of(pair)
    )


def _leaf(snapshot: Snapshot, last: LastStep, mdp: TabularMDP, outcome: int, happened: bool) -> Leaf:
    next_state, terminated = int(mdp.next_state[outcome]), bool(mdp.terminated[outcome])
    return Leaf(
        probability=float(mdp.probability[outcome]),
        action=int(mdp.outcome_action[outcome]),
        reward=float(mdp.reward[outcome]),
        noise=float(mdp.reward_std[outcome]),
        next_state=next_state,
        terminated=terminated,
        value=0.0 if terminated else _value(snapshot, last, next_state),
        happened=happened,
    )


def _value(snapshot: Snapshot, last: LastStep, state: int) -> float | None:
    """Return what the update took ``state`` to be worth, as far as that is known."""
    terms = BY_ID[snapshot.agent.learned_by[0]].update
    if last.planned and (state == last.state or not len(snapshot.agent.values)):
        return None  # that of the state itself has just changed
    if last.planned:
        return float(snapshot.agent.values[state])
    own_step = terms.one_step and last.updated_pair == last.pair and state == last.next_state
    if own_step and terms.lookup is not Lookup.NEXT and not last.terminated:
        return last.bootstrap
    pairs = snapshot.world.space.pairs_of(state)
    if not len(pairs):
        return 0.0
    if terms.lookup is Lookup.OTHER:
        judged = _judged(snapshot, last, pairs)
        return None if judged is None else float(judged[0] @ judged[1])
    seen = _seen(snapshot, last, pairs)
    if seen is None:
        return None
    if terms.lookup is Lookup.BEST:
        return float(seen.max())
    weights = _chances(snapshot, last, pairs, seen)
    return None if weights is None else float(weights @ seen)


def _seen(snapshot: Snapshot, last: LastStep, pairs: range) -> FloatArray | None:
    """Return the estimates of ``pairs``, those of one state, before the update that is told of."""
    if not len(pairs) or not snapshot.agent.holds(pairs.start):
        return None
    seen = snapshot.agent.q[pairs.start : pairs.stop].copy()
    if last.updated_pair in pairs and not last.table:
        seen[last.updated_pair - pairs.start] = last.before
    return seen


def _chances(snapshot: Snapshot, last: LastStep, pairs: range, seen: FloatArray) -> FloatArray | None:
    """Return π of the pairs of one state."""
    visits = snapshot.agent.visits[pairs.start : pairs.stop]
    return action_chances(snapshot.agent.learned_by[1], last.epsilon, seen, visits)


def _judged(snapshot: Snapshot, last: LastStep, pairs: range) -> tuple[FloatArray, FloatArray] | None:
    """Return which pairs are best in the table that learns, as weights, and all estimates of the other."""
    if len(snapshot.agent.tables) != 2 or not last.table:
        return None
    own, other = (
        snapshot.agent.tables[each][pairs.start : pairs.stop].copy()
        for each in (last.table - 1, 2 - last.table)
    )
    if last.updated_pair in pairs:
        own[last.updated_pair - pairs.start] = last.before
    best = own == own.max()
    if snapshot.agent.learned_by[1].ties == "first":
        best = np.arange(len(own)) == int(np.argmax(best))
    return best / best.sum(), other


def _solved(leaves: tuple[Leaf, ...], last: LastStep) -> tuple[Leaf, ...]:
    """Return a planner's leaves with the value that follows from Σ p V(s′) where one alone is not known."""
    unknown = {leaf.next_state for leaf in leaves if leaf.value is None}
    if len(unknown) != 1:
        return leaves
    share = math.fsum(leaf.probability or 0.0 for leaf in leaves if leaf.value is None)
    known = math.fsum((leaf.probability or 0.0) * leaf.value for leaf in leaves if leaf.value is not None)
    found = (last.bootstrap - known) / share
    return tuple(leaf if leaf.value is not None else replace(leaf, value=found) for leaf in leaves)


def _planned_sources(snapshot: Snapshot, last: LastStep, lookup: Lookup) -> dict[int, float]:
    """Return the best pairs of all next states: what value iteration looks up."""
    mdp = snapshot.world.mdp
    if mdp is None or lookup is not Lookup.BEST:
        return {}
    found: dict[int, float] = {}
    for outcome in mdp.outcomes_of(last.updated_pair):
        state = int(mdp.next_state[outcome])
        pairs = mdp.pairs_of(state)
        if mdp.terminated[outcome] or state == last.state or not snapshot.agent.holds(pairs.start):
            continue
        best = snapshot.agent.q[pairs.start : pairs.stop]
        probability = float(mdp.probability[outcome])
        for pair, weight in _positive(pairs, (best == best.max()) / (best == best.max()).sum()).items():
            found[pair] = found.get(pair, 0.0) + probability * weight
    return found


def _positive(pairs: range, weights: FloatArray) -> dict[int, float]:
    return {pair: float(weight) for pair, weight in zip(pairs, weights, strict=True) if weight > 0.0}
