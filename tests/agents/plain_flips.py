"""The optimal actions of a small world, in fractions."""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterator
from fractions import Fraction
from typing import NamedTuple

from exact_reference import solve_rational

from rl_tui.agents.exact.flips import Flip
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp

Optimal = dict[int, tuple[int, ...]]


class PlainWorld(NamedTuple):
    pairs: dict[int, tuple[int, ...]]
    reward: list[Fraction]
    moves: list[dict[int, Fraction]]


def small_world(seed: int) -> TabularMDP:
    drawn = random.Random(seed)
    states, actions = drawn.randint(2, 5), drawn.randint(2, 3)
    transitions = []
    for state in range(states):
        for action in range(actions):
            parts = drawn.randint(1, 6)
            outcomes = {drawn.randrange(states): 0 for _ in range(drawn.randint(1, 3))}
            for _ in range(parts):
                outcomes[drawn.choice(list(outcomes))] += 1
            ends = drawn.random() < 0.25
            transitions.append(
                Transition(
                    state,
                    action,
                    [
                        Outcome(share / parts, to, drawn.randint(-4, 4) / drawn.choice([1, 1, 2, 3]), ends)
                        for to, share in outcomes.items()
                        if share
                    ],
                )
            )
    names = [f"s{state}" for state in range(states)]
    return tabular_mdp(names, ["a", "b", "c"][:actions], transitions, {0: 1.0})


def plain_world(mdp: TabularMDP) -> PlainWorld:
    pairs = {state: tuple(mdp.pairs_of(state)) for state in range(mdp.states) if mdp.pairs_of(state)}
    reward: list[Fraction] = []
    moves: list[dict[int, Fraction]] = []
    for pair in range(mdp.pairs):
        outcomes = mdp.outcomes_of(pair)
        chances = [near(mdp.probability[outcome]) for outcome in outcomes]
        reward.append(Fraction(0))
        moves.append({})
        for outcome, chance in zip(outcomes, chances, strict=True):
            reward[-1] += chance / sum(chances) * near(mdp.reward[outcome])
            if not mdp.terminated[outcome]:
                to = int(mdp.next_state[outcome])
                moves[-1][to] = moves[-1].get(to, Fraction(0)) + chance / sum(chances)
    return PlainWorld(pairs, reward, moves)


def near(number: float) -> Fraction:
    return Fraction(float(number)).limit_denominator(10**6)


def optimal_pairs(world: PlainWorld, gamma: Fraction, policy: dict[int, int]) -> Optimal:
    while True:
        v = values(world, gamma, policy)
        gains = {
            state: {
                pair: world.reward[pair]
                + gamma * sum(chance * v[to] for to, chance in world.moves[pair].items())
                - v[state]
                for pair in pairs
            }
            for state, pairs in world.pairs.items()
        }
        if all(gain <= 0 for each in gains.values() for gain in each.values()):
            return {
                state: tuple(pair for pair, gain in each.items() if gain == 0)
                for state, each in gains.items()
            }
        for state, each in gains.items():
            best = max(each, key=lambda pair: each[pair])
            if each[best] > 0:
                policy[state] = best


def values(world: PlainWorld, gamma: Fraction, policy: dict[int, int]) -> dict[int, Fraction]:
    states = list(policy)
    matrix = [
        [int(state == to) - gamma * world.moves[policy[state]].get(to, Fraction(0)) for to in states]
        for state in states
    ]
    right = [world.reward[policy[state]] for state in states]
    return dict(zip(states, solve_rational(matrix, right), strict=True))


def disagreements(mdp: TabularMDP, flips: tuple[Flip, ...], parts: int) -> Iterator[str]:
    """Check ``flips`` on a grid of γ, and at three points between two flips."""
    world = plain_world(mdp)
    policy = {state: pairs[0] for state, pairs in world.pairs.items()}
    ends = [Fraction(0), *(Fraction(flip.gamma) for flip in flips), Fraction(1)]
    inner = {
        lower + (upper - lower) * Fraction(part, 4)
        for lower, upper in itertools.pairwise(ends)
        for part in (1, 2, 3)
    }
    grid = {Fraction(part, parts) for part in range(1, parts)}
    here = [gamma for gamma in sorted(inner | grid) if all(abs(gamma - end) > 1e-12 for end in ends)]
    pending = list(flips)
    before: Optimal | None = None
    for gamma in here:
        now = optimal_pairs(world, gamma, policy)
        while pending and pending[0].gamma < gamma:
            flip = pending.pop(0)
            for turn in flip.turns:
                if before is not None and before[turn.state] != turn.before:
                    yield f"below {flip.gamma}: {before} is not {turn}"
                before = {**(before or now), turn.state: turn.after}
        if before is not None and now != before:
            yield f"at {gamma}: {now}, expected {before}"
        before = now
