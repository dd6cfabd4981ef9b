"""The shipped scenarios, listed from their folder, and the shipped lessons, each read once."""

from __future__ import annotations

from functools import cache
from typing import Final

from rl_tui.lessons import catalogue
from rl_tui.worlds.files.scenario import Scenario, read_scenario
from rl_tui.worlds.files.shipped import shipped_folder

SCENARIOS: Final[list[Scenario]] = sorted(
    (read_scenario(path, ask_environment=False) for path in shipped_folder().glob("*.toml")),
    key=lambda scenario: scenario.order,
)
SHIPPED: Final = [scenario.id for scenario in SCENARIOS]

shipped_lessons: Final = cache(catalogue.shipped_lessons)
