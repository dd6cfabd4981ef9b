"""The exact wait until an agent learns anything, and its cause.

While all estimates are equal, every episode has the same chance to change one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import lru_cache, partial
from typing import Final

import numpy as np

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID, algorithm_of
from rl_tui.agents.exact.backward_induction import policy_values
from rl_tui.agents.exact.exact_model import ExactModel, exact_model
from rl_tui.agents.exact.policy_evaluation import NoExactAnswer, PolicyChain
from rl_tui.agents.exact.policy_figures import greedy_policy, softened, uniform_policy
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# The wait


# Relative rounding error of a chance without a time limit
_RELATIVE_PRECISION: Final = 1e-9


@dataclass(frozen=True, slots=True)
class Wait:
    """The wait for the first update that changes an estimate.

    Args:
        chance: Chance of one episode.
        mean_episodes: Counts the successful one. None if it may never come.
        median_episodes: Smallest number with a chance of at least one half, or None.
    """

    chance: float
    mean_episodes: float | None
    median_episodes: int | None


def first_wait(mdp: TabularMDP, algorithm: str, hyperparameters: Hyperparameters, episode: int = 0) -> Wait:
    """Compute how long an agent learns nothing while all its estimates equal ``initial_q``.

    An outcome changes an estimate if r + γ · Q · [not ended] differs from Q, in floats. The last step before
    the time limit bootstraps like any other. Noisy rewards always count. `episode` counts from 0.

    Raises:
        NoExactAnswer: The agent does not update exactly one pair per step, its policy is not ε-greedy with
            constant ε, or the world drifts.
    """
    _check_known(mdp, algorithm, hyperparameters, episode)
    tells = telling_outcomes(mdp, hyperparameters, _step_size(hyperparameters, episode))
    return _known_waits(mdp)(tells.tobytes(), _first_policy(mdp, hyperparameters).tobytes())


@lru_cache(maxsize=1)  # keeps only the latest world in memory
def _known_waits(mdp: TabularMDP) -> Callable[[bytes, bytes], Wait]:
    return lru_cache(maxsize=16)(partial(_wait, mdp))


def _wait(mdp: TabularMDP, telling: bytes, chances: bytes) -> Wait:
    # Telling outcomes, [O], and policy, [P], are bytes for the cache
    tells, policy = np.frombuffer(telling, np.bool_), np.frombuffer(chances)
    stopped = replace(mdp, terminated=mdp.terminated | tells)
    return _limited(stopped, tells, policy) if mdp.time_limit else _unlimited(stopped, tells, policy)


def steps_to_tell(mdp: TabularMDP, tells: BoolArray) -> int | None:
    """Return the fewest steps to an outcome in `tells`, [O], without a time limit, or None."""
    return _nearest(exact_model(mdp), tells, np.ones(mdp.pairs, dtype=np.bool_))


def telling_outcomes(mdp: TabularMDP, hyperparameters: Hyperparameters, alpha: float) -> BoolArray:
    """Return the outcomes, [O], that change an estimate of ``initial_q``."""
    q = hyperparameters.initial_q
    error = mdp.reward + hyperparameters.gamma * np.where(mdp.terminated, 0.0, q) - q
    moves: BoolArray = (q + alpha * error != q) | ((mdp.reward_std > 0.0) & (alpha > 0.0))
    return moves


def _check_known(mdp: TabularMDP, algorithm: str, hyperparameters: Hyperparameters, episode: int) -> None:
    agent, policy = algorithm_of(algorithm), POLICY_BY_ID[hyperparameters.policy]
    if agent.planner:
        raise NoExactAnswer(f"{agent.name} plans with the model, so it does not wait for a first reward")
    if not agent.updates_own_pair:
        names = [each.name for each in BY_ID.values() if each.updates_own_pair]
        known = f"{', '.join(names[:-1])} and {names[-1]}"
        raise NoExactAnswer(
            f"{agent.name} does not update one pair per step; the wait is known only for {known}"
        )
    if not policy.explores_by_epsilon:
        raise NoExactAnswer(f"the policy is {policy.name}; the wait is known only for ε-greedy agents")
    if hyperparameters.epsilon_schedule != "constant" and hyperparameters.epsilon_decay != 0.0:
        raise NoExactAnswer("ε changes between episodes; the wait is known only for a constant ε")
    if mdp.drift_std > 0.0:
        raise NoExactAnswer("the rewards of this world drift, so episodes differ")
    if hyperparameters.alpha_at(episode) and _falls_to_zero(hyperparameters):
        raise NoExactAnswer("α falls towards 0, so late episodes change nothing")


def _falls_to_zero(hyperparameters: Hyperparameters) -> bool:
    values = hyperparameters
    is_scheduled = values.step_size_schedule != "constant" and not values.sample_average
    return is_scheduled and values.alpha_decay > 0.0 and values.alpha_min == 0.0


def _step_size(hyperparameters: Hyperparameters, episode: int) -> float:
    # The sample average takes the first target completely
    alpha = hyperparameters.alpha_at(episode)
    return 1.0 if alpha is None else alpha


def _first_policy(mdp: TabularMDP, hyperparameters: Hyperparameters) -> FloatArray:
    if hyperparameters.ties == "random":
        return uniform_policy(mdp)
    return softened(mdp, greedy_policy(mdp, np.zeros(mdp.pairs), "first"), hyperparameters.epsilon)


def _limited(stopped: TabularMDP, tells: BoolArray, policy: FloatArray) -> Wait:
    nearest = _nearest(exact_model(stopped), tells, policy > 0.0)
    if nearest is None or nearest > stopped.time_limit:
        return Wait(0.0, None, None)
    if not _may_time_out_or_end(stopped, tells, policy > 0.0)[stopped.start_state].any():
        return Wait(1.0, 1.0, 1)
    values = policy_values(stopped, policy, stopped.time_limit, tells.astype(np.float64))
    chance = _representable(stopped.average_at_start(values))
    return Wait(chance, 1.0 / chance, _median(chance))


def _may_time_out_or_end(stopped: TabularMDP, tells: BoolArray, usable: BoolArray) -> BoolArray:
    # [S]: without a telling outcome
    silent = ~tells & usable[stopped.outcome_pair]
    source = stopped.pair_state[stopped.outcome_pair][silent]
    ends, target = stopped.terminated[silent], stopped.next_state[silent]
    may = np.ones(stopped.states, dtype=np.bool_)
    for _ in range(stopped.time_limit):
        later = may
        may = np.zeros(stopped.states, dtype=np.bool_)
        may[source[ends | later[target]]] = True
        if np.array_equal(may, later):
            break
    return may


def _unlimited(stopped: TabularMDP, tells: BoolArray, policy: FloatArray) -> Wait:
    model, usable, start = exact_model(stopped), policy > 0.0, stopped.start_state
    can_tell = _steps_before(model, tells, usable) >= 0
    if not can_tell[start].any():
        return Wait(0.0, None, None)
    silent_end = stopped.terminated & ~tells & usable[model.outcome_pair]
    lost = ~can_tell
    lost[model.pair_state[model.outcome_pair[silent_end]]] = True
    lost[model.end] = False
    if not (model.steps_to(np.flatnonzero(lost), usable) >= 0)[start].any():
        return Wait(1.0, 1.0, 1)
    chances = np.zeros(model.end + 1, dtype=np.longdouble)
    chain = PolicyChain(model, policy)
    error = chain.solve(1.0, can_tell, chances, tells.astype(np.longdouble))
    chance = _representable(stopped.average_at_start(chances))
    if error > _RELATIVE_PRECISION * chance:
        raise NoExactAnswer("the chance is too small to compute without a time limit")
    if chain.always_ends():
        return Wait(chance, 1.0 / chance, _median(chance))
    another = max(0.0, chain.chance_of_ending() - chance)
    return Wait(chance, None, _median_of_those_that_end(chance, another))


def _nearest(model: ExactModel, tells: BoolArray, usable: BoolArray) -> int | None:
    steps = _steps_before(model, tells, usable)[model.mdp.start_state]
    return int(steps[steps >= 0].min()) + 1 if (steps >= 0).any() else None


def _steps_before(model: ExactModel, tells: BoolArray, usable: BoolArray) -> IntArray:
    # Steps from each state, [S+1], to a telling outcome, or −1
    telling = np.unique(model.pair_state[model.outcome_pair[tells & usable[model.outcome_pair]]])
    return model.steps_to(telling.tolist(), usable)


def _representable(chance: float) -> float:
    if chance <= 0.0 or math.isinf(1.0 / chance):
        raise NoExactAnswer("the chance per episode is above 0, but too small for a number")
    return min(1.0, chance)


def _median(chance: float) -> int:
    # The smallest n with 1 − (1 − chance)ⁿ ≥ ½
    return 1 if chance >= 0.5 else math.ceil(math.log(0.5) / math.log1p(-chance))


def _median_of_those_that_end(chance: float, another: float) -> int | None:
    # `another` is the probability that an episode ends without a telling outcome
    if chance >= 0.5:
        return 1
    missing = 1.0 - (1.0 - another) / (2.0 * chance)
    return math.ceil(math.log(missing) / math.log(another)) if missing > 0.0 and another > 0.0 else None


# Its cause and remedies


# Largest ratio of new to old wait for a remedy
_WORTH_SAYING: Final = 0.5
# Largest ratio for a setting to count as the cause
_CAUSES: Final = 0.1
_EPSILONS: Final = (0.1, 0.3, 0.5, 1.0)
_OPTIMISTIC: Final = (1.0, 10.0)
_USUAL_ALPHA: Final = Hyperparameters().alpha


class Cause(StrEnum):
    """A proven cause of the wait."""

    ALPHA = "alpha"  # the step size changes nothing
    NO_REWARD = "no-reward"  # no reachable outcome changes an estimate
    TIME_LIMIT = "time-limit"  # the nearest one is beyond the time limit
    TIES = "ties"  # random ties would cut the wait to a tenth
    EPSILON = "epsilon"  # another ε would cut the wait to a tenth


@dataclass(frozen=True, slots=True)
class Remedy:
    """A changed setting, and the resulting wait."""

    setting: str
    value: float | str
    wait: Wait


@dataclass(frozen=True, slots=True)
class FirstUpdate:
    """The wait for the first update, its cause and remedies.

    Args:
        cause: None without proof.
        distance: Fewest steps to an outcome that changes an estimate, without a time limit, or None.
        remedies: Changes that at least halve the mean wait, best first.
    """

    wait: Wait
    cause: Cause | None
    distance: int | None
    remedies: tuple[Remedy, ...]


def first_update(
    mdp: TabularMDP, algorithm: str, hyperparameters: Hyperparameters, episode: int = 0
) -> FirstUpdate:
    """Compute the wait from `episode` (from 0) on, its cause and remedies.

    Raises:
        NoExactAnswer: The wait is unknown; see :func:`first_wait`.
    """
    wait = first_wait(mdp, algorithm, hyperparameters, episode)
    # With the largest step size, because the agent's own may change nothing
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
    if not hyperparameters.sample_average:
        yield [("step_size_schedule", "constant")]
        yield [("alpha", _USUAL_ALPHA)]
    if hyperparameters.ties == "first":
        # while all estimates are equal, ε matters only without random ties
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
