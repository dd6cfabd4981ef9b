"""The flips of a world: every γ at which its optimal actions change, and Q* between them."""

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
"""Equal parts of 0 to 1 at whose ends Q* is worked out: more than a chart has columns of dots."""
MOST_VALUES: Final = 300_000
"""Of all pairs at all γ, which are one message: a world of very many actions has fewer γ."""
MOST_SECONDS: Final = 300
"""Of a processor. The dearest of the shipped worlds takes 5."""
_MOST_DECIMALS: Final = 12


class FlipState(StrEnum):
    """How far they are known."""

    NOT_ASKED = "not asked"
    PENDING = "pending"
    REFUSED = "refused"
    KNOWN = "known"


@dataclass(frozen=True, slots=True, eq=False)
class OptimalValueCurves:
    """Q* as a function of γ: ``q``, [G, P], at the rising ``gamma``, [G], from 0 to at most 1."""

    gamma: FloatArray
    q: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class FlipAnswer:
    """The flips of one world, rising in γ, as far as they are known."""

    state: FlipState = FlipState.NOT_ASKED
    """How far they are known."""
    reason: str = ""
    """Why they will not be known, or not soon, in words; mostly empty."""
    flips: tuple[Flip, ...] = ()
    """All of them."""
    curves: OptimalValueCurves | None = None
    """Q*(γ); None where it is not known, and where each step ends its episode."""

    @property
    def is_idle(self) -> bool:
        """Whether γ changes nothing, since each step ends its episode."""
        return self.state is FlipState.KNOWN and self.curves is None


NOT_ASKED: Final = FlipAnswer()
PENDING: Final = FlipAnswer(FlipState.PENDING)
HELD_UP: Final = FlipAnswer(FlipState.PENDING, MACHINE_IS_BUSY)


def refused(reason: str) -> FlipAnswer:
    """Return the answer that they will not be known, for this ``reason``."""
    return FlipAnswer(FlipState.REFUSED, reason)


def beyond(answer: FlipAnswer, flip: Flip, *, is_above: bool) -> float:
    """Return the roundest γ, of two decimals or more, on one side of ``flip`` and before the next one."""
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
    """Tell all flips of ``mdp``, or why there are none; what a process of its own does."""
    bound_processor_time(MOST_SECONDS)
    tell(worked_out(mdp), 1.0)


def worked_out(mdp: TabularMDP) -> FlipAnswer:
    """Return all flips of ``mdp`` and Q* from γ = 0 to 1, or why there are none."""
    from rl_tui.agents.exact.flips import flips
    from rl_tui.agents.exact.policy_evaluation import NoExactAnswer

    try:
        found = flips(mdp)
    except NoExactAnswer as reason:
        return refused(str(reason))
    return FlipAnswer(FlipState.KNOWN, flips=found, curves=optimal_value_curves(mdp))


def optimal_value_curves(mdp: TabularMDP) -> OptimalValueCurves:
    """Return Q* from γ = 0 to 1, where there is one at 1, else to the last γ that has one."""
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
