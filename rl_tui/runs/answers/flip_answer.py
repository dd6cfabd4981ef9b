"""The γ at which the optimal actions change, and Q* in between."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rl_tui.runs.background.child import bound_processor_time
from rl_tui.runs.background.pace import MACHINE_IS_BUSY
from rl_tui.worlds.mdp.space import FloatArray

if TYPE_CHECKING:
    from rl_tui.agents.exact.flips import Flip
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

GAMMAS: Final = 200
"""Number of equal intervals of γ in [0, 1] for Q*: more than a chart has columns."""
MOST_VALUES: Final = 300_000
"""Most values of Q* in one message, over all γ and pairs. Worlds with many pairs get fewer γ."""
MOST_SECONDS: Final = 300
"""Limit of CPU time in seconds. The slowest shipped world takes 5."""
_MOST_DECIMALS: Final = 12


class FlipState(StrEnum):
    """Progress of the computation."""

    NOT_ASKED = "not asked"
    PENDING = "pending"
    REFUSED = "refused"
    KNOWN = "known"


@dataclass(frozen=True, slots=True, eq=False)
class OptimalValueCurves:
    """Q* as a function of γ.

    Attributes:
        gamma: Rising values of γ in [0, 1], `[G]`.
        q: Q* at each γ, `[G, P]`.
    """

    gamma: FloatArray
    q: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class FlipAnswer:
    """The known flip points of one world, in rising γ."""

    state: FlipState = FlipState.NOT_ASKED
    reason: str = ""
    """Why the flip points are unknown or delayed, usually empty."""
    flips: tuple[Flip, ...] = ()
    curves: OptimalValueCurves | None = None
    """Q*(γ), or None if unknown, or if every step ends its episode."""

    @property
    def is_idle(self) -> bool:
        """True if γ changes nothing because every step ends its episode."""
        return self.state is FlipState.KNOWN and self.curves is None


NOT_ASKED: Final = FlipAnswer()
PENDING: Final = FlipAnswer(FlipState.PENDING)
HELD_UP: Final = FlipAnswer(FlipState.PENDING, MACHINE_IS_BUSY)


def refused(reason: str) -> FlipAnswer:
    """Return an answer without flip points."""
    return FlipAnswer(FlipState.REFUSED, reason)


def beyond(answer: FlipAnswer, flip: Flip, *, is_above: bool) -> float:
    """Return the γ with the fewest decimals (at least two) between `flip` and the next above or below."""
    gammas = [each.gamma for each in answer.flips]
    place = gammas.index(flip.gamma)
    if is_above:
        low, high = flip.gamma, gammas[place + 1] if place + 1 < len(gammas) else 1.0
    else:
        low, high = gammas[place - 1] if place else 0.0, flip.gamma
    for decimals in range(2, _MOST_DECIMALS + 1):
        parts = 10**decimals
        nearest = math.floor(low * parts) + 1 if is_above else math.ceil(high * parts) - 1
        gamma: float = nearest / parts
        if low < gamma < high:
            return gamma
    return (low + high) / 2.0


def work(mdp: TabularMDP, tell: Callable[[FlipAnswer, float], None]) -> None:
    """Send the flip points of `mdp` from a background process."""
    bound_processor_time(MOST_SECONDS)
    tell(worked_out(mdp), 1.0)


def worked_out(mdp: TabularMDP) -> FlipAnswer:
    """Compute all flip points and Q*(γ), or why there are none."""
    from rl_tui.agents.exact.flips import flips
    from rl_tui.agents.exact.policy_evaluation import NoExactAnswer

    try:
        found = flips(mdp)
    except NoExactAnswer as reason:
        return refused(str(reason))
    return FlipAnswer(FlipState.KNOWN, flips=found, curves=optimal_value_curves(mdp))


def optimal_value_curves(mdp: TabularMDP) -> OptimalValueCurves:
    """Compute Q* at equally spaced γ, as far as it exists."""
    from rl_tui.agents.exact.exact_model import exact_model
    from rl_tui.agents.exact.policy_evaluation import NoExactAnswer
    from rl_tui.agents.exact.policy_iteration import policy_iteration

    model = exact_model(mdp)
    gammas, q = list[float](), list[Any]()
    parts = min(GAMMAS, max(2, MOST_VALUES // mdp.pairs))
    for part in range(parts + 1):
        gamma = part / parts
        try:
            optimum = policy_iteration(model, gamma)
        except NoExactAnswer:
            break
        gammas.append(gamma)
        q.append((optimum.v[model.pair_state] + optimum.advantage).astype(np.float64))
    return OptimalValueCurves(np.array(gammas), np.array(q))
