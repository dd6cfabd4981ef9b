"""Running an agent that has no loop of its own, in one of our scenarios."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rl_tui.lab.own_agents.agent_loop import AgentSettings, learn, make_scenario
from rl_tui.lab.own_agents.loading import load_module, the_agent
from rl_tui.lab.own_agents.stand_ins import offer_stand_ins
from rl_tui.lab.programs.child.source import read_script


def run_agent(said: Mapping[str, Any]) -> None:
    """Let the agent that is ``said`` learn to its end.

    ``gymnasium.make`` is the watched one by now. Raises UserError where the file has no such agent, or it
    cannot be bound, and whatever the agent raises.
    """
    path = Path(said["path"])
    script = read_script(path)
    place = the_agent(script.tree, path, said["agent"])
    offer_stand_ins(place.style)
    sys.argv = [said["path"], *said["arguments"]]
    built = getattr(load_module(script.code, path), place.name)
    settings = AgentSettings(said["hyperparameters"], said["defaults"], said["episodes"], said["seed"])
    learn(built, place, make_scenario(said["scenario"], said["scenario_seed"]), settings)
