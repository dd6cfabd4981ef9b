"""Gymnasium environments without a transition table: stepped for real, one step at a time."""

from __future__ import annotations

import math
import weakref
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from rl_tui.common.interrupts import is_interrupt
from rl_tui.worlds.environment import EnvironmentFailedError, StepResult
from rl_tui.worlds.gym.env_call import ENVIRONMENT_CALL
from rl_tui.worlds.gym.env_result import (
    UnsoundResultError,
    first_observation,
    parts_of,
    reward_of,
    seen,
    truth_of,
)
from rl_tui.worlds.gym.registered import close, looked_at, made, reason_of, time_limit_of
from rl_tui.worlds.gym.sizes import check_sizes, combinations
from rl_tui.worlds.gym.stepped.layout import action_names, known_part_names, part_terms, product_grid
from rl_tui.worlds.gym.stepped.states import ProductNames, States, discrete_states
from rl_tui.worlds.mdp.space import all_pairs
from rl_tui.worlds.sections.world_section import WorldRefusedError
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from gymnasium import Env

    from rl_tui.worlds.gym.stepped.bins import BinsSection


class SteppedEnvironment:
    """One Gymnasium environment, its observations made states; closed when it is no longer referenced."""

    def __init__(self, name: str, environment: Env[Any, Any], states: States, first_action: int) -> None:
        self._name = name
        self._environment = environment
        self._state_of = states.state_of
        self._first_action = first_action
        weakref.finalize(self, close, environment)

    def reset(self, seed: int | None = None) -> int:
        """Begin an episode and return its first state."""
        try:
            with ENVIRONMENT_CALL:
                result = self._environment.reset(seed=seed)
            observation = first_observation(result)
        except BaseException as error:  # an environment may raise anything
            raise self._failure(error, "failed to start") from error
        return self._state(observation)

    def step(self, action: int) -> StepResult:
        """Take ``action``; an episode that is both terminated and truncated is terminated."""
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
        """Return ``error`` as a failure of the environment, or ``error`` itself if it is ctrl+C."""
        if isinstance(error, UnsoundResultError):
            return EnvironmentFailedError(f"{self._name} {error}")
        if is_interrupt(error):
            return error
        return EnvironmentFailedError(f"{self._name} {how}: {reason_of(error)}")


def stepped_world(name: str, kwargs: Mapping[str, Any], bins: BinsSection | None = None) -> World:
    """Return the world of the registered environment ``name``, to be stepped.

    Observations have to be discrete: one number, or a tuple, dictionary or array of them, of which every
    combination is a state. ``bins`` cuts a Box of real numbers into states. Raises WorldRefusedError where
    the environment cannot be made, its observations or actions are of another kind, or they are too many.
    """
    with looked_at(name, kwargs) as environment:
        spaces = environment.observation_space, environment.action_space
        first_action, actions = _actions_of(name, environment)
        states = _states_of(name, environment, bins)
        check_sizes(name, combinations(states.sizes), actions, "bins" if bins else "id")
        names = action_names(environment.unwrapped, first_action, actions)
        known_names = known_part_names(environment.unwrapped, states.sizes)
        terms = part_terms(environment.unwrapped)
        limit = time_limit_of(environment)
    part_names = [given or part for given, part in zip(known_names, states.part_names, strict=True)]

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
        product_grid(states.sizes, actions, terms),
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
    """Return the first action and how many there are."""
    from gymnasium.spaces import Discrete

    space = environment.action_space
    if not isinstance(space, Discrete):
        found = f"{name}, whose actions are {type(space).__name__}"
        raise WorldRefusedError(("id",), found, "discrete actions")
    return int(space.start), int(space.n)
