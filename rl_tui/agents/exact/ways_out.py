"""Where episodes lead: states that are never reached, and states from which there is no way to an end."""

from __future__ import annotations

import numpy as np

from rl_tui.agents.exact.exact_model import ExactModel, Ways, exact_model
from rl_tui.worlds.mdp.reachable import reachable
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def endless_states(mdp: TabularMDP) -> BoolArray:
    """Return the states, [S], that an episode may come to and from which no policy can reach an end.

    None of them where a time limit cuts every episode off. It takes some milliseconds for 10,000 states.
    """
    return np.zeros(mdp.states, dtype=np.bool_) if mdp.time_limit else states_without_end(mdp)


def states_without_end(mdp: TabularMDP) -> BoolArray:
    """Return the states, [S], as :func:`endless_states` does, but with the time limit left aside.

    None of them where no episode ends but by the time limit: there that is the end.
    """
    live = _is_live(mdp)
    endless = live & ~_comes_to_an_end(mdp, np.ones(len(mdp.next_state), dtype=np.bool_))
    return np.zeros_like(endless) if mdp.time_limit and (endless == live).all() else endless


def endless_part(mdp: TabularMDP, policy: FloatArray) -> int | None:
    """Return a state that ``policy``, [P], may come to from the start and from which it never ends.

    None where it ends with probability 1, whatever the time limit: that is left aside. A chain of finitely
    many states never ends, with a chance above 0, just where it can come to such a state, so that this is
    decided by ways alone, exactly.
    """
    followed = policy[mdp.outcome_pair] > 0.0
    goes_on = followed & ~mdp.terminated
    edges_before = np.append(0, np.cumsum(goes_on))
    first_edge = edges_before[mdp.first_outcome[mdp.first_pair]]
    reached = reachable(first_edge, mdp.next_state[goes_on], mdp.start_state[mdp.start_probability > 0.0])
    lost = np.flatnonzero(reached & _is_live(mdp) & ~_comes_to_an_end(mdp, followed))
    return int(lost[0]) if len(lost) else None


def steps_from_start(mdp: TabularMDP) -> IntArray:
    """Return the fewest steps, [S], in which luck may lead from a start to each state, be it an end.

    −1 where no policy can reach it. The time limit is left aside.
    """
    ways = Ways(mdp.next_state, mdp.pair_state[mdp.outcome_pair], mdp.states)
    return ways.steps_to(mdp.start_state[mdp.start_probability > 0.0].tolist())


def never_reached(mdp: TabularMDP) -> IntArray:
    """Return the states, [N], rising, that no episode comes to: no way leads there within the time limit."""
    steps = steps_from_start(mdp)
    is_too_far = steps > mdp.time_limit if mdp.time_limit else np.zeros(mdp.states, dtype=np.bool_)
    return np.flatnonzero((steps < 0) | is_too_far)


def shortest_way(mdp: TabularMDP, usable: BoolArray) -> int | None:
    """Return the fewest steps in which luck may lead by ``usable`` pairs, [P], from a start to an end.

    The time limit is left aside. None where they lead to no end.
    """
    model = exact_model(mdp)
    from_start = model.steps_to([model.end], usable)[mdp.start_state[mdp.start_probability > 0.0]]
    known = from_start[from_start >= 0]
    return int(known.min()) if len(known) else None


def staying_states(model: ExactModel, usable: BoolArray) -> BoolArray:
    """Return the states, [S+1], in which some choice among the ``usable`` pairs, [P], never ends.

    It is the largest set each of whose states owns a usable pair with all outcomes in the set: whatever has
    no such pair is taken out, until all have one.
    """
    inside = model.is_live
    used = usable[model.outcome_pair]
    source, target = model.outcome_pair[used], model.landing[used]
    order = np.argsort(target, kind="stable")
    arriving = source[order].tolist()
    first = np.searchsorted(target[order], np.arange(model.end + 2)).tolist()
    owner = model.pair_state.tolist()
    stays = usable.tolist()
    staying = np.bincount(model.pair_state[usable], minlength=model.end + 1).tolist()
    outside = np.flatnonzero(~inside).tolist()
    for state in outside:
        for pair in arriving[first[state] : first[state + 1]]:
            if stays[pair]:
                stays[pair] = False
                staying[owner[pair]] -= 1
                if staying[owner[pair]] == 0:
                    outside.append(owner[pair])
    inside[outside] = False
    return inside


def _is_live(mdp: TabularMDP) -> BoolArray:
    return np.asarray(np.diff(mdp.first_pair) > 0)


def _comes_to_an_end(mdp: TabularMDP, usable: BoolArray) -> BoolArray:
    """Return from which states, [S], the ``usable`` outcomes, [O], can lead to an end."""
    source = mdp.pair_state[mdp.outcome_pair]
    goes_on = usable & ~mdp.terminated
    ways = Ways(source[goes_on], mdp.next_state[goes_on], mdp.states)
    return ways.leading_to(np.unique(source[usable & mdp.terminated]))
