"""An environment that reports its steps, whoever calls them."""

from __future__ import annotations

import copy
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Final

import gymnasium

from rl_tui.programs.watched.child.environments.numbering import Numbering
from rl_tui.programs.watched.child.errors import is_users_file
from rl_tui.programs.watched.child.recorder import Recorder
from rl_tui.programs.watched.messages import StepFlag

_TERMINATED, _TRUNCATED = int(StepFlag.TERMINATED), int(StepFlag.TRUNCATED)
_STRANGE: Final = (
    "a step was ignored: its observation or action is outside of its space, or it did not return five values"
)


class StepReports:
    """Reports the steps of environment `number`, −1 at first. `is_inside` is True while that runs."""

    def __init__(self, number: int, numbering: Numbering, recorder: Recorder) -> None:
        self.number, self.numbering, self._recorder = number, numbering, recorder
        self.bare: gymnasium.Env[Any, Any] | None = None
        """The environment without wrappers, if the program has it and may set its state."""
        self.is_inside = False
        self.is_used = False
        self.is_silent = False
        """True if another environment inside of this one reports its own steps."""
        self.state = 0
        self._episode = self._place = 0

    def step(self, frame: Any, take: Callable[[Any], Any], action: Any) -> Any:
        """Take a step, once permitted, and report it."""
        self._recorder.before(frame, self.numbering, "step")
        if self.bare is not None:
            state = self.bare.__dict__.get("s")
            if type(state) is int and self.numbering.counts_from_0:
                self.state = state
        count = self._recorder.count
        result = self._call(take, action)
        if self._recorder.count != count:
            self.is_silent = True
            return result
        try:
            observation, reward, terminated, truncated, _ = (
                result if len(result) == 5 else in_new_form(result)
            )
            next_state, number = self.numbering.state(observation), self.numbering.action(action)
            flags = (_TERMINATED if terminated else 0) | (_TRUNCATED if truncated else 0)
            gained = float(reward)
        except (TypeError, ValueError):
            self._leave_out()
            return result
        if self._place == 0:
            self._episode = self._recorder.begin_episode()
        step = (self.number, self.state, number, gained, next_state, flags, self._episode, self._place)
        self._recorder.after(step, self.numbering)
        self._place += 1
        self.state = next_state
        return result

    def reset(self, frame: Any, begin: Callable[[], Any]) -> Any:
        """Begin an episode, once permitted, and note its state."""
        self._recorder.before(frame, self.numbering, "reset")
        result = self._call(begin)
        self._recorder.resets += 1
        self._place = 0
        try:
            self.state = self.numbering.state(result[0] if is_with_information(result) else result)
        except (TypeError, ValueError, LookupError):
            self._leave_out()
        return result

    def _call(self, call: Callable[..., Any], *arguments: Any) -> Any:
        self.is_inside = self.is_used = True
        try:
            return call(*arguments)
        finally:
            self.is_inside = False

    def _leave_out(self) -> None:
        self._recorder.channel.note(_STRANGE)


def in_new_form(result: Any) -> tuple[Any, ...]:
    """Return the old Gym's four values as five. Raises TypeError or ValueError for others."""
    observation, reward, done, info = result
    is_truncated = isinstance(info, dict) and bool(info.get("TimeLimit.truncated"))
    return observation, reward, bool(done) and not is_truncated, is_truncated, info


def is_with_information(result: Any) -> bool:
    """Return True if `reset` also returned information."""
    return type(result) is tuple and len(result) == 2 and isinstance(result[1], dict)


class Elsewhere:
    """True while environments are made that do not report themselves."""

    is_now = False


@contextmanager
def made_elsewhere() -> Iterator[None]:
    """Let environments made meanwhile not report themselves."""
    before, Elsewhere.is_now = Elsewhere.is_now, True
    try:
        yield
    finally:
        Elsewhere.is_now = before


def _of_the_inside(name: str) -> Any:
    return property(
        lambda env: getattr(env._inside, name), lambda env, value: setattr(env._inside, name, value)
    )


class WatchedEnv(gymnasium.Wrapper):  # type: ignore[misc]
    """An environment made by `gymnasium.make`.

    The first reset without a seed uses `seed`. If the program asks for the environment inside, `hand_out`
    lets that report its steps too.
    """

    def __init__(
        self,
        env: gymnasium.Env[Any, Any],
        reports: StepReports,
        seed: int,
        hand_out: Callable[[gymnasium.Env[Any, Any], StepReports], None],
    ) -> None:
        self._inside = env
        super().__init__(env)
        self.reports, self._seed = reports, seed
        self._unused_seed: int | None = seed
        self._hand_out = hand_out
        self._take = env.step

    def step(self, action: Any) -> Any:
        """Take a reported step."""
        return self.reports.step(sys._getframe(1), self._take, action)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        """Begin an episode, once permitted."""
        if seed is None:
            seed = self._unused_seed
        self._unused_seed = None
        return self.reports.reset(sys._getframe(1), lambda: self._inside.reset(seed=seed, options=options))

    @property
    def env(self) -> Any:
        """The next inner environment."""
        inside = self._inside
        if is_users_file(sys._getframe(1).f_code.co_filename):
            self._hand_out(inside.unwrapped, self.reports)
            return inside.env if isinstance(inside, gymnasium.Wrapper) else inside
        return inside

    @env.setter
    def env(self, inside: Any) -> None:
        self._inside = inside
        self._take = inside.step

    @property
    def unwrapped(self) -> Any:
        """The environment without any wrapper."""
        bare = self._inside.unwrapped
        if is_users_file(sys._getframe(1).f_code.co_filename):
            self._hand_out(bare, self.reports)
        return bare

    action_space = _of_the_inside("action_space")
    observation_space = _of_the_inside("observation_space")

    @property
    def spec(self) -> Any:
        """Specification without this wrapper, for making others."""
        return self._inside.spec

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name == "_inside":
            raise AttributeError(name)
        return getattr(self._inside, name)

    def __deepcopy__(self, memo: dict[int, Any]) -> gymnasium.Env[Any, Any]:
        """Return an unwatched copy, because trying it out is not a step of the program."""
        with made_elsewhere():
            return copy.deepcopy(self._inside, memo)

    def __reduce__(self) -> Any:
        return _itself, (self._inside,)


def _itself(env: gymnasium.Env[Any, Any]) -> gymnasium.Env[Any, Any]:
    return env
