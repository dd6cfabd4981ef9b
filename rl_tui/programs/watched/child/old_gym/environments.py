"""Environments with the methods and attributes of the old Gym."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import FrameType
from typing import Any, Final

import gymnasium
import numpy as np

from rl_tui.programs.watched.child.environments.watched_env import in_new_form, is_with_information
from rl_tui.programs.watched.child.errors import is_users_file
from rl_tui.programs.watched.child.old_gym.call_form import NEW, reset_result, step_result
from rl_tui.programs.watched.child.stand_ins import Nothing

_PICTURE: Final = (64, 64, 3)
_WITH_EPISODES: Final = "gymnasium.envs.toy_text."
"""Package of environments whose first episode began when they were made."""
_STATES: Final = ("s", "player")
"""Attributes of which each of these environments has one after its first reset."""
_OF_AN_EPISODE: Final = (*_STATES, "lastaction", "dealer")
HandOut = Callable[[gymnasium.Env[Any, Any]], None]


def answer(frame: FrameType, method: str, result: Any) -> Any:
    """Return a result as the user's call expects it."""
    if type(result) is not tuple or not is_users_file(frame.f_code.co_filename):
        return result
    if method == "step":
        return step_result(frame, result) if len(result) == NEW else result
    return reset_result(frame, result) if is_with_information(result) else result


def render(env: Any, mode: str = "human", **_: Any) -> Any:
    """Return no picture, because rl-tui shows the world."""
    del env
    return {"rgb_array": np.zeros(_PICTURE, np.uint8), "ansi": ""}.get(mode)


def seed(env: Any, number: int | None = None) -> list[int]:
    """Seed the random numbers."""
    env.np_random = gymnasium.utils.seeding.np_random(number)[0]
    return [number or 0]


def _missing_attribute(env: Any, name: str) -> Any:
    if name in ("nS", "nA"):
        space = env.observation_space if name == "nS" else env.action_space
        return int(space.n)
    if name == "isd":
        return env.initial_state_distrib
    if name in _OF_AN_EPISODE:
        kinds: list[Any] = [each for each in type(env).__mro__ if each.__module__.startswith(_WITH_EPISODES)]
        if kinds and not any(each in env.__dict__ for each in _STATES):
            kinds[-1].reset(env)
        if kinds and name in env.__dict__:
            return env.__dict__[name]
    if name == "monitor":
        return Nothing()
    raise AttributeError(f"{type(env).__name__!r} object has no attribute {name!r}")


INNER_METHODS: Final = {"render": render, "seed": seed, "__getattr__": _missing_attribute}


class OldEnv(gymnasium.Wrapper):  # type: ignore[misc]
    """An environment of the old `gym.make`. `hand_out` gets what is inside."""

    def __init__(self, env: gymnasium.Env[Any, Any], hand_out: HandOut) -> None:
        self._held = env
        super().__init__(env)
        self._hand_out = hand_out
        self._given_seed: int | None = None

    def step(self, action: Any) -> Any:
        """Take a step."""
        return answer(sys._getframe(1), "step", self._held.step(action))

    def reset(self, **more: Any) -> Any:
        """Begin an episode, with the seed given to `seed`."""
        more.pop("return_info", None)
        if more.get("seed") is None:
            more["seed"], self._given_seed = self._given_seed, None
        return answer(sys._getframe(1), "reset", self._held.reset(**more))

    def seed(self, number: int | None = None) -> list[int]:
        """Seed the next episode, and an environment that has not drawn any number yet."""
        self._given_seed = number
        inside = self._held.unwrapped
        if number is not None and getattr(inside, "_np_random", self) is None:
            seed(inside, number)
        return [number or 0]

    def render(self, mode: str = "human", **_: Any) -> Any:
        """Return a black picture or no text."""
        return render(self, mode)

    def close(self) -> None:
        """Do nothing, because the old Gym allowed further steps."""

    @property
    def env(self) -> Any:
        """The unwrapped environment, as in the old Gym."""
        return self._inside(self._held)

    @env.setter
    def env(self, env: Any) -> None:
        self._held = env

    @property
    def unwrapped(self) -> Any:
        """The environment without wrappers."""
        return self._inside(self._held.unwrapped)

    def _inside(self, seen_by_libraries: Any) -> Any:
        if not is_users_file(sys._getframe(2).f_code.co_filename):
            return seen_by_libraries
        bare = self._held.unwrapped
        self._hand_out(bare)
        return bare

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name == "_held":
            raise AttributeError(name)
        held = self._held
        try:
            return getattr(held.unwrapped, name)
        except AttributeError:
            return _missing_attribute(held.unwrapped, name)


def old_wrapper(base: Any) -> Any:
    """Return Gymnasium's wrapper in the old form."""

    def step(env: Any, action: Any) -> Any:
        return answer(sys._getframe(1), "step", base.step(env, action))

    def reset(env: Any, **more: Any) -> Any:
        return answer(sys._getframe(1), "reset", base.reset(env, **more))

    def attribute(env: Any, name: str) -> Any:
        if name.startswith("__") or name == "env":
            raise AttributeError(name)
        return getattr(env.env, name)

    methods = {"step": step, "reset": reset, "__getattr__": attribute, "__module__": base.__module__}
    return type(base.__name__, (base,), methods)


class NewForm(gymnasium.Env):  # type: ignore[misc]
    """A user's environment in the form that Gymnasium's wrappers expect."""

    def __init__(self, env: Any) -> None:
        self._user_env = env
        self.action_space, self.observation_space = env.action_space, getattr(env, "observation_space", None)

    @property
    def unwrapped(self) -> Any:
        """The user's environment."""
        return self._user_env

    @property
    def spec(self) -> Any:
        """The specification that `make` has given."""
        return getattr(self._user_env, "spec", None)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        """Begin an episode."""
        if seed is not None and hasattr(self._user_env, "seed"):
            self._user_env.seed(seed)
        try:
            found = self._user_env.reset(seed=seed, options=options)
        except TypeError:
            found = self._user_env.reset()
        return found if is_with_information(found) else (found, {})

    def step(self, action: Any) -> Any:
        """Take a step."""
        found = self._user_env.step(action)
        return found if len(found) == NEW else in_new_form(found)

    def render(self) -> Any:
        """Return nothing."""
