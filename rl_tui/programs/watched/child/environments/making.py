"""`gymnasium.make` for a watched program, whose environments report every step."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import gymnasium
from gymnasium.envs import registration

from rl_tui.programs.watched.child.environments.direct_envs import DirectEnvs
from rl_tui.programs.watched.child.environments.numbering import Numbering, numbering_of
from rl_tui.programs.watched.child.environments.watched_env import (
    Elsewhere,
    StepReports,
    WatchedEnv,
    made_elsewhere,
)
from rl_tui.programs.watched.child.recorder import Recorder
from rl_tui.programs.watched.child.tables.search import attributes
from rl_tui.programs.watched.child.worlds.met import MetNumbering
from rl_tui.programs.watched.messages import MessageKind

Make = Callable[..., Any]
MOST_STATES: Final = 20_000
"""Most states of an environment whose table is reported."""
_WITHDRAWN: Final = (gymnasium.error.DeprecatedEnv, gymnasium.error.VersionNotFound)
_KNOWN: Final = ("gymnasium.", "rl_tui.")
_VECTORS: Final = (
    "a vector environment takes several steps at once; use gymnasium.make, because rl-tui watches one step "
    "at a time"
)
_NO_ENVIRONMENT: Final = (
    "nothing to watch, because rl-tui sees only steps in a Gymnasium environment, in a class with reset() "
    "and step(action), in a function step(state, action), or as assignments to a table"
)
_NO_RENDERING: Final = 'render_mode="human" is ignored: rl-tui shows the world'
_NO_STEP: Final = (
    "the script took no step in its environment (rl-tui sees none in copies or in other processes)"
)


class Making:
    """Makes and numbers the environments of a program."""

    def __init__(self, recorder: Recorder, seed: int) -> None:
        self.recorder, self.note, self._seed = recorder, recorder.channel.note, seed
        self._made = 0
        self._was_asked = False
        self._original: Make = registration.make
        self._all: list[StepReports] = []
        self._numbers: dict[tuple[type, Numbering], int] = {}
        self.without_states: Callable[[gymnasium.Env[Any, Any]], StepReports | None] = lambda _: None
        """Returns what reports the steps of an environment without finite observations, if anything does."""
        self.direct = DirectEnvs(self._announce, self._without_limit)

    def install(self) -> None:
        """Replace Gymnasium's `make`."""
        for module in (gymnasium, gymnasium.envs, registration):
            for name, other in (("make", self.make), ("make_vec", self._refuse_vectors)):
                if hasattr(module, name):
                    setattr(module, name, other)
        for vector in (gymnasium.vector.SyncVectorEnv, gymnasium.vector.AsyncVectorEnv):
            vector.__init__ = self._refuse_vectors
        self.direct.install(self._seed)

    def tell_what_was_missed(self) -> None:
        """Report why nothing was seen of a finished program."""
        if self.recorder.count == 0 and not (self._was_asked and self._made == 0):
            self.note(_NO_STEP if self._made else _NO_ENVIRONMENT)

    @property
    def is_inside(self) -> bool:
        """True while an environment reports its own steps."""
        return any(each.is_inside for each in self._all)

    def announce_own(self, name: str, numbering: Numbering, time_limit: int = 0) -> int:
        """Report a world of the program's own, and return its number."""
        number = self._made
        self._made += 1
        self._tell_sizes(number, name, numbering, time_limit=time_limit)
        return number

    def tell_names(self, number: int, numbering: MetNumbering) -> None:
        """Report the names met so far."""
        self.recorder.channel.message(
            MessageKind.NAMES,
            number=number,
            state_names=[str(numbering.key(each)) for each in numbering.met],
            action_names=[str(each) for each in numbering.action_keys],
        )

    def make(self, *arguments: Any, **more: Any) -> Any:
        """Make an environment, of a withdrawn one the newest version."""
        self._was_asked = True
        if more.get("render_mode") == "human":
            more["render_mode"] = None
            self.note(_NO_RENDERING)
        if Elsewhere.is_now:  # an environment that makes another one
            return self._original(*arguments, **more)
        with made_elsewhere():
            env = self._made_by_gymnasium(arguments, more)
        if not isinstance(env, gymnasium.Env):
            return env
        numbering = numbering_of(env)
        if numbering is None:
            if (reports := self.without_states(env)) is not None:
                self._all.append(reports)
                env.action_space.seed(self._seed)
                return WatchedEnv(env, reports, self._seed, self.direct.hand_out)
            spaces = f"{type(env.observation_space).__name__} observations"
            spaces += f" and {type(env.action_space).__name__} actions"
            self.note(f"{id_of(env)} is not watched: it has {spaces}, which are not discrete")
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
            self.note(f"{name} is not in this Gymnasium: {other} was made instead")
            made = f"{module}:{other}" if module else other
            return self._original(made, *arguments[1:], **asked)

    def _watched(self, env: gymnasium.Env[Any, Any], numbering: Numbering) -> WatchedEnv:
        reports = StepReports(self._made, numbering, self.recorder)
        self._all.append(reports)
        self._made += 1
        seed = self._seed + reports.number
        env.action_space.seed(seed)
        self._tell(env, reports)
        return WatchedEnv(env, reports, seed, self.direct.hand_out)

    def _announce(self, env: gymnasium.Env[Any, Any]) -> StepReports | None:
        numbering = numbering_of(env)
        if getattr(env, "render_mode", None) == "human":
            env.render_mode = None
            self.note(_NO_RENDERING)
        if numbering is None:
            return None
        key = (type(env), numbering)
        reports = StepReports(self._numbers.setdefault(key, self._made), numbering, self.recorder)
        if reports.number == self._made:
            self._all.append(reports)
            self._made += 1
            self._tell(env, reports)
        return reports

    def _without_limit(self, env: gymnasium.Env[Any, Any], reports: StepReports) -> None:
        if reports.number >= 0:
            self._tell(env, reports, time_limit=0)

    def _tell(
        self, env: gymnasium.Env[Any, Any], reports: StepReports, time_limit: int | None = None
    ) -> None:
        spec, numbering = env.spec, reports.numbering
        kwargs = {} if spec is None else {key: each for key, each in spec.kwargs.items() if each is not None}
        if time_limit is None:
            time_limit = (0 if spec is None else spec.max_episode_steps) or 0
        self._tell_sizes(
            reports.number,
            id_of(env),
            numbering,
            kwargs=kwargs if spec is not None and _is_data(kwargs) else None,
            time_limit=time_limit,
            wrappers=_wrappers(env),
        )
        if spec is None or not (isinstance(spec.entry_point, str) and spec.entry_point.startswith(_KNOWN)):
            inside = _attributes_of_env(env.unwrapped)
            table = _transitions_of(inside.get("P"), numbering)
            if table is not None:
                start = _start_of(inside.get("initial_state_distrib", inside.get("isd")), numbering)
                self.recorder.channel.message(
                    MessageKind.TRANSITIONS, number=reports.number, P=table, start=start
                )

    def _tell_sizes(
        self,
        number: int,
        name: str,
        numbering: Numbering,
        *,
        kwargs: Mapping[str, Any] | None = None,
        time_limit: int = 0,
        wrappers: Sequence[str] = (),
    ) -> None:
        self.recorder.channel.message(
            MessageKind.ENVIRONMENT,
            number=number,
            id=name,
            kwargs=kwargs,
            states=numbering.parts,
            first_state=numbering.first,
            actions=numbering.actions,
            first_action=numbering.first_action,
            time_limit=time_limit,
            wrappers=wrappers,
        )

    def _refuse_vectors(self, *_: Any, **__: Any) -> Any:
        self.recorder.refuse(_VECTORS)


def _attributes_of_env(env: gymnasium.Env[Any, Any]) -> Mapping[str, Any]:
    found = object.__getattribute__(env, "__dict__")
    return found if type(found) is dict else attributes(env)


def _transitions_of(table: Any, numbering: Numbering) -> list[list[list[list[float]]]] | None:
    """Return an environment's table, `[s][a]` a list of [probability, next state, reward, terminated].

    None if it has other values, or more than 20,000 states.
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


def id_of(env: gymnasium.Env[Any, Any]) -> str:
    """Return the name of an environment."""
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
