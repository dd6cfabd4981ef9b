"""Search for the states that can be reached from the start."""

from __future__ import annotations

import sys
from typing import Final

import numpy as np

from rl_tui.common.packages import is_installed
from rl_tui.worlds.mdp.space import BoolArray, IntArray

# Up to this many edges, a plain search is faster than importing SciPy
MOST_PLAIN: Final = 100_000
# Up to this many edges, it is faster than SciPy's search
FEW: Final = 2_000
_COMPILED: Final = "scipy.sparse"


def reachable(first_edge: IntArray, leads_to: IntArray, start: IntArray) -> BoolArray:
    """Return which of S states can be reached from `start`, [K].

    State s owns the edges first_edge[s] .. first_edge[s+1], [S+1], which lead to other states, [E].
    """
    most_plain = min(FEW, MOST_PLAIN) if _COMPILED in sys.modules else MOST_PLAIN
    is_few = len(leads_to) <= most_plain or not is_installed("scipy")
    search = _plain_search if is_few else _large_search
    return search(first_edge, leads_to, start)


def _plain_search(first_edge: IntArray, leads_to: IntArray, start: IntArray) -> BoolArray:
    first, ends = first_edge.tolist(), leads_to.tolist()
    reached = bytearray(len(first) - 1)
    to_visit = []
    for state in start.tolist():
        if not reached[state]:
            reached[state] = 1
            to_visit.append(state)
    while to_visit:
        state = to_visit.pop()
        for end in ends[first[state] : first[state + 1]]:
            if not reached[end]:
                reached[end] = 1
                to_visit.append(end)
    return np.frombuffer(reached, dtype=np.bool_).copy()


def _large_search(first_edge: IntArray, leads_to: IntArray, start: IntArray) -> BoolArray:
    # From an extra state with edges to all of `start`
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import breadth_first_order

    states = len(first_edge) - 1
    ends = np.concatenate([leads_to, start]).astype(np.int32)
    first = np.append(first_edge, len(ends)).astype(np.int32)
    graph = csr_array((np.ones(len(ends)), ends, first), shape=(states + 1, states + 1))
    order = breadth_first_order(graph, states, return_predecessors=False)
    reached = np.zeros(states + 1, dtype=np.bool_)
    reached[order] = True
    return reached[:states]
