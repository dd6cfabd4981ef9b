"""Registered Gymnasium environments: creation, checked results, and simulation."""

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
    are checked here. ``module:ID`` first imports the module. From now on, Gymnasium's advice is silenced.

    Raises:
        WorldRefusedError: The environment is not registered or cannot be made.
    """
    import gymnasium

    gymnasium.logger.min_level = gymnasium.logger.ERROR + 1
    name = registered_id(name)
    if name not in gymnasium.registry:
        known = (id_ for id_, spec in gymnasium.registry.items() if _may_serve(id_, spec.entry_point))
        found = f"no environment is registered as {shown(name)}; choose another{near(name, known)}"
        raise WorldRefusedError(("id",), found)
    if size_of(kwargs) > LARGEST_ARGUMENTS:
        expected = f"at most {LARGEST_ARGUMENTS:,} characters and values in total"
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
            found = f"{name} cannot be created with these arguments ({reason}); correct them"
            raise WorldRefusedError(("kwargs",), found) from error
        found = f"{name} cannot be created here ({reason}); choose another environment"
        raise WorldRefusedError(("id",), found) from error


@contextmanager
def looked_at(name: str, kwargs: Mapping[str, Any]) -> Iterator[Env[Any, Any]]:
    """Create an environment, yield it for inspection, and close it.

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
        found = f"{name} does not declare its states and actions ({reason_of(error)})"
        raise WorldRefusedError(("id",), f"{found}; choose another environment") from error
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
    # Judged by its origin
    entry = str(entry_point)
    if id_.startswith(OWN_IDS):
        return False
    return entry.startswith(SMALL) or not entry.startswith(("gymnasium.", "<"))


def reason_of(error: BaseException) -> str:
    """Return an error as one printable line of at most 200 characters."""
    name, text = type(error).__name__, text_of(error)
    return one_line(f"{name}: {text}" if text else name, LONGEST_REASON)


def text_of(thing: object) -> str:
    """Return the text of a foreign object, whose ``__str__`` may fail."""
    try:
        return str(thing)
    except Exception:
        return f"a {type(thing).__name__} without readable text"


def time_limit_of(environment: Env[Any, Any]) -> int:
    """Return the registered time limit in steps (0: none), or raise WorldRefusedError."""
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
    """Return observation, reward, terminated, truncated and info, or raise UnsoundResultError."""
    if not isinstance(result, tuple | list) or len(result) != _VALUES:
        found = f"{len(result)} values" if isinstance(result, tuple | list) else seen(result)
        raise UnsoundResultError(
            f"returned {found} from step instead of observation, reward, terminated, truncated and info"
        )
    return tuple(result)


def first_observation(result: Any) -> Any:
    """Return the observation of a reset, or raise UnsoundResultError."""
    if not isinstance(result, tuple | list) or len(result) != 2:
        raise UnsoundResultError(f"returned {seen(result)} from reset instead of observation and info")
    return result[0]


def reward_of(value: Any) -> float:
    """Return a finite reward, or raise UnsoundResultError."""
    if type(value) is float and math.isfinite(value):
        return value
    number = number_of(value)
    if not math.isfinite(number):
        raise UnsoundResultError(f"returned the reward {seen(value)} instead of a finite number")
    return number


def number_of(value: Any) -> float:
    """Return a number as a float, else NaN."""
    if isinstance(value, str | bytes | bytearray):
        return math.nan
    try:
        return float(_single(value))
    except Exception:  # float() of a foreign object may raise anything
        return math.nan


def truth_of(value: Any, what: str) -> bool:
    """Return the flag `what` as a bool, or raise UnsoundResultError."""
    if value is True or value is False:
        return bool(value)
    single = _single(value)
    if isinstance(single, bool | int | float | np.bool_ | np.number) and single in (0, 1):
        return bool(single)
    raise UnsoundResultError(f"returned {what} = {seen(value)} instead of true or false")


def seen(value: Any) -> str:
    """Return a value as a short, printable line."""
    text = repr(value) if isinstance(value, str) else text_of(value)
    return one_line(text, LONGEST_SHOWN)


def _single(value: Any) -> Any:
    # Python will soon refuse to convert arrays of size 1
    return value.item() if isinstance(value, np.ndarray) and value.size == 1 else value


# Environments without a transition table


class SteppedEnvironment:
    """A simulated Gymnasium environment, which is closed when it is no longer referenced."""

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
        """Take `action`. An episode both terminated and truncated counts as terminated.

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
                f"{self._name} returned the observation {seen(observation)}, which is outside its "
                "observation space"
            ) from error

    def _failure(self, error: BaseException, how: str) -> BaseException:
        # ctrl+C is passed on
        if isinstance(error, UnsoundResultError):
            return EnvironmentFailedError(f"{self._name} {error}")
        if is_interrupt(error):
            return error
        return EnvironmentFailedError(f"{self._name} {how}: {reason_of(error)}")


def stepped_world(name: str, kwargs: Mapping[str, Any], bins: BinsSection | None = None) -> World:
    """Return the simulated world of a registered environment.

    Each combination of its discrete observations is a state. `bins` cut a Box of real numbers.

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
            raise EnvironmentFailedError(refusal.finding.found) from refusal
        stepped = SteppedEnvironment(name, environment, states, first_action)
        if (environment.observation_space, environment.action_space) != spaces:
            raise EnvironmentFailedError(f"{name} changed its spaces since it was first created")
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
            found = f"{name} returns {math.prod(space.shape)} real numbers (a Box), not numbered states"
            fix = "write a scenario file with [gymnasium.bins], which turns them into states"
            raise WorldRefusedError(("id",), f"{found}; {fix}")
        return bins.states(name, space)
    if bins is not None:
        found = f"bins divide a Box, but the states of {name} are {type(space).__name__}; leave out bins"
        raise WorldRefusedError(("bins",), found)
    states = discrete_states(space)
    if states is None:
        found = f"the states of {name} are {type(space).__name__}; choose one with discrete states"
        raise WorldRefusedError(("id",), found)
    return states


def _actions_of(name: str, environment: Env[Any, Any]) -> tuple[int, int]:
    from gymnasium.spaces import Discrete

    space = environment.action_space
    if not isinstance(space, Discrete):
        found = f"the actions of {name} are {type(space).__name__}; choose one with discrete actions"
        raise WorldRefusedError(("id",), found)
    return int(space.start), int(space.n)
