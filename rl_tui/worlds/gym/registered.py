"""Registered Gymnasium environments: creation, checks, and simulation without a transition table.

Results of reset and step are checked before an agent learns from them.
"""

from __future__ import annotations

import math
import threading
import warnings
import weakref
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rl_tui.common.findings import near, one_line, shown
from rl_tui.common.interrupts import is_interrupt
from rl_tui.common.limits import LARGEST_ARGUMENTS, LONGEST_TIME_LIMIT
from rl_tui.common.own_ids import OWN_IDS
from rl_tui.worlds.environment import EnvironmentFailedError, StepResult
from rl_tui.worlds.gym.bins import check_sizes, combinations
from rl_tui.worlds.gym.env_call import ENVIRONMENT_CALL
from rl_tui.worlds.gym.modules import registered_id
from rl_tui.worlds.gym.states import ProductNames, States, discrete_states
from rl_tui.worlds.gym.stepped_layout import action_names, grid_of, known_part_names
from rl_tui.worlds.mdp.space import all_pairs
from rl_tui.worlds.sections.schema import WorldRefusedError
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from gymnasium import Env

    from rl_tui.worlds.gym.bins import BinsSection


# Making an environment


LONGEST_REASON: Final = 200
SMALL: Final = ("gymnasium.envs.toy_text.", "gymnasium.envs.classic_control.")
# The warning filter is global to all threads
_MAKING: Final = threading.Lock()


def made(name: str, kwargs: Mapping[str, Any]) -> Env[Any, Any]:
    """Create an environment, silently.

    It gets the wrappers of its registration (the time limit), but not Gymnasium's checker, because results
    are checked here. From the first call on, Gymnasium's advice is silenced.

    Args:
        name: Registered id. ``module:ID`` first imports the module, if allowed.
        kwargs: Arguments of the environment.

    Raises:
        WorldRefusedError: The environment is not registered or cannot be made.
    """
    import gymnasium

    gymnasium.logger.min_level = gymnasium.logger.ERROR + 1
    name = registered_id(name)
    if name not in gymnasium.registry:
        known = (id_ for id_, spec in gymnasium.registry.items() if _may_serve(id_, spec.entry_point))
        expected = f"the id of a registered environment{near(name, known)}"
        raise WorldRefusedError(("id",), shown(name), expected)
    if size_of(kwargs) > LARGEST_ARGUMENTS:
        expected = f"at most {LARGEST_ARGUMENTS:,} characters and values in all"
        raise WorldRefusedError(("kwargs",), f"{size_of(kwargs):,} characters and values", expected)
    try:
        with ENVIRONMENT_CALL, _MAKING, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # a map without a start divides by zero; a later check reports that clearly
            with np.errstate(invalid="ignore", divide="ignore"):
                # the spec avoids a lookup by id, which warns about newer versions
                spec = gymnasium.registry[name]
                return gymnasium.make(spec, **{"disable_env_checker": True, **kwargs})
    except BaseException as error:  # a constructor may raise anything
        if is_interrupt(error):
            raise
        reason = reason_of(error)
        if kwargs:
            found = f"what makes {name} fail ({reason})"
            raise WorldRefusedError(("kwargs",), found, f"what {name} takes") from error
        found = f"{name}, which cannot be made ({reason})"
        raise WorldRefusedError(("id",), found, "one that can be made here") from error


@contextmanager
def looked_at(name: str, kwargs: Mapping[str, Any]) -> Iterator[Env[Any, Any]]:
    """Create an environment, yield it for inspection, and close it.

    Args:
        name: Registered id.
        kwargs: Arguments of the environment.

    Raises:
        WorldRefusedError: It cannot be made, or fails during inspection.
    """
    environment = made(name, kwargs)
    try:
        yield environment
    except WorldRefusedError:
        raise
    except BaseException as error:  # attributes may run the environment's code
        if is_interrupt(error):
            raise
        found = f"{name}, which cannot be read ({reason_of(error)})"
        raise WorldRefusedError(("id",), found, "one that tells its states and actions") from error
    finally:
        close(environment)


def close(environment: Env[Any, Any]) -> None:
    """Close `environment`, and ignore its errors."""
    try:
        with ENVIRONMENT_CALL:
            environment.close()
    except BaseException as error:  # errors on closing no longer matter
        if is_interrupt(error):
            raise


def size_of(arguments: Mapping[str, Any]) -> int:
    """Return the number of characters and values in `arguments`."""
    size = 0
    to_count: list[Any] = [arguments]
    while to_count:
        value = to_count.pop()
        if isinstance(value, Mapping):
            to_count += [*value, *value.values()]
        elif isinstance(value, list):
            to_count += value
        size += len(value) if isinstance(value, str) else 1
    return size


def _may_serve(id_: str, entry_point: object) -> bool:
    """Return True if an environment is worth suggesting, judged by its origin.

    Few of Gymnasium's own environments have discrete states and actions, or few real numbers.
    """
    entry = str(entry_point)
    if id_.startswith(OWN_IDS):
        return False
    return entry.startswith(SMALL) or not entry.startswith(("gymnasium.", "<"))


def reason_of(error: BaseException) -> str:
    """Return the error of an environment as one printable line of at most 200 characters."""
    name, text = type(error).__name__, text_of(error)
    return one_line(f"{name}: {text}" if text else name, LONGEST_REASON)


def text_of(thing: object) -> str:
    """Return the text of a foreign object, whose ``__str__`` may fail."""
    try:
        return str(thing)
    except Exception:
        return f"a {type(thing).__name__} that cannot be written"


def time_limit_of(environment: Env[Any, Any]) -> int:
    """Return the time limit of the environment's registration in steps; 0: none.

    Raises:
        WorldRefusedError: The limit is not a valid number of steps.
    """
    most_steps = environment.spec.max_episode_steps if environment.spec else None
    limit = 0 if most_steps is None else most_steps
    if not isinstance(limit, int) or isinstance(limit, bool) or not 0 <= limit <= LONGEST_TIME_LIMIT:
        expected = f"a whole number from 0 to {LONGEST_TIME_LIMIT:,}"
        raise WorldRefusedError(("kwargs", "max_episode_steps"), shown(limit), expected)
    return limit


# Checked results of reset and step


LONGEST_SHOWN: Final = 80
_VALUES: Final = 5


class UnsoundResultError(Exception):
    """A result of the wrong form. The message continues after the environment's name."""


def parts_of(result: Any) -> tuple[Any, ...]:
    """Return observation, reward, terminated, truncated and info.

    Raises:
        UnsoundResultError: The result has another form.
    """
    if not isinstance(result, tuple | list) or len(result) != _VALUES:
        found = f"{len(result)} values" if isinstance(result, tuple | list) else seen(result)
        raise UnsoundResultError(
            f"answered {found} to a step, which is not observation, reward, terminated, truncated and info"
        )
    return tuple(result)


def first_observation(result: Any) -> Any:
    """Return the observation in the result of a reset.

    Raises:
        UnsoundResultError: The result has another form.
    """
    if not isinstance(result, tuple | list) or len(result) != 2:
        raise UnsoundResultError(f"answered {seen(result)} to a reset, which is not observation and info")
    return result[0]


def reward_of(value: Any) -> float:
    """Return a reward as a float.

    Raises:
        UnsoundResultError: It is not a finite number.
    """
    if type(value) is float and math.isfinite(value):
        return value
    number = number_of(value)
    if not math.isfinite(number):
        raise UnsoundResultError(f"gave a reward of {seen(value)}, which is not a finite number")
    return number


def number_of(value: Any) -> float:
    """Return a value of an environment as a float, or NaN if it is not a number."""
    if isinstance(value, str | bytes | bytearray):
        return math.nan
    try:
        return float(_single(value))
    except Exception:  # float() of a foreign object may raise anything
        return math.nan


def truth_of(value: Any, what: str) -> bool:
    """Return a flag of an environment as a bool.

    Args:
        value: The flag.
        what: "terminated" or "truncated", for messages.

    Raises:
        UnsoundResultError: It is neither true nor false.
    """
    if value is True or value is False:
        return bool(value)
    single = _single(value)
    if isinstance(single, bool | int | float | np.bool_ | np.number) and single in (0, 1):
        return bool(single)
    raise UnsoundResultError(f"answered {what} = {seen(value)}, which is neither true nor false")


def seen(value: Any) -> str:
    """Return a value of an environment as a short, printable line."""
    text = repr(value) if isinstance(value, str) else text_of(value)
    return one_line(text, LONGEST_SHOWN)


def _single(value: Any) -> Any:
    """Return the element of an array of size 1. Python will soon refuse to convert such arrays."""
    return value.item() if isinstance(value, np.ndarray) and value.size == 1 else value


# Environments without a transition table


class SteppedEnvironment:
    """A simulated Gymnasium environment whose observations become states.

    It is closed when it is no longer referenced.
    """

    def __init__(self, name: str, environment: Env[Any, Any], states: States, first_action: int) -> None:
        self._name = name
        self._environment = environment
        self._state_of = states.state_of
        self._first_action = first_action
        weakref.finalize(self, close, environment)

    def reset(self, seed: int | None = None) -> int:
        """Start an episode and return its first state.

        Raises:
            EnvironmentFailedError: The environment failed.
        """
        try:
            with ENVIRONMENT_CALL:
                result = self._environment.reset(seed=seed)
            observation = first_observation(result)
        except BaseException as error:  # an environment may raise anything
            raise self._failure(error, "failed to start") from error
        return self._state(observation)

    def step(self, action: int) -> StepResult:
        """Take `action`. An episode that is both terminated and truncated counts as terminated.

        Raises:
            EnvironmentFailedError: The environment failed.
        """
        try:
            with ENVIRONMENT_CALL:
                result = self._environment.step(action + self._first_action)
            observation, reward, terminated, truncated, _ = parts_of(result)
            reward = reward_of(reward)
            terminated = truth_of(terminated, "terminated")
            truncated = truth_of(truncated, "truncated")
        except BaseException as error:  # an environment may raise anything
            raise self._failure(error, "failed in a step") from error
        return StepResult(self._state(observation), reward, terminated, truncated and not terminated)

    def _state(self, observation: Any) -> int:
        try:
            return self._state_of(observation)
        except Exception as error:  # a wrong observation may raise anything
            raise EnvironmentFailedError(
                f"{self._name} observed {seen(observation)}, which is not in its own space of observations"
            ) from error

    def _failure(self, error: BaseException, how: str) -> BaseException:
        """Return `error` as a failure of the environment, or ctrl+C unchanged."""
        if isinstance(error, UnsoundResultError):
            return EnvironmentFailedError(f"{self._name} {error}")
        if is_interrupt(error):
            return error
        return EnvironmentFailedError(f"{self._name} {how}: {reason_of(error)}")


def stepped_world(name: str, kwargs: Mapping[str, Any], bins: BinsSection | None = None) -> World:
    """Return the simulated world of a registered environment.

    Observations must be discrete: a number, or a tuple, dictionary or array of them. Each combination is a
    state.

    Args:
        name: Registered id.
        kwargs: Arguments of the environment.
        bins: Cuts a Box of real numbers into states; None: not a Box.

    Raises:
        WorldRefusedError: It cannot be made, is not discrete, or is too large.
    """
    with looked_at(name, kwargs) as environment:
        spaces = environment.observation_space, environment.action_space
        first_action, actions = _actions_of(name, environment)
        states = _states_of(name, environment, bins)
        check_sizes(name, combinations(states.sizes), actions, "bins" if bins else "id")
        names = action_names(environment.unwrapped, first_action, actions)
        known_names = known_part_names(environment.unwrapped, states.sizes)
        part_names = [given or part for given, part in zip(known_names, states.part_names, strict=True)]
        grid = grid_of(environment.unwrapped, states, actions, part_names)
        limit = time_limit_of(environment)

    def new_environment() -> SteppedEnvironment:
        try:
            environment = made(name, kwargs)
        except WorldRefusedError as refusal:
            raise EnvironmentFailedError(f"{name} cannot be made: {refusal.finding.found}") from refusal
        stepped = SteppedEnvironment(name, environment, states, first_action)
        if (environment.observation_space, environment.action_space) != spaces:
            raise EnvironmentFailedError(f"{name} was made with other spaces than the time before")
        return stepped

    return World(
        all_pairs(ProductNames(part_names), names, limit),
        grid,
        new_environment=new_environment,
    )


def _states_of(name: str, environment: Env[Any, Any], bins: BinsSection | None) -> States:
    from gymnasium.spaces import Box

    space = environment.observation_space
    if isinstance(space, Box):
        if bins is None:
            found = f"{name}, whose states are Box: {math.prod(space.shape)} real numbers"
            expected = "[gymnasium.bins] in a scenario file, which cuts them into states"
            raise WorldRefusedError(("id",), found, expected)
        return bins.states(name, space)
    if bins is not None:
        found = f"bins for {name}, whose states are {type(space).__name__}"
        raise WorldRefusedError(("bins",), found, "no bins: they cut a Box of real numbers")
    states = discrete_states(space)
    if states is None:
        found = f"{name}, whose states are {type(space).__name__}"
        raise WorldRefusedError(("id",), found, "states made of discrete parts")
    return states


def _actions_of(name: str, environment: Env[Any, Any]) -> tuple[int, int]:
    """Return the first action and the number of actions."""
    from gymnasium.spaces import Discrete

    space = environment.action_space
    if not isinstance(space, Discrete):
        found = f"{name}, whose actions are {type(space).__name__}"
        raise WorldRefusedError(("id",), found, "discrete actions")
    return int(space.start), int(space.n)
