"""A finite MDP in whole numbers: its probabilities and rewards as fractions over common denominators."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

import numpy as np

from rl_tui.agents.exact.solution import NoExactAnswer
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

LARGEST_DENOMINATOR: Final = 10**6


@dataclass(frozen=True, slots=True)
class RationalPair:
    """What follows one pair (state, action), in whole numbers.

    ``state`` and the states of ``moves`` are numbers into the live states. A move (state, weight) happens
    with probability weight / ``scale``; what is left of ``scale`` ends the episode. ``reward`` is ``scale``
    times the expected reward, in the model's unit of reward.
    """

    state: int
    scale: int
    reward: int
    moves: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class RationalModel:
    """An MDP of N live states in whole numbers.

    ``live`` lists the states that own pairs, [N]; ``pairs`` stand in the order of the MDP, [P], and live
    state n owns those of ``pairs_of[n]``. Rewards are counted in a unit that makes them whole: the unit is
    positive, so that what is optimal does not depend on it.
    """

    live: tuple[int, ...]
    pairs: tuple[RationalPair, ...]
    pairs_of: tuple[range, ...]


def rational_model(mdp: TabularMDP) -> RationalModel:
    """Return ``mdp`` in whole numbers.

    Each probability and reward is read as the nearest fraction with a denominator of at most 10⁶; the
    probabilities of a pair are then scaled to sum to exactly 1. Raises NoExactAnswer where one that is not 0
    would be read as 0.
    """
    live = np.flatnonzero(np.diff(mdp.first_pair)).tolist()
    number = {state: place for place, state in enumerate(live)}
    chances = [_read(chance) for chance in mdp.probability.tolist()]
    rewards = [_read(reward) for reward in mdp.reward.tolist()]
    unit = math.lcm(*(reward.denominator for reward in rewards))
    whole = [int(reward * unit) for reward in rewards]
    common = math.gcd(*whole) or 1
    landing = [
        None if ends else number[state]
        for state, ends in zip(mdp.next_state.tolist(), mdp.terminated.tolist(), strict=True)
    ]
    return RationalModel(
        live=tuple(live),
        pairs=tuple(
            _pair(
                number[state], [(chances[o], whole[o] // common, landing[o]) for o in mdp.outcomes_of(pair)]
            )
            for pair, state in enumerate(mdp.pair_state.tolist())
        ),
        pairs_of=tuple(mdp.pairs_of(state) for state in live),
    )


def _read(value: float) -> Fraction:
    read = Fraction(value).limit_denominator(LARGEST_DENOMINATOR)
    if value and not read:
        raise NoExactAnswer(
            f"flips read chances and rewards as fractions with denominators up to {LARGEST_DENOMINATOR:,}, "
            f"and {value:g} is too small for that"
        )
    return read


def _pair(state: int, outcomes: list[tuple[Fraction, int, int | None]]) -> RationalPair:
    """Return the pair of ``state`` with these outcomes: chance, reward, the live state that follows."""
    denominator = math.lcm(*(chance.denominator for chance, _, _ in outcomes))
    weights = [int(chance * denominator) for chance, _, _ in outcomes]
    common = math.gcd(*weights)
    reward, moves = 0, dict[int, int]()
    for weight, (_, paid, landing) in zip(weights, outcomes, strict=True):
        reward += weight // common * paid
        if landing is not None and weight:
            moves[landing] = moves.get(landing, 0) + weight // common
    return RationalPair(state, sum(weights) // common, reward, tuple(moves.items()))
