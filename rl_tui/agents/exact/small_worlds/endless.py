"""Parts of a small world that a policy never leaves: what they add to values at γ = 1."""

from __future__ import annotations

from rl_tui.agents.exact.small_worlds.chain import Chain
from rl_tui.agents.kernels.compiled import for_kernels
from rl_tui.worlds.mdp.space import BoolArray, IntArray


@for_kernels
def leave_out_endless(chain: Chain, pays: BoolArray, unknown: BoolArray, undefined: BoolArray) -> None:
    """Mark the states whose value has to be found, ``unknown``, and those that have none, ``undefined``.

    A part that is never left adds 0 where it pays nothing. Where it goes on paying it has no value, nor has a
    state from which luck may lead there. ``pays`` is memory; all three are [N+1], with the end as the last.
    """
    states = len(chain.earned)
    for state in range(states):
        pays[state] = chain.pays[state]
    pays[states] = False
    _mark_those_before(chain.first, chain.target, pays)
    # From where an end can be reached, or a part without rewards
    for state in range(states + 1):
        unknown[state] = not pays[state]
    _mark_those_before(chain.first, chain.target, unknown)
    for state in range(states + 1):
        undefined[state] = not unknown[state]
    _mark_those_before(chain.first, chain.target, undefined)
    for state in range(states + 1):
        unknown[state] = pays[state] and not undefined[state]


@for_kernels
def _mark_those_before(first: IntArray, target: IntArray, goals: BoolArray) -> None:
    """Mark all states from which luck may lead to one of ``goals``, [N+1], too."""
    states = len(first) - 1
    moved = True
    while moved:
        moved = False
        # There and back, since most ways lead to a neighbour
        for place in range(2 * states):
            state = place if place < states else 2 * states - 1 - place
            if not goals[state]:
                for way in range(first[state], first[state + 1]):
                    if goals[target[way]]:
                        goals[state] = True
                        moved = True
                        break
