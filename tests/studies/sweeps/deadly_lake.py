"""An environment that kills its own process, for one seed and only with permission."""

from __future__ import annotations

import os
import signal
from typing import Any, Final

import gymnasium
from gymnasium.envs.toy_text.frozen_lake import FrozenLakeEnv

ALLOWED: Final = "DEADLY_LAKE"
"""The variable that says whether this process can be killed."""


class DeadlyLake(FrozenLakeEnv):
    """The frozen lake. Its ``reset`` with the seed ``deadly`` kills the process."""

    def __init__(self, deadly: int = -1, **settings: Any) -> None:
        super().__init__(**settings)
        self._deadly = deadly

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        if seed == self._deadly and ALLOWED in os.environ:
            os.kill(os.getpid(), signal.SIGKILL)
        return super().reset(seed=seed, options=options)


gymnasium.register("DeadlyLake-v0", entry_point=DeadlyLake, max_episode_steps=50)
