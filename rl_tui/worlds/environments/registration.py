"""Registration of our scenarios in Gymnasium as ``rl_tui/NAME-v0``, by import.

Gymnasium has no plugins since version 1.0. A file is read when its environment is made.
"""

from __future__ import annotations

import re
from typing import Final

from gymnasium.envs.registration import EnvSpec, registry

from rl_tui.common.own_ids import OWN_IDS
from rl_tui.worlds.files.shipped import shipped_names

_ENTRY_POINT: Final = "rl_tui.worlds.environments.scenario_env:ScenarioEnv"
_NAME: Final = re.compile(r"[\w-]+")
_OF_A_FILE: Final = "scenario"


class ScenarioSpec(EnvSpec):  # type: ignore[misc]
    """Gymnasium's spec of the scenario ``kwargs["scenario"]``, an id or path.

    The time limit is read on first use.
    """

    _limit: int | None = None
    _limit_is_known = False

    def __post_init__(self) -> None:
        """Store the scenario, because ``make_vec`` empties ``kwargs``."""
        super().__post_init__()
        self._scenario = self.kwargs["scenario"]

    @property
    def max_episode_steps(self) -> int | None:
        """Steps after which an episode is truncated, or None."""
        if not self._limit_is_known:
            from rl_tui.worlds.environments.scenario_env import time_limit_of_scenario

            self._limit = time_limit_of_scenario(self._scenario)
            self._limit_is_known = True
        return self._limit

    @max_episode_steps.setter
    def max_episode_steps(self, limit: int | None) -> None:
        self._limit, self._limit_is_known = limit, limit is not None


def spec_of(scenario: str) -> ScenarioSpec:
    """Return the spec of a scenario id or file for ``gymnasium.make``."""
    name = scenario if _NAME.fullmatch(scenario) else _OF_A_FILE
    return ScenarioSpec(id=f"{OWN_IDS}{name}-v0", entry_point=_ENTRY_POINT, kwargs={"scenario": scenario})


for _name in shipped_names():
    _spec = spec_of(_name)
    # gymnasium.register would compare all ids, and create a plain EnvSpec
    registry[_spec.id] = _spec
