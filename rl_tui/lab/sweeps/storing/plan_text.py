"""A plan as text, so that a store tells what was to be found out."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line, shown
from rl_tui.common.limits import MOST_SWEEP_CELLS, MOST_SWEEP_EPISODES, MOST_SWEEP_ROWS, MOST_SWEEP_RUNS
from rl_tui.common.words import counted
from rl_tui.lab.sweeps.cells.world_settings import plain_text
from rl_tui.lab.sweeps.plan import LARGEST_SEED, SweepPlan
from rl_tui.lab.sweeps.variation import read_variation
from rl_tui.worlds.files.scenario import scenario_of

_LONGEST_FAULT: Final = 200


def written_plan(plan: SweepPlan) -> str:
    """Return ``plan`` as :func:`read_plan` reads it: JSON, the same for the same plan.

    The world and the defaults of its scenario are part of it, so it can be read without any file.
    """
    return json.dumps(
        {
            "scenario": plan.scenario.id,
            "text": plain_text(plan.scenario),
            "vary": [each.text for each in plan.variations],
            "settings": dict(plan.overrides),
            "episodes": plan.episodes,
            "runs": plan.runs,
            "first_seed": plan.first_seed,
            "random": plan.random,
            "random_seed": plan.random_seed,
        },
        sort_keys=True,
    )


def read_plan(text: str) -> SweepPlan:
    """Return the plan that ``text`` says. Raises UserError where it says none, or its scenario is gone."""
    try:
        said: dict[str, Any] = json.loads(text)
        plan = SweepPlan(
            scenario_of(said["text"], Path(f"{said['scenario']}.toml"), ask_environment=False),
            tuple(map(read_variation, said["vary"])),
            _settings(said["settings"]),
            _whole(said, "episodes", 1, MOST_SWEEP_EPISODES, optional=True),
            _whole(said, "runs", 1, MOST_SWEEP_RUNS) or 0,
            _whole(said, "first_seed", 0, LARGEST_SEED) or 0,
            _whole(said, "random", 1, MOST_SWEEP_CELLS, optional=True),
            _whole(said, "random_seed", 0, LARGEST_SEED) or 0,
        )
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as fault:
        raise UserError(f"this is no plan of a sweep ({one_line(str(fault), _LONGEST_FAULT)})") from fault
    if plan.count * plan.runs > MOST_SWEEP_ROWS:
        raise UserError(
            f"this plan asks for {plan.count:,} cells of {counted(plan.runs, 'run')}; "
            f"at most {MOST_SWEEP_ROWS:,} runs can be drawn: plot a sweep of fewer"
        )
    return plan


def _settings(said: object) -> dict[str, object]:
    """Return the settings that all cells share; whether they can be is for the recipe to say."""
    if not isinstance(said, dict) or not all(isinstance(each, str | int | float) for each in said.values()):
        raise ValueError("settings are no words and numbers")
    return said


def _whole(said: dict[str, Any], name: str, least: int, most: int, *, optional: bool = False) -> int | None:
    value = said[name]
    if value is None and optional:
        return None
    if type(value) is not int or not least <= value <= most:
        raise ValueError(f"{name} is {shown(value)}; expected a whole number from {least} to {most:,}")
    return value
