"""A plan as text, so that a store tells what was to be found out."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from rl_tui.common.errors import UserError
from rl_tui.lab.sweeps.cells.world_settings import plain_text
from rl_tui.lab.sweeps.plan import SweepPlan
from rl_tui.lab.sweeps.variation import read_variation
from rl_tui.worlds.files.scenario import scenario_of


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
        return SweepPlan(
            scenario_of(said["text"], Path(f"{said['scenario']}.toml"), ask_environment=False),
            tuple(map(read_variation, said["vary"])),
            said["settings"],
            said["episodes"],
            said["runs"],
            said["first_seed"],
            said["random"],
            said["random_seed"],
        )
    except (ValueError, KeyError, TypeError) as fault:
        raise UserError(f"this is no plan of a sweep ({fault})") from fault
