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

    ``bootstrap`` is empty where nothing is estimated; in it ``{next}`` stands for the next state, ``{own}``
    and ``{other}`` for the table that moved and the one beside it. ``others`` says where further updates of
    the same step came from, behind their number, and ``waiting`` why there was no update yet. With
    ``remembered`` an update may be of another pair than the one taken, and lead to a state of its own.
    ``lookup`` says which estimates the bootstrap comes from, and ``one_step`` that they are those of the
    state one step further.
    """

    gathered: str = "r"
    discount: str = "γ"
    bootstrap: str = "max Q({next},·)"
    others: str = "more"
    waiting: str = "nothing was updated"
    remembered: bool = False
    lookup: Lookup = Lookup.BEST
    one_step: bool = True


MAXIMUM = UpdateTerms()
NEXT_ACTION = UpdateTerms(bootstrap="Q({next},a′)", lookup=Lookup.NEXT)
EXPECTATION = UpdateTerms(bootstrap="Σ π Q({next},·)", lookup=Lookup.MEAN)
OTHER_TABLE = UpdateTerms(bootstrap="Q{other}({next}, best of Q{own})", lookup=Lookup.OTHER)
N_STEPS = UpdateTerms(
    gathered="G",
    discount="γⁿ",
    bootstrap="Q({next},a′)",
    others="more at the end of the episode",
    waiting="waits until n rewards are gathered",
    lookup=Lookup.NEXT,
    one_step=False,
)
WHOLE_RETURN = UpdateTerms(
    gathered="G",
    discount="γᵀ",
    bootstrap="Σ π Q({next},·)",
    others="more, back to its start",
    waiting="waits for the end of the episode",
    lookup=Lookup.MEAN,
    one_step=False,
)
TRACED_NEXT_ACTION = UpdateTerms(bootstrap="Q({next},a′)", others="more by their traces", lookup=Lookup.NEXT)
TRACED_MAXIMUM = UpdateTerms(others="more by their traces")
MODEL = UpdateTerms(others="more from the model")
SWEEPING = UpdateTerms(
    others="more from the model", waiting="no change above θ: nothing to update", remembered=True
)
MODEL_MAXIMUM = UpdateTerms(gathered="Σ p r", bootstrap="Σ p max Q(s′,·)", others="more of this state")
MODEL_POLICY = UpdateTerms(
    gathered="Σ p r", bootstrap="Σ p V(s′)", others="more of this state", lookup=Lookup.POLICY
)
