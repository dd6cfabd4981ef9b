"""`gymnasium.make` for a watched program, whose environments report every step."""

from __future__ import annotations

import copy
import math
import sys
from collections.abc import Callable, Mapping
from typing import Any, Final

import gymnasium
from gymnasium.envs import registration

from rl_tui.programs.watched.child.numbering import Numbering, numbering_of
from rl_tui.programs.watched.child.recorder import Recorder
from rl_tui.programs.watched.child.search import attributes
from rl_tui.programs.watched.messages import MessageKind, StepFlag

# A watched environment


_TERMINATED, _TRUNCATED = int(StepFlag.TERMINATED), int(StepFlag.TRUNCATED)
_STRANGE = "a step was left out: an observation or action outside of its space, or no five results"


class WatchedEnv(gymnasium.Wrapper):  # type: ignore[misc]
    """Environment `number` of the program. The first reset without a seed uses `seed`."""

    def __init__(
        self, env: gymnasium.Env[Any, Any], number: int, numbering: Numbering, recorder: Recorder, seed: int
    ) -> None:
        super().__init__(env)
        self._number, self._numbering, self._recorder = number, numbering, recorder
        self._seed: int | None = seed
        self._state = 0
        self._episode = self._place = 0
        self._is_strange = False

    def step(self, action: Any) -> Any:
        """Take a step, once permitted, and report it."""
        self._recorder.before(sys._getframe(1), self._numbering, "step")
        result = self.env.step(action)
        try:
            observation, reward, terminated, truncated, _ = result
            next_state, number = self._numbering.state(observation), self._numbering.action(action)
            flags = (_TERMINATED if terminated else 0) | (_TRUNCATED if truncated else 0)
            gained = float(reward)
        except (TypeError, ValueError):
            self._leave_out()
            return result
        if self._place == 0:
            self._episode = self._recorder.begin_episode()
        step = (self._number, self._state, number, gained, next_state, flags, self._episode, self._place)
        self._recorder.after(step, self._numbering)
        self._place += 1
        self._state = next_state
        return result

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        """Begin an episode, once permitted."""
        self._recorder.before(sys._getframe(1), self._numbering, "reset")
        if seed is None:
            seed = self._seed
        self._seed = None
        result = self.env.reset(seed=seed, options=options)
        self._place = 0
        try:
            self._state = self._numbering.state(result[0])
        except (TypeError, ValueError):
            self._leave_out()
        return result

    def _leave_out(self) -> None:
        if not self._is_strange:
            self._is_strange = True
            self._recorder.channel.message(MessageKind.NOTE, text=_STRANGE)

    @property
    def spec(self) -> Any:
        """Specification of the environment without this wrapper, so that others can make it."""
        return self.env.spec

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name == "env":
            raise AttributeError(name)
        return getattr(self.env, name)

    def __deepcopy__(self, memo: dict[int, Any]) -> gymnasium.Env[Any, Any]:
        """Return an unwatched copy, because trying it out is not a step of the program."""
        return copy.deepcopy(self.env, memo)

    def __reduce__(self) -> Any:
        return _itself, (self.env,)


def _itself(env: gymnasium.Env[Any, Any]) -> gymnasium.Env[Any, Any]:
    return env


# Making environments


Make = Callable[..., Any]
MOST_STATES: Final = 20_000
"""Most states of an environment whose table is reported."""
_WITHDRAWN: Final = (gymnasium.error.DeprecatedEnv, gymnasium.error.VersionNotFound)
_KNOWN: Final = ("gymnasium.", "rl_tui.")
_VECTORS: Final = (
    "a vector environment takes several steps at once; rl-tui watches environments made by gymnasium.make, "
    "a step at a time"
)
_NO_ENVIRONMENT: Final = "nothing to watch: the script made no environment with gymnasium.make"
_NO_STEP: Final = (
    "no step was seen: those of env.unwrapped, of copies of an environment and of other processes are "
    "not watched"
)


class Making:
    """Makes and numbers the environments of a program. `seed` is that of the run."""

    def __init__(self, recorder: Recorder, seed: int) -> None:
        self._recorder, self._seed = recorder, seed
        self._made = 0
        self._was_asked = False
        self._original: Make = registration.make
        self._is_inside = False

    def install(self) -> None:
        """Replace Gymnasium's `make` by `make`."""
        for module in (gymnasium, gymnasium.envs, registration):
            for name, other in (("make", self.make), ("make_vec", self._refuse_vectors)):
                if hasattr(module, name):
                    setattr(module, name, other)
        for vector in (gymnasium.vector.SyncVectorEnv, gymnasium.vector.AsyncVectorEnv):
            vector.__init__ = self._refuse_vectors

    def tell_what_was_missed(self) -> None:
        """Report why nothing was seen of a finished program, if so."""
        if self._recorder.count == 0 and not (self._was_asked and self._made == 0):
            self._note(_NO_STEP if self._made else _NO_ENVIRONMENT)

    def make(self, *arguments: Any, **more: Any) -> Any:
        """Make an environment as Gymnasium does, and a withdrawn one in its newest version."""
        self._was_asked = True
        if more.get("render_mode") == "human":
            more["render_mode"] = None
            self._note('render_mode="human" is ignored: rl-tui shows the world')
        if self._is_inside:  # an environment that makes another one
            return self._original(*arguments, **more)
        self._is_inside = True
        try:
            env = self._made_by_gymnasium(arguments, more)
        finally:
            self._is_inside = False
        if not isinstance(env, gymnasium.Env):
            return env
        numbering = numbering_of(env)
        if numbering is None:
            spaces = f"{type(env.observation_space).__name__} observations"
            spaces += f" and {type(env.action_space).__name__} actions"
            self._note(f"{_id_of(env)} is not watched: it has {spaces}, no finite numbers of them")
            return env
        return self._watched(env, numbering)

    def _made_by_gymnasium(self, arguments: tuple[Any, ...], more: Mapping[str, Any]) -> Any:
        try:
            return self._original(*arguments, **more)
        except _WITHDRAWN:
            asked = dict(more)
            module, _, name = (arguments[0] if arguments else asked.pop("id")).rpartition(":")
            space, base, _ = registration.parse_env_id(name)
            newest = registration.find_highest_version(space, base)
            other = registration.get_env_id(space, base, newest)
            self._note(f"{name} is not in this Gymnasium: {other} was made instead")
            made = f"{module}:{other}" if module else other
            return self._original(made, *arguments[1:], **asked)

    def _watched(self, env: gymnasium.Env[Any, Any], numbering: Numbering) -> WatchedEnv:
        number = self._made
        self._made += 1
        env.action_space.seed(self._seed + number)
        self._tell(env, number, numbering)
        return WatchedEnv(env, number, numbering, self._recorder, self._seed + number)

    def _tell(self, env: gymnasium.Env[Any, Any], number: int, numbering: Numbering) -> None:
        spec = env.spec
        kwargs = {} if spec is None else {key: each for key, each in spec.kwargs.items() if each is not None}
        self._recorder.channel.message(
            MessageKind.ENVIRONMENT,
            number=number,
            id=_id_of(env),
            kwargs=kwargs if _is_data(kwargs) else None,
            states=numbering.parts,
            first_state=numbering.first,
            actions=numbering.actions,
            first_action=numbering.first_action,
            time_limit=(0 if spec is None else spec.max_episode_steps) or 0,
            wrappers=_wrappers(env),
        )
        if spec is not None and not (
            isinstance(spec.entry_point, str) and spec.entry_point.startswith(_KNOWN)
        ):
            inside = attributes_of_env(env.unwrapped)
            table = transitions_of(inside.get("P"), numbering)
            if table is not None:
                start = _start_of(inside.get("initial_state_distrib"), numbering)
                self._recorder.channel.message(MessageKind.TRANSITIONS, number=number, P=table, start=start)

    def _refuse_vectors(self, *_: Any, **__: Any) -> Any:
        self._recorder.refuse(_VECTORS)

    def _note(self, text: str) -> None:
        self._recorder.channel.message(MessageKind.NOTE, text=text)


def attributes_of_env(env: gymnasium.Env[Any, Any]) -> Mapping[str, Any]:
    """Return the attributes of an environment without calling its class."""
    found = object.__getattribute__(env, "__dict__")
    return found if type(found) is dict else attributes(env)


def transitions_of(table: Any, numbering: Numbering) -> list[list[list[list[float]]]] | None:
    """Return the table of an environment, `[s][a]` a list of [probability, next state, reward,
    terminated]. None if it has other values, or more than 20,000 states.
    """
    if not isinstance(table, (dict, list)) or numbering.states > MOST_STATES or numbering.is_tuple:
        return None
    try:
        return [
            [[_outcome(each) for each in table[state][action]] for action in range(numbering.actions)]
            for state in range(numbering.states)
        ]
    except (LookupError, TypeError, ValueError):
        return None


def _outcome(outcome: Any) -> list[float]:
    chance, state, reward, ended = outcome
    numbers = [float(chance), int(state), float(reward), bool(ended)]
    if not all(map(math.isfinite, numbers)):
        raise ValueError("no number")
    return numbers


def _start_of(chances: Any, numbering: Numbering) -> list[float] | None:
    try:
        start = [float(each) for each in chances]
    except (TypeError, ValueError):
        return None
    is_fit = len(start) == numbering.states and all(map(math.isfinite, start))
    return start if is_fit else None


def _id_of(env: gymnasium.Env[Any, Any]) -> str:
    return type(env.unwrapped).__name__ if env.spec is None else env.spec.id


def _wrappers(env: Any) -> list[str]:
    names = []
    while isinstance(env, gymnasium.Wrapper):
        names.append(type(env).__name__)
        env = env.env
    return names


def _is_data(value: Any) -> bool:
    if isinstance(value, dict):
        return all(type(key) is str and _is_data(each) for key, each in value.items())
    if isinstance(value, (list, tuple)):
        return all(map(_is_data, value))
    return type(value) in (str, int, bool, type(None)) or (type(value) is float and math.isfinite(value))
