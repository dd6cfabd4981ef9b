"""Which of the best actions may be taken at γ = 1, where to be greedy for Q* is not enough."""

from __future__ import annotations

import numpy as np

from rl_tui.agents.exact.exact_model import ExactModel
from rl_tui.worlds.mdp.space import BoolArray


def ending_ties(model: ExactModel, tied: BoolArray) -> BoolArray:
    """Return those of the ``tied`` pairs, [P], among which every choice ends with probability 1.

    ``tied`` marks the best pairs of each live state at γ = 1, by some of which an end can be reached from
    everywhere. A state's rank is the fewest steps in which luck may lead from it to an end by tied pairs. A
    tied pair is dropped if it stays for certain among states in which some choice never ends, and none of
    its outcomes has a lower rank; nothing is dropped where no choice can go on for ever.

    Proof: a choice that may go on for ever would come to a closed set of states, in which some choice never
    ends; so each of its pairs was kept for an outcome of lower rank, which the state of least rank in the
    set cannot have. A choice among best pairs that ends with probability 1 attains V*, since along it
    V*(s) = E[R + V*(S′)] adds up, step by step, to the expected return.
    """
    rank = model.steps_to([model.end], tied)
    lower = rank[model.landing] < rank[model.pair_state][model.outcome_pair]
    descends = np.logical_or.reduceat(lower, model.mdp.first_outcome[:-1])
    if (descends | ~tied).all():
        return tied
    endless = _endless(model, tied)
    stays = np.logical_and.reduceat(endless[model.landing], model.mdp.first_outcome[:-1])
    return tied & (descends | ~stays)


def _endless(model: ExactModel, usable: BoolArray) -> BoolArray:
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
