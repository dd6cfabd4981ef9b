"""The symbols of an algorithm's update, in which the screen writes the last step."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto


class Lookup(Enum):
    """Which estimates of the next state an update looks up."""

    BEST = auto()  # the greatest
    NEXT = auto()  # that of the action taken next
    MEAN = auto()  # all, weighted by the policy
    OTHER = auto()  # that of the best action, in the other of two tables
    POLICY = auto()  # those of the policy that a planner keeps


@dataclass(frozen=True, slots=True)
class UpdateTerms:
    """The symbols of target = gathered + discount · bootstrap, and the words around an update.

    The defaults are those of Q-learning. ``bootstrap`` is empty where nothing is estimated; in it ``{next}``
    stands for the next state, ``{own}`` and ``{other}`` for the table that moved and the one beside it.
    ``others`` says where further updates of the same step came from, behind their number, and ``waiting`` why
    there was no update yet. ``lookup`` says which estimates the bootstrap comes from, and ``one_step`` that
    they are those of the state one step further.
    """

    gathered: str = "r"
    discount: str = "γ"
    bootstrap: str = "max Q({next},·)"
    others: str = "more"
    waiting: str = "nothing was updated"
    lookup: Lookup = Lookup.BEST
    one_step: bool = True
