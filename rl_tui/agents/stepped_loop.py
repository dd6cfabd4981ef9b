"""The agent–environment loop where the environment has no table: the same algorithms, a step at a time."""

from __future__ import annotations

from typing import Any

from numpy.random import Generator

from rl_tui.agents.position import EpisodeLog, LastRecord, Position
from rl_tui.agents.settings import Schedules, Settings
from rl_tui.agents.stop import Stop
from rl_tui.agents.tables import Tables
from rl_tui.worlds.environment import Environment


class SteppedLoop:
    """One environment and where it stands; its own randomness starts from a draw of ``world``."""

    def __init__(self, environment: Environment, world: Generator) -> None:
        self.failure = ""
        self.state = 0

    def advance(
        self,
        memory: Any,
        rule: Any,
        settings: Settings,
        schedules: Schedules,
        tables: Tables,
        position: Position,
        log: EpisodeLog,
        last: LastRecord,
        learner: Generator,
        steps: int,
        episodes: int,
    ) -> Stop:
        """Take at most ``steps`` steps, or until ``episodes`` more have ended."""
        raise NotImplementedError
