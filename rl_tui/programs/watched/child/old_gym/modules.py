"""The modules of the old Gym that scripts use."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Mapping
from functools import partial
from types import ModuleType
from typing import Any, Final

import gymnasium
import numpy as np

from rl_tui.common.made_modules import MadeModules
from rl_tui.programs.watched.child.environments.direct_envs import DirectEnvs
from rl_tui.programs.watched.child.environments.making import Making
from rl_tui.programs.watched.child.environments.watched_env import WatchedEnv
from rl_tui.programs.watched.child.old_gym.call_form import NEW, values_around
from rl_tui.programs.watched.child.old_gym.environments import (
    INNER_METHODS,
    NewForm,
    OldEnv,
    answer,
    old_wrapper,
    seed,
)
from rl_tui.programs.watched.child.stand_ins import Nothing

_NOTE: Final = (
    "the script imports the old gym: Gymnasium replaces it, and reset and step return as many values as the "
    "script expects"
)
_OLD: Final = "gym"
_NEW: Final = "gymnasium"
_DROPPED: Final = ("new_step_api", "apply_api_compatibility", "autoreset", "render_mode")
_KEPT: Final = ("max_episode_steps", "reward_threshold", "kwargs", "nondeterministic")
_VERSIONS: Final = {True: "0.26.2", False: "0.18.0"}
"""The version of a script in the new form, and of another. Some scripts test it."""
_WRAPPERS: Final = {
    name: old_wrapper(getattr(gymnasium, name))
    for name in ("Wrapper", "ObservationWrapper", "RewardWrapper", "ActionWrapper")
}


def offer_old_gym(making: Making) -> None:
    """Answer `import gym`, installed or not, and note it."""
    gym = _OldGym(making)
    sys.meta_path.insert(0, MadeModules(gym.has, gym.content))


class _OldGym:
    """The modules of `gym`. Most have the content of Gymnasium's under the old name."""

    def __init__(self, making: Making) -> None:
        self._making = making
        self._own: Mapping[str, Callable[[], Mapping[str, Any]]] = {
            "gym": self._root,
            "gym.core": lambda: {"Env": gymnasium.Env, **_WRAPPERS},
            "gym.envs.toy_text.discrete": lambda: _DISCRETE,
            "gym.utils.seeding": lambda: _SEEDING,
            "gym.monitoring": lambda: _VIDEO,
            "gym.wrappers.monitor": lambda: _MONITOR,
            "gym.wrappers.monitoring": lambda: {**_MONITOR, **_VIDEO},
            "gym.wrappers.monitoring.video_recorder": lambda: _VIDEO,
        }

    def has(self, name: str) -> bool:
        return name.partition(".")[0] == _OLD and self._names_in(name) is not None

    def content(self, name: str) -> Mapping[str, Any]:
        if name == _OLD:
            self._making.note(_NOTE)
            self._begin()
        return {**(self._names_in(name) or {}), "__getattr__": partial(_inner_module, name)}

    def _begin(self) -> None:
        direct: DirectEnvs = self._making.direct
        direct.answer, direct.more_methods = answer, INNER_METHODS
        if not hasattr(gymnasium.Env, "seed"):
            gymnasium.Env.seed = seed

    def _names_in(self, name: str) -> Mapping[str, Any] | None:
        if name in self._own:
            return self._own[name]()
        try:
            module = importlib.import_module(_NEW + name.removeprefix(_OLD))
        except ImportError:
            return None
        found = {
            key: value
            for key, value in vars(module).items()
            if not (key.startswith("__") or isinstance(value, ModuleType))
        }
        if name == "gym.wrappers":
            found |= {
                **_MONITOR,
                **dict.fromkeys(("RecordVideo", "OrderEnforcing"), _itself),
                "TimeLimit": _TIME_LIMIT,
            }
        if name in ("gym.envs", "gym.envs.registration"):
            registry = _Registry(gymnasium.registry)
            found |= {"registry": registry, "register": self._register, "make": self._make}
        return found

    def _root(self) -> Mapping[str, Any]:
        return {
            "__version__": _VERSIONS[values_around(None) == NEW],
            "make": self._make,
            "register": self._register,
            "Env": gymnasium.Env,
            "GoalEnv": gymnasium.Env,
            "Space": gymnasium.Space,
            **_WRAPPERS,
        }

    def _make(self, id: Any, **more: Any) -> OldEnv:  # noqa: A002
        kept = {name: each for name, each in more.items() if name not in _DROPPED}
        env = self._making.make(id, disable_env_checker=True, **kept)
        reports = env.reports if isinstance(env, WatchedEnv) else None
        return OldEnv(env, lambda bare: self._making.direct.hand_out(bare, reports))

    def _register(self, id: str, entry_point: Any = None, **more: Any) -> None:  # noqa: A002
        def build(**kwargs: Any) -> Any:
            made = entry_point
            if isinstance(made, str):
                module, _, attribute = made.partition(":")
                made = getattr(importlib.import_module(module), attribute)
            return NewForm(made(**kwargs))

        is_theirs = isinstance(entry_point, str) and entry_point.startswith(f"{_OLD}.")
        point = _NEW + entry_point.removeprefix(_OLD) if is_theirs else build
        gymnasium.register(id, point, **{name: each for name, each in more.items() if name in _KEPT})


def _inner_module(outer: str, name: str) -> Any:
    try:
        return importlib.import_module(f"{outer}.{name}")
    except ImportError:
        raise AttributeError(f"module {outer!r} has no attribute {name!r}") from None


class _Registry(dict[str, Any]):
    @property
    def env_specs(self) -> _Registry:
        return self

    def all(self) -> list[Any]:
        return list(self.values())


def _itself(env: Any, *_: Any, **__: Any) -> Any:
    """Return `env` without the wrapper that would write videos or files."""
    return env


class _OldRandom(np.random.RandomState):
    def integers(self, *arguments: Any, **more: Any) -> Any:
        return self.randint(*arguments, **more)

    def random(self, size: Any = None) -> Any:
        return self.random_sample(size)


def _np_random(number: int | None = None) -> tuple[_OldRandom, int]:
    known = int(number or 0)
    return _OldRandom(known % 2**32), known


def _categorical_sample(chances: Any, generator: Any) -> int:
    return int((np.cumsum(np.asarray(chances)) > generator.random()).argmax())


class DiscreteEnv(gymnasium.Env):  # type: ignore[misc]
    """A world by its table `P[s][a]`, lists of (probability, next state, reward, done). `isd` has the
    probability of each start state.
    """

    def __init__(self, nS: int, nA: int, P: Any, isd: Any) -> None:  # noqa: N803
        self.P, self.isd, self.nS, self.nA = P, isd, nS, nA
        self.action_space, self.observation_space = (
            gymnasium.spaces.Discrete(nA),
            gymnasium.spaces.Discrete(nS),
        )
        self.lastaction: Any = None
        self.np_random = _np_random()[0]
        self.s = _categorical_sample(self.isd, self.np_random)

    def seed(self, number: int | None = None) -> list[int]:
        """Seed the random numbers."""
        self.np_random, known = _np_random(number)
        return [known]

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> int:
        """Begin an episode."""
        if seed is not None:
            self.seed(seed)
        self.s, self.lastaction = _categorical_sample(self.isd, self.np_random), None
        return int(self.s)

    def step(self, action: Any) -> tuple[int, float, bool, dict[str, Any]]:
        """Take a step."""
        outcomes = self.P[self.s][action]
        chance, self.s, reward, done = outcomes[
            _categorical_sample([each[0] for each in outcomes], self.np_random)
        ]
        self.lastaction = action
        return int(self.s), reward, done, {"prob": chance}

    def render(self, *_: Any, **__: Any) -> Any:
        """Return nothing."""


_TIME_LIMIT: Final = old_wrapper(gymnasium.wrappers.TimeLimit)
_MONITOR: Final = dict.fromkeys(("Monitor", "RecordEpisodeStatistics"), _itself)
_VIDEO: Final = {"VideoRecorder": Nothing(), "ImageEncoder": Nothing(), "Monitor": _itself}
_DISCRETE: Final = {"DiscreteEnv": DiscreteEnv, "categorical_sample": _categorical_sample}
_SEEDING: Final = {
    "np_random": _np_random,
    "hash_seed": lambda seed=None, **_: seed or 0,
    "create_seed": lambda a=None, **_: a or 0,
    "RandomNumberGenerator": _OldRandom,
}
