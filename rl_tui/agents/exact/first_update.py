"""The exact wait until an agent learns anything, and its cause.

While all estimates are equal, the behaviour of the agent is known: apart from exploring, it breaks
ties at random or takes the first action. Every episode therefore has the same chance to reach an
outcome that changes an estimate.
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


# Of a chance: what rounding may have left of it without a time limit
_RELATIVE_PRECISION: Final = 1e-9


@dataclass(frozen=True, slots=True)
class Wait:
    """How long the first update that tells anything lets people wait.

    ``chance`` is that of one episode. ``mean_episodes`` counts the episode itself: 1 at least; None where the
    chance is 0, or where an episode that tells nothing may go on for ever. ``median_episodes`` is the least
    number of episodes within which it is as likely as not; None where no number is enough.
    """

    chance: float
    mean_episodes: float | None
    median_episodes: int | None


def first_wait(mdp: TabularMDP, algorithm: str, hyperparameters: Hyperparameters, episode: int = 0) -> Wait:
    """Return how long nothing is learned by an agent whose estimates all equal ``initial_q``.

    An update tells something if it moves the estimate: where r + γ·Q·[not ended] differs from Q, in floats as
    the agent computes it, with the step size of ``episode`` (from 0) on. The last step of the time limit
    bootstraps as any other does; noise on a reward always tells something. The mean over next actions of
    Expected SARSA is Q here, as it is in numbers without rounding.

    Raises NoExactAnswer, with the reason, unless the agent updates one pair a step by one step, acts
    ε-greedily with a constant ε, and lives in a world that does not drift.
    """
    _check_known(mdp, algorithm, hyperparameters, episode)
    tells = telling_outcomes(mdp, hyperparameters, _step_size(hyperparameters, episode))
    return _known_waits(mdp)(tells.tobytes(), _first_policy(mdp, hyperparameters).tobytes())


@lru_cache(maxsize=1)  # no world is kept alive but the last one asked about
def _known_waits(mdp: TabularMDP) -> Callable[[bytes, bytes], Wait]:
    """Return :func:`_wait` in the world ``mdp``, which remembers some of its answers."""
    return lru_cache(maxsize=16)(partial(_wait, mdp))


def _wait(mdp: TabularMDP, telling: bytes, chances: bytes) -> Wait:
    """Return the wait for an outcome that tells something, [O], with the policy ``chances``, [P].

    Few settings change either of these arrays, a step size hardly ever: so waits are kept by their bytes.
    """
    tells, policy = np.frombuffer(telling, np.bool_), np.frombuffer(chances)
    stopped = replace(mdp, terminated=mdp.terminated | tells)
    return _limited(stopped, tells, policy) if mdp.time_limit else _unlimited(stopped, tells, policy)


def steps_to_tell(mdp: TabularMDP, tells: BoolArray) -> int | None:
    """Return the fewest steps, 1 or more, from the start to one of the outcomes ``tells``, [O].

    None where there is no such way, whatever is done and however many steps were allowed.
    """
    return _nearest(exact_model(mdp), tells, np.ones(mdp.pairs, dtype=np.bool_))


def telling_outcomes(mdp: TabularMDP, hyperparameters: Hyperparameters, alpha: float) -> BoolArray:
    """Return which outcomes, [O], move an estimate of ``initial_q`` by a step of size ``alpha``."""
    q = hyperparameters.initial_q
    error = mdp.reward + hyperparameters.gamma * np.where(mdp.terminated, 0.0, q) - q
    moves: BoolArray = (q + alpha * error != q) | ((mdp.reward_std > 0.0) & (alpha > 0.0))
    return moves


def _check_known(mdp: TabularMDP, algorithm: str, hyperparameters: Hyperparameters, episode: int) -> None:
    """Raise NoExactAnswer, saying why, where episodes are not all alike or their updates not known."""
    agent, policy = algorithm_of(algorithm), POLICY_BY_ID[hyperparameters.policy]
    if agent.planner:
        raise NoExactAnswer(f"{agent.name} plans with the model: it needs no luck to find a reward")
    if not agent.updates_own_pair:
        names = [each.name for each in BY_ID.values() if each.updates_own_pair]
        known = f"{', '.join(names[:-1])} and {names[-1]}"
        raise NoExactAnswer(f"{agent.name} does more than one update by one step; known for {known} only")
    if not policy.explores_by_epsilon:
        raise NoExactAnswer(f"the policy is {policy.name}; the wait is known for ε-greedy agents only")
    if hyperparameters.epsilon_schedule != "constant" and hyperparameters.epsilon_decay != 0.0:
        raise NoExactAnswer("ε changes from episode to episode; the wait is known for a constant ε only")
    if mdp.drift_std > 0.0:
        raise NoExactAnswer("the rewards of this world drift: no two episodes are alike")
    if hyperparameters.alpha_at(episode) and _falls_to_zero(hyperparameters):
        raise NoExactAnswer("α falls towards 0: episodes are not alike, and after some of them nothing moves")


def _falls_to_zero(hyperparameters: Hyperparameters) -> bool:
    values = hyperparameters
    is_scheduled = values.step_size_schedule != "constant" and not values.sample_average
    return is_scheduled and values.alpha_decay > 0.0 and values.alpha_min == 0.0


def _step_size(hyperparameters: Hyperparameters, episode: int) -> float:
    """Return α in ``episode``; the sample average takes the whole of the first target."""
    alpha = hyperparameters.alpha_at(episode)
    return 1.0 if alpha is None else alpha


def _first_policy(mdp: TabularMDP, hyperparameters: Hyperparameters) -> FloatArray:
    """Return what is done while all estimates are equal, [P]."""
    if hyperparameters.ties == "random":
        return uniform_policy(mdp)
    return softened(mdp, greedy_policy(mdp, np.zeros(mdp.pairs), "first"), hyperparameters.epsilon)


def _limited(stopped: TabularMDP, tells: BoolArray, policy: FloatArray) -> Wait:
    """Return the wait where episodes have a time limit: none goes on for ever."""
    nearest = _nearest(exact_model(stopped), tells, policy > 0.0)
    if nearest is None or nearest > stopped.time_limit:
        return Wait(0.0, None, None)
    if not _may_time_out_or_end(stopped, tells, policy > 0.0)[stopped.start_state].any():
        return Wait(1.0, 1.0, 1)
    values = policy_values(stopped, policy, stopped.time_limit, tells.astype(np.float64))
    chance = _representable(stopped.average_at_start(values))
    return Wait(chance, 1.0 / chance, _median(chance))


def _may_time_out_or_end(stopped: TabularMDP, tells: BoolArray, usable: BoolArray) -> BoolArray:
    """Return the states, [S], from which an episode may be over within the time limit and tell nothing."""
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
    """Return the wait where nothing cuts an episode off."""
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
        raise NoExactAnswer("without a time limit so small a chance cannot be told from rounding")
    if chain.always_ends():
        return Wait(chance, 1.0 / chance, _median(chance))
    another = max(0.0, chain.chance_of_ending() - chance)
    return Wait(chance, None, _median_of_those_that_end(chance, another))


def _nearest(model: ExactModel, tells: BoolArray, usable: BoolArray) -> int | None:
    """Return the fewest steps from the start to an outcome that tells, by ``usable`` pairs, [P]."""
    steps = _steps_before(model, tells, usable)[model.mdp.start_state]
    return int(steps[steps >= 0].min()) + 1 if (steps >= 0).any() else None


def _steps_before(model: ExactModel, tells: BoolArray, usable: BoolArray) -> IntArray:
    """Return in how few steps each state, [S+1], comes to one with an outcome that tells; −1: never."""
    telling = np.unique(model.pair_state[model.outcome_pair[tells & usable[model.outcome_pair]]])
    return model.steps_to(telling.tolist(), usable)


def _representable(chance: float) -> float:
    """Return ``chance``, at most 1. Raises NoExactAnswer where floats have no number so small."""
    if chance <= 0.0 or math.isinf(1.0 / chance):
        raise NoExactAnswer("the chance of an episode is above 0, but smaller than any number here")
    return min(1.0, chance)


def _median(chance: float) -> int:
    """Return the least n with 1 − (1 − chance)ⁿ ≥ ½, for a chance above 0."""
    return 1 if chance >= 0.5 else math.ceil(math.log(0.5) / math.log1p(-chance))


def _median_of_those_that_end(chance: float, another: float) -> int | None:
    """Return the median where an episode tells nothing, but ends, with probability ``another`` only.

    Within n episodes something was told with probability chance · (1 − anotherⁿ) / (1 − another).
    """
    if chance >= 0.5:
        return 1
    missing = 1.0 - (1.0 - another) / (2.0 * chance)
    return math.ceil(math.log(missing) / math.log(another)) if missing > 0.0 and another > 0.0 else None


# Its cause and remedies


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
