"""What is known of the flips of a world: every γ at which its optimal actions change, and Q* between them."""

from __future__ import annotations

import math
from base64 import b64decode, b64encode
from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rl_tui.lab.workers.pace import MACHINE_IS_BUSY
from rl_tui.worlds.mdp.space import FloatArray

if TYPE_CHECKING:
    from rl_tui.agents.exact.flips.flips import Flip

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


def as_json(answer: FlipAnswer) -> dict[str, Any]:
    """Return ``answer`` as a JSON document, floats to the last bit."""
    curves = answer.curves
    return {
        "state": answer.state.value,
        "reason": answer.reason,
        "flips": [asdict(flip) for flip in answer.flips],
        "curves": None if curves is None else {"gamma": curves.gamma.tolist(), "q": _in_base64(curves.q)},
    }


def _in_base64(values: FloatArray) -> str:
    """Return ``values`` as text that is read at once, where a list of numbers would stop all threads."""
    return b64encode(values.astype("<f8").tobytes()).decode("ascii")


def _of_base64(text: str, rows: int) -> FloatArray:
    return np.frombuffer(b64decode(text), "<f8").astype(np.float64).reshape(rows, -1)


def of_json(document: dict[str, Any]) -> FlipAnswer:
    """Return what :func:`as_json` was given; raises ValueError, KeyError or TypeError where it is another."""
    curves = document["curves"]
    return FlipAnswer(
        FlipState(document["state"]),
        document["reason"],
        flips_of_json(document["flips"]),
        None
        if curves is None
        else OptimalValueCurves(np.array(curves["gamma"]), _of_base64(curves["q"], len(curves["gamma"]))),
    )


def flips_of_json(document: list[dict[str, Any]]) -> tuple[Flip, ...]:
    """Return the flips that ``document`` has; raises KeyError or TypeError where it is another."""
    from rl_tui.agents.exact.flips.flips import Flip, Turn

    return tuple(
        Flip(
            gamma=flip["gamma"],
            turns_the_way=flip["turns_the_way"],
            expected_return=tuple(flip["expected_return"]),
            turns=tuple(
                Turn(turn["state"], tuple(turn["before"]), tuple(turn["after"])) for turn in flip["turns"]
            ),
        )
        for flip in document
    )


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
