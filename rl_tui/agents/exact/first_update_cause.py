"""Why nothing is learned for so long, and what would change it, by comparing exact waits."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from rl_tui.agents.exact.first_update import Wait, first_wait, steps_to_tell, telling_outcomes
from rl_tui.agents.exact.solution import NoExactAnswer
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# A remedy makes the wait at most so many times as long as it is
_WORTH_SAYING: Final = 0.5
# A setting is the cause if another value of it alone does that
_CAUSES: Final = 0.1
_EPSILONS: Final = (0.1, 0.3, 0.5, 1.0)
_OPTIMISTIC: Final = (1.0, 10.0)
_USUAL_ALPHA: Final = Hyperparameters().alpha


class Cause(StrEnum):
    """What is to blame, where it can be proved."""

    ALPHA = "alpha"  # the step size moves nothing
    NO_REWARD = "no-reward"  # no outcome that can be reached tells anything
    TIME_LIMIT = "time-limit"  # the nearest that does is further than an episode is long
    TIES = "ties"  # random ties alone would make the wait a tenth, or less
    EPSILON = "epsilon"  # another ε alone would


@dataclass(frozen=True, slots=True)
class Remedy:
    """The hyper-parameter ``setting`` at ``value``, all else as it is, and the wait that comes of it."""

    setting: str
    value: float | str
    wait: Wait


@dataclass(frozen=True, slots=True)
class FirstUpdate:
    """How long nothing is learned, why, and what would help.

    ``cause`` is None where no single setting can be proved to be it. ``distance`` is the fewest steps from
    the start to an outcome that tells anything, by any actions and without a time limit; None where there is
    none. ``remedies`` at least halve the mean wait; the shortest comes first.
    """

    wait: Wait
    cause: Cause | None
    distance: int | None
    remedies: tuple[Remedy, ...]


def first_update(
    mdp: TabularMDP, algorithm: str, hyperparameters: Hyperparameters, episode: int = 0
) -> FirstUpdate:
    """Return the wait of :func:`~rl_tui.agents.exact.first_update.first_wait`, its cause and remedies.

    ``episode``, from 0, is the one that comes next. Raises NoExactAnswer where that does.
    """
    wait = first_wait(mdp, algorithm, hyperparameters, episode)
    # By the largest step size: that of the agent may be what moves nothing
    distance = steps_to_tell(mdp, telling_outcomes(mdp, hyperparameters, 1.0))
    if wait.chance == 1.0:
        return FirstUpdate(wait, None, distance, ())
    remedies = [
        remedy
        for values in _candidates(hyperparameters)
        if (remedy := _best_of(mdp, algorithm, hyperparameters, episode, values)) is not None
        and _mean(remedy.wait) <= _WORTH_SAYING * _mean(wait)
    ]
    remedies.sort(key=lambda remedy: _mean(remedy.wait))
    return FirstUpdate(wait, _cause(mdp, wait, distance, remedies), distance, tuple(remedies))


def _candidates(hyperparameters: Hyperparameters) -> Iterator[Sequence[tuple[str, float | str]]]:
    """Yield values to try in place of those in force, those of one setting at a time."""
    if not hyperparameters.sample_average:
        yield [("step_size_schedule", "constant")]
        yield [("alpha", _USUAL_ALPHA)]
    if hyperparameters.ties == "first":
        # while all is equal, ε counts only where ties are not random
        yield [("ties", "random")]
        yield [("epsilon", epsilon) for epsilon in _EPSILONS]
    yield [("initial_q", value) for value in _OPTIMISTIC]


def _best_of(
    mdp: TabularMDP,
    algorithm: str,
    hyperparameters: Hyperparameters,
    episode: int,
    values: Sequence[tuple[str, float | str]],
) -> Remedy | None:
    """Return the value with the shortest wait, the first of several; None where no wait is known."""
    best = None
    for setting, value in values:
        changed = hyperparameters.changed(setting, value)
        try:
            remedy = Remedy(setting, value, first_wait(mdp, algorithm, changed, episode))
        except NoExactAnswer:
            continue
        if remedy.wait.mean_episodes and (best is None or _mean(remedy.wait) < _mean(best.wait)):
            best = remedy
    return best


def _cause(mdp: TabularMDP, wait: Wait, distance: int | None, remedies: Sequence[Remedy]) -> Cause | None:
    if distance is None:
        return Cause.NO_REWARD
    if mdp.time_limit and distance > mdp.time_limit:
        return Cause.TIME_LIMIT
    blamed = {remedy.setting for remedy in remedies if _mean(remedy.wait) <= _CAUSES * _mean(wait)}
    if not blamed.isdisjoint(("alpha", "step_size_schedule")):
        return Cause.ALPHA
    return next((cause for cause in (Cause.TIES, Cause.EPSILON) if cause.value in blamed), None)


def _mean(wait: Wait) -> float:
    return math.inf if wait.mean_episodes is None else wait.mean_episodes
