"""A priority queue of pairs: a binary heap in preallocated arrays.

With equal priorities the lower pair number comes first, whatever the layout of the heap.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.kernels.compiled import compiled
from rl_tui.worlds.mdp.space import FloatArray, IntArray

NOT_QUEUED: Final = -1


class Queue(NamedTuple):
    """The first ``size[0]`` entries of `heap`, [P], are the queued pairs.

    `place`, [P], is the index in the heap, or −1. `priority`, [P], is valid for queued pairs.
    """

    heap: IntArray
    place: IntArray
    priority: FloatArray
    size: IntArray


def empty_queue(pairs: int) -> Queue:
    """Return a queue with room for `pairs` pairs."""
    return Queue(
        heap=np.zeros(pairs, dtype=np.int64),
        place=np.full(pairs, NOT_QUEUED, dtype=np.int64),
        priority=np.zeros(pairs),
        size=np.zeros(1, dtype=np.int64),
    )


@compiled
def enqueue(queue: Queue, pair: int, priority: float) -> None:
    """Insert `pair`, or raise its priority."""
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
    """Remove and return the most urgent pair. The queue must not be empty."""
    first: int = queue.heap[0]
    queue.place[first] = NOT_QUEUED
    queue.size[0] -= 1
    size = queue.size[0]
    if size == 0:
        return first
    # The last pair moves to the front and sinks to its place
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
