"""An environment of a program with a look at each of its steps."""

from __future__ import annotations

import copy
import sys
from typing import TYPE_CHECKING, Any

import gymnasium

from rl_tui.lab.programs.child.environments.numbering import Numbering
from rl_tui.lab.programs.messages import MessageKind, StepFlag

if TYPE_CHECKING:
    from rl_tui.lab.programs.child.recorder import Recorder

_TERMINATED, _TRUNCATED = int(StepFlag.TERMINATED), int(StepFlag.TRUNCATED)
_STRANGE = "a step was left out: an observation or action outside of its space, or no five results"


class WatchedEnv(gymnasium.Wrapper):  # type: ignore[misc]
    """Environment ``number`` of the program. The first reset without a seed gets ``seed``."""

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
        """Take a step, when it may, and tell of it."""
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
        """Begin an episode, when it may."""
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
        """What the environment was made from, without this wrapper, which nobody can make."""
        return self.env.spec

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name == "env":
            raise AttributeError(name)
        return getattr(self.env, name)

    def __deepcopy__(self, memo: dict[int, Any]) -> gymnasium.Env[Any, Any]:
        """Return a copy that is not watched: what is tried out in it is none of the program's steps."""
        return copy.deepcopy(self.env, memo)

    def __reduce__(self) -> Any:
        return _itself, (self.env,)


def _itself(env: gymnasium.Env[Any, Any]) -> gymnasium.Env[Any, Any]:
    return env
