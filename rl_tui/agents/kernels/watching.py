"""What a learner watches for, and what it noticed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple


@dataclass(frozen=True, slots=True)
class Watching:
    """What to stop after: any of these.

    * ``reward``: a step whose reward is not 0.
    * ``policy``: a change of the greedy policy in any state: of the actions that share the maximum, or where
      ties go to the first of them, of that one. Equality is exact, as the agent itself compares.
    * ``cell``: the estimate of this pair comes to ``threshold`` or past it, from the side it was on.
    * ``states``: the agent arrives in one of these, by a step or where an episode starts after another; a
      planner backs one up.
    * ``pairs``: one of these is taken; a planner updates one.
    """

    reward: bool = False
    policy: bool = False
    cell: int | None = None
    threshold: float = 0.0
    states: frozenset[int] = frozenset()
    pairs: frozenset[int] = frozenset()


class WatchedEvents(NamedTuple):
    """What happened in one step of what is watched for; ``state`` and ``pair`` are the marked ones."""

    reward: bool = False
    policy: bool = False
    cell: bool = False
    state: int | None = None
    pair: int | None = None


NOTHING_NOTICED = WatchedEvents()
