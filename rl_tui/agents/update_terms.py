"""How the update of an algorithm is written, so that the last step can be told in its own symbols."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class UpdateTerms:
    """The symbols of target = gathered + discount · bootstrap, and the words around an update.

    ``bootstrap`` is empty where nothing is estimated; in it ``{next}`` stands for the next state, ``{own}``
    and ``{other}`` for the table that moved and the one beside it. ``others`` says where further updates of
    the same step came from, behind their number, and ``waiting`` why there was no update yet. With
    ``remembered`` an update may be of another pair than the one taken, and lead to a state of its own.
    """

    gathered: str = "r"
    discount: str = "γ"
    bootstrap: str = "max Q({next},·)"
    others: str = "more"
    waiting: str = "nothing was updated"
    remembered: bool = False


MAXIMUM = UpdateTerms()
NEXT_ACTION = UpdateTerms(bootstrap="Q({next},a′)")
EXPECTATION = UpdateTerms(bootstrap="Σ π Q({next},·)")
OTHER_TABLE = UpdateTerms(bootstrap="Q{other}({next}, best of Q{own})")
N_STEPS = UpdateTerms(
    gathered="G",
    discount="γⁿ",
    bootstrap="Q({next},a′)",
    others="more at the end of the episode",
    waiting="waits until n rewards are gathered",
)
WHOLE_RETURN = UpdateTerms(
    gathered="G",
    discount="γᵀ",
    bootstrap="Σ π Q({next},·)",
    others="more of the same episode",
    waiting="waits for the end of the episode",
)
TRACED_NEXT_ACTION = UpdateTerms(bootstrap="Q({next},a′)", others="more by their traces")
TRACED_MAXIMUM = UpdateTerms(others="more by their traces")
MODEL = UpdateTerms(others="more from the model")
SWEEPING = UpdateTerms(
    others="more from the model", waiting="no change above θ: nothing to update", remembered=True
)
MODEL_MAXIMUM = UpdateTerms(gathered="Σ p r", bootstrap="Σ p max Q(s′,·)", others="more of this state")
MODEL_POLICY = UpdateTerms(gathered="Σ p r", bootstrap="Σ p V(s′)", others="more of this state")
