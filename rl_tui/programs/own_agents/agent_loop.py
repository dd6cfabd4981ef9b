"""The episode loop around an agent that has none."""

from __future__ import annotations

import random
from collections.abc import Callable
from itertools import count
from typing import Any

import gymnasium
import numpy as np

from rl_tui.common.errors import UserError
from rl_tui.common.findings import shown
from rl_tui.programs.own_agents.loading import AgentPlace
from rl_tui.programs.own_agents.players import GivenSettings, Happened, ready_agent


def make_scenario(scenario: str, seed: int) -> Any:
    """Return the environment of an id or a path."""
    from rl_tui.worlds.environments.registration import spec_of

    return gymnasium.make(spec_of(scenario), scenario_seed=seed, disable_env_checker=True)


def learn(
    built: Any, place: AgentPlace, env: Any, settings: GivenSettings, note: Callable[[str], None]
) -> None:
    """Train an agent in our loop, and `note` settings without effect. Raises what the agent raises."""
    random.seed(settings.seed)
    np.random.seed(settings.small_seed)
    env.action_space.seed(settings.seed)
    agent, player, unused = ready_agent(built, place, env, settings)
    for name in sorted(unused):
        note(f"--{name.replace('_', '-')} has no effect: {place.name} has no such parameter")
    actions, method = int(env.action_space.n), place.shape.choose or place.name
    # the search for the table starts at the names in this frame, such as `agent`
    for episode in count() if settings.episodes is None else range(settings.episodes):
        state, info = env.reset(seed=settings.seed) if episode == 0 else env.reset()
        action = player.begin(state, info.get("action_mask"))
        over = False
        while not over:
            if type(action) is not int or not 0 <= action < actions:
                action = _as_action(action, actions, method)
            after, reward, terminated, truncated, info = env.step(action)
            action = player.after(
                Happened(state, action, float(reward), after, terminated, truncated, info.get("action_mask"))
            )
            state, over = after, terminated or truncated
        player.end(episode)
    del agent


def _as_action(found: Any, actions: int, method: str) -> int:
    try:
        action = int(found)
        if action == found and 0 <= action < actions:
            return action
    except (TypeError, ValueError, OverflowError):
        pass
    text = "None" if found is None else shown(found)
    raise UserError(f"{method} returned {text}; expected an action: a whole number from 0 to {actions - 1}")
