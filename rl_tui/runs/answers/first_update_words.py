"""Texts about the wait for the first update."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from rl_tui.agents.exact.first_update import Cause, FirstUpdate, Wait
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters
from rl_tui.common.words import counted

NOTHING_IN_THE_WAY: Final = "no obstacle: the first episode already changes an estimate"
CHANCE_OF: Final = "the first update has probability "
_WHOLE_FROM: Final = 1_000
_SHORT_FROM: Final = 10**12
Writer = Callable[[float], str]


def episodes_in_words(number: float) -> str:
    """Format a number of episodes: `71.7`, `184,616`, `6.23e15`."""
    if number >= _SHORT_FROM:
        return f"{number:.3g}".replace("e+", "e")
    return f"{number:,.0f}" if number >= _WHOLE_FROM or number == int(number) else f"{number:.1f}"


def number_in_words(number: float) -> str:
    """Format a setting or a probability: `1`, `0.0139398`, `5.41665e-6`."""
    mantissa, e, exponent = f"{number:.6g}".partition("e")
    return f"{mantissa}e{int(exponent)}" if e else mantissa


def wait_in_words(wait: Wait, in_words: Writer = number_in_words) -> str:
    """Say how many episodes the first update takes. `in_words` formats its probability."""
    if wait.chance == 1.0:
        return NOTHING_IN_THE_WAY
    if wait.chance == 0.0:
        return "no episode ever changes an estimate"
    chance = f"{CHANCE_OF}{in_words(wait.chance)} per episode"
    if wait.mean_episodes is None:
        return f"{chance}; an episode without it may never end, so there is no mean wait"
    assert wait.median_episodes is not None
    mean, median = map(episodes_in_words, (wait.mean_episodes, wait.median_episodes))
    return f"{chance}: it takes {mean} episodes on average, {median} or fewer in half of all runs"


def cause_in_words(
    answer: FirstUpdate, settings: Hyperparameters, time_limit: int, in_words: Writer = number_in_words
) -> str:
    """Name the setting that delays the first update, or why none is to blame, or ""."""
    if answer.wait.chance == 1.0:
        return ""
    match answer.cause:
        case Cause.ALPHA:
            return "the step size α is so small that no update changes an estimate"
        case Cause.NO_REWARD:
            return "no reachable outcome differs from the initial estimates"
        case Cause.TIME_LIMIT:
            return f"{_nearest(answer)}, but an episode ends after {counted(time_limit, 'step')}"
        case Cause.TIES:
            often = "seldom" if settings.epsilon else "never"
            others = f"with ε {in_words(settings.epsilon)} it {often} takes another"
            return f"with ties = first, the agent takes the first of equal actions; {others}"
        case Cause.EPSILON:
            return f"ε is {in_words(settings.epsilon)}: another ε cuts the wait to a tenth or less"
        case None:
            walk = ", and ties are broken at random on the way" if settings.ties == "random" else ""
            return f"no single setting is to blame: {_nearest(answer)}{walk}"


def setting_in_words(setting: str, value: float | str, in_words: Writer = number_in_words) -> str:
    """Format a setting with its symbol: `ε 1`, `ties random`."""
    number = value if isinstance(value, str) else in_words(value)
    return f"{PARAMETERS[setting].symbol} {number}"


def _nearest(answer: FirstUpdate) -> str:
    assert answer.distance is not None
    return f"the nearest outcome that changes an estimate is {counted(answer.distance, 'step')} away"
