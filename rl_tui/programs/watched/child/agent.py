"""Running an agent that has no loop, in one of our scenarios."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from rl_tui.programs.own_agents.agent_loop import learn, make_scenario
from rl_tui.programs.own_agents.loading import load_module, the_agent
from rl_tui.programs.own_agents.players import GivenSettings
from rl_tui.programs.own_agents.stand_ins import offer_stand_ins
from rl_tui.programs.watched.child.script import read_script
from rl_tui.programs.watched.messages import MessageKind


def run_agent(said: Mapping[str, Any], tell: Callable[..., None]) -> None:
    """Train an agent in a made environment. Raises UserError if it does not fit, or the agent's error."""
    path = Path(said["path"])
    script = read_script(path)
    place = the_agent(script.tree, path, said["agent"])
    offer_stand_ins(place.style, path.stem)
    sys.argv = [said["path"], *said["arguments"]]
    built = getattr(load_module(script.compiled(), path), place.name)
    shape = place.shape
    method = getattr(built, shape.update) if shape.update else built
    tell(
        MessageKind.AGENT,
        name=place.name,
        style=place.style.value,
        file=str(path.absolute()),
        line=getattr(getattr(method, "__code__", None), "co_firstlineno", place.line),
        done_is_either=shape.done_is_either,
    )
    settings = GivenSettings(said["hyperparameters"], said["defaults"], said["episodes"], said["seed"])
    env = make_scenario(said["scenario"], said["scenario_seed"])
    learn(built, place, env, settings, lambda text: tell(MessageKind.NOTE, text=text))
