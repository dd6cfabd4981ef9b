"""Flips: every γ in (0, 1) at which the set of optimal actions changes in some state."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.exact.backward_induction import best_values
from rl_tui.agents.exact.exact_model import ExactModel, exact_model
from rl_tui.agents.exact.flips.optimal_intervals import optimal_intervals
from rl_tui.agents.exact.flips.rational_model import rational_model
from rl_tui.agents.exact.flips.real_roots import RealRoot
from rl_tui.agents.exact.flips.way import way_from_start
from rl_tui.agents.exact.policies import uniform_over
from rl_tui.agents.exact.policy_figures import expected_return
from rl_tui.agents.exact.solution import NoExactAnswer
from rl_tui.common.words import counted
from rl_tui.worlds.mdp.space import BoolArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

MOST_STATES: Final = 100
MIDDLE: Final = 0.5


@dataclass(frozen=True, slots=True)
class Turn:
    """What changes in one state: the pairs, numbers into [P], that are optimal ``before`` and ``after``.

    Before is below the flip's γ, after is above it.
    """

    state: int
    before: tuple[int, ...]
    after: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Flip:
    """A γ at which the optimal actions change: ``gamma`` is the float nearest to it.

    ``turns`` are the states whose optimal actions are others on its two sides, in their order.
    ``turns_the_way`` tells whether one of them is a start, or stands on the way from it below or above
    (:func:`~rl_tui.agents.exact.flips.way.way_from_start`). Where there is no way on one of the sides, only
    the start itself counts.
    ``expected_return`` is that of the optimal policy below and above, uniform over its ties: undiscounted,
    within the time limit, None where it has none.
    """

    gamma: float
    turns_the_way: bool
    expected_return: tuple[float | None, float | None]
    turns: tuple[Turn, ...]


def flips(mdp: TabularMDP) -> tuple[Flip, ...]:
    """Return the flips of ``mdp``, rising in γ: all of them and no other, whatever the floats.

    Probabilities and rewards are read as the nearest fractions with denominators up to 10⁶, and everything is
    decided in whole numbers. Where an action is as good at a single γ, and the sets on both sides are the
    same, nothing flips. Raises NoExactAnswer where more than 100 states are live, or a number that is not 0
    is too small to be read.
    """
    model = exact_model(mdp)
    if len(model.live) > MOST_STATES:
        raise NoExactAnswer(
            f"flips are worked out for at most {counted(MOST_STATES, 'state')}; "
            f"here {len(model.live):,} are live"
        )
    if mdp.terminated.all():
        return ()
    intervals = optimal_intervals(rational_model(mdp), _guess(model))
    sides = [_side(model, np.array(interval.optimal)) for interval in intervals]
    return tuple(
        _flip(model, interval.lower, *sides[place : place + 2])
        for place, interval in enumerate(intervals[1:])
        if interval.lower
    )


class _Side(NamedTuple):
    """What is optimal on one side of a flip, [P], what it earns, and its way from the start if it has one."""

    optimal: BoolArray
    expected_return: float | None
    way: BoolArray | None


def _guess(model: ExactModel) -> list[int]:
    """Return a policy, [N] pairs, that is most likely optimal at γ = 1/2."""
    mdp = model.mdp
    v = np.append(best_values(mdp, MIDDLE, mdp.states), 0.0).astype(np.longdouble)
    advantage = model.advantage(v, MIDDLE).tolist()
    return [max(mdp.pairs_of(state), key=advantage.__getitem__) for state in model.live.tolist()]


def _side(model: ExactModel, optimal: BoolArray) -> _Side:
    earned = expected_return(model.mdp, uniform_over(model.mdp, optimal))
    return _Side(optimal, earned, way_from_start(model, optimal))


def _flip(model: ExactModel, root: RealRoot, below: _Side, above: _Side) -> Flip:
    turns = tuple(_turns(model, below.optimal, above.optimal))
    on_the_way = np.zeros(model.end + 1, dtype=np.bool_)
    on_the_way[model.mdp.start_state] = True
    if below.way is not None and above.way is not None:
        on_the_way |= below.way | above.way
    return Flip(
        gamma=root.nearest_float(),
        turns_the_way=any(on_the_way[turn.state] for turn in turns),
        expected_return=(below.expected_return, above.expected_return),
        turns=turns,
    )


def _turns(model: ExactModel, before: BoolArray, after: BoolArray) -> Iterator[Turn]:
    for state in model.live.tolist():
        pairs = model.mdp.pairs_of(state)
        was, becomes = (tuple(pair for pair in pairs if optimal[pair]) for optimal in (before, after))
        if was != becomes:
            yield Turn(state, was, becomes)
