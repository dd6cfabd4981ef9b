"""The ids by which Gymnasium makes our scenarios: ``rl_tui/NAME-v0``.

Gymnasium has had no plugins since its version 1.0: environments are registered when a module is imported,
here this one. Only names of files are looked at. What is in a file is read when its environment is made.
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
    """How Gymnasium makes a scenario: its id or the path of its file is ``kwargs["scenario"]``.

    ``max_episode_steps`` is the scenario's time limit, read from it when it is first asked for.
    """

    _limit: int | None = None
    _limit_is_known = False

    def __post_init__(self) -> None:
        """Keep which scenario it is: ``make_vec`` hands ``kwargs`` on in another way, and empties it here."""
        super().__post_init__()
        self._scenario = self.kwargs["scenario"]

    @property
    def max_episode_steps(self) -> int | None:
        """The number of steps after which an episode is truncated, None for never."""
        if not self._limit_is_known:
            from rl_tui.worlds.environments.scenario_env import time_limit_of_scenario

            self._limit = time_limit_of_scenario(self._scenario)
            self._limit_is_known = True
        return self._limit

    @max_episode_steps.setter
    def max_episode_steps(self, limit: int | None) -> None:
        self._limit, self._limit_is_known = limit, limit is not None


def spec_of(scenario: str) -> ScenarioSpec:
    """Return what ``gymnasium.make`` takes for the scenario of this id, or of the file at this path."""
    name = scenario if _NAME.fullmatch(scenario) else _OF_A_FILE
    return ScenarioSpec(id=f"{OWN_IDS}{name}-v0", entry_point=_ENTRY_POINT, kwargs={"scenario": scenario})


for _name in shipped_names():
    _spec = spec_of(_name)
    # gymnasium.register would compare each id with all others, and make a plain EnvSpec
    registry[_spec.id] = _spec
