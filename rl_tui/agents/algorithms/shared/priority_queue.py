"""A priority queue of pairs: a binary heap that knows the place of each, all in preallocated arrays.

Of equal priorities the pair of the lower number comes first, so that the order never depends on the heap's
layout.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.kernels.compiled import compiled
from rl_tui.worlds.mdp.space import FloatArray, IntArray

NOT_QUEUED: Final = -1


class Queue(NamedTuple):
    """``heap``, [P], begins with the ``size[0]`` pairs queued, the first of all in front.

    ``place``, [P], is where each pair stands in it, −1 for none; ``priority``, [P], counts for those queued.
    """

    heap: IntArray
    place: IntArray
    priority: FloatArray
    size: IntArray


def empty_queue(pairs: int) -> Queue:
    """Return a queue with room for ``pairs`` pairs."""
    return Queue(
        heap=np.zeros(pairs, dtype=np.int64),
        place=np.full(pairs, NOT_QUEUED, dtype=np.int64),
        priority=np.zeros(pairs),
        size=np.zeros(1, dtype=np.int64),
    )


@compiled
def enqueue(queue: Queue, pair: int, priority: float) -> None:
    """Insert ``pair``; one that is queued already moves up, and never down."""
    at = queue.place[pair]
    if at == NOT_QUEUED:
        at = queue.size[0]
        queue.size[0] += 1
    elif priority <= queue.priority[pair]:
        return
    queue.priority[pair] = priority
    while at > 0:
        parent = (at - 1) // 2
        above = queue.heap[parent]
        higher = queue.priority[above]
        if higher > priority or (higher == priority and above < pair):
            break
        queue.heap[at] = above
        queue.place[above] = at
        at = parent
    queue.heap[at] = pair
    queue.place[pair] = at


@compiled
def dequeue(queue: Queue) -> int:
    """Take out the pair of the highest priority, of a queue that is not empty."""
    first: int = queue.heap[0]
    queue.place[first] = NOT_QUEUED
    queue.size[0] -= 1
    size = queue.size[0]
    if size == 0:
        return first
    # The last one sinks from the front to where it belongs
    pair = queue.heap[size]
    priority = queue.priority[pair]
    at = 0
    child = 1
    while child < size:
        below = queue.heap[child]
        if child + 1 < size:
            other = queue.heap[child + 1]
            lower, upper = queue.priority[below], queue.priority[other]
            if upper > lower or (upper == lower and other < below):
                child += 1
                below = other
        lower = queue.priority[below]
        if priority > lower or (priority == lower and pair < below):
            break
        queue.heap[at] = below
        queue.place[below] = at
        at = child
        child = 2 * at + 1
    queue.heap[at] = pair
    queue.place[pair] = at
    return first
