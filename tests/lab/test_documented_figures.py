"""What the README and docs/ say of learning, counted again."""

from __future__ import annotations

from pathlib import Path
from statistics import median
from typing import Any

import pytest
from recipes import recipe

from rl_tui.lab.experiments.many_runs import many_runs
from rl_tui.lab.experiments.training import Goal

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
README, AGENTS = (
    " ".join((ROOT / name).read_text(encoding="utf-8").split()) for name in ("README.md", "docs/agents.md")
)


def trained(runs: int, episodes: int, **overrides: Any) -> dict[str, Any]:
    return many_runs(recipe("frozenlake", **overrides), runs, Goal(episodes=episodes))


def test_when_the_lake_pays_for_the_first_time() -> None:
    made = trained(200, 400)
    first = made["summary"]["first_reward_episode"]
    assert first["count"] == 200
    assert f"it takes until episode {made['runs'][0]['first_reward_episode']}" in README  # seed 0
    half = median(run["first_reward_episode"] for run in made["runs"])
    assert f"episode {first['mean']:.0f} ± {first['stderr']:.0f}" in README
    assert f"half of them by episode {half:.0f}" in README
    assert f"episode {first['mean']:.0f} ± {first['stderr']:.0f}" in AGENTS
    assert f"half of them by episode {half:.0f}" in AGENTS
