"""The episode loop around an agent that has none."""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import count
from typing import Any

import gymnasium
import numpy as np

from rl_tui.common.errors import UserError
from rl_tui.common.findings import shown
from rl_tui.lab.own_agents.binding import bind, constructor_arguments
from rl_tui.lab.own_agents.loading import AgentPlace
from rl_tui.lab.own_agents.players import (
    AgentPlayer,
    BerkeleyPlayer,
    FunctionPlayer,
    GluePlayer,
    Happened,
    LegalActions,
    MethodsPlayer,
)
from rl_tui.lab.own_agents.shapes import SHAPE_OF, Style


@dataclass(frozen=True, slots=True)
class AgentSettings:
    """With what an agent learns.

    ``given`` are numbers by role that a person gave, ``defaults`` those of the scenario, which hold alpha,
    gamma and epsilon at least. ``episodes`` is None where the number of steps ends it.
    """

    given: Mapping[str, float]
    defaults: Mapping[str, float]
    episodes: int | None
    seed: int


def make_scenario(scenario: str, seed: int) -> Any:
    """Return ``scenario``, an id or a path, as an environment: by ``gymnasium.make``, as it is by then."""
    from rl_tui.worlds.environments.registration import spec_of

    return gymnasium.make(spec_of(scenario), scenario_seed=seed, disable_env_checker=True)


def learn(built: Any, place: AgentPlace, env: Any, settings: AgentSettings) -> None:
    """Let the agent ``built``, the class or function at ``place``, learn in ``env`` for its episodes.

    Raises UserError where it cannot be bound, or returns what is no action, and whatever the agent raises.
    """
    random.seed(settings.seed)
    np.random.seed(settings.seed)
    env.action_space.seed(settings.seed)
    agent, player = _ready(built, place, env, settings)
    actions, method = int(env.action_space.n), _choosing(place)
    # Looking for the table begins at the names of this frame: `agent` is one of them
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


def _ready(built: Any, place: AgentPlace, env: Any, settings: AgentSettings) -> tuple[Any, AgentPlayer]:
    """Return the agent, made, and what plays it; of a bare function both are the same."""
    shape, sizes = SHAPE_OF[place.style], (int(env.observation_space.n), int(env.action_space.n))
    if place.style == Style.FUNCTION:
        numbers = {**settings.defaults, **settings.given}
        function = FunctionPlayer(built, place.name, sizes, numbers, settings.given, settings.seed)
        return function, function
    legal = LegalActions(sizes[1])
    surroundings = {
        "env": env,
        "action_space": env.action_space,
        "observation_space": env.observation_space,
        "states": sizes[0],
        "actions": sizes[1],
        "legal_actions": legal,
        "seed": settings.seed,
        "generator": np.random.default_rng(settings.seed),
        "episodes": settings.episodes or 0,
        "agent_info": _agent_info(sizes, settings),
    }
    arguments = constructor_arguments(built, place.name, surroundings, settings.given, settings.defaults)
    agent = built(**arguments)
    if place.style == Style.BERKELEY:
        if not hasattr(agent, "getLegalActions"):
            agent.getLegalActions = legal
        return agent, BerkeleyPlayer(agent, legal)
    if place.style == Style.RL_GLUE:
        if hasattr(agent, "agent_init"):
            bind(agent.agent_init, "agent_init", shape.roles["agent_init"])(surroundings)
        return agent, GluePlayer(agent)
    return agent, MethodsPlayer(agent, shape, env)


def _agent_info(sizes: tuple[int, int], settings: AgentSettings) -> dict[str, float | int]:
    """Return what RL-Glue's ``agent_init`` is given."""
    numbers = {**settings.defaults, **settings.given}
    return {
        "num_states": sizes[0],
        "num_actions": sizes[1],
        "epsilon": numbers["epsilon"],
        "step_size": numbers["alpha"],
        "discount": numbers["gamma"],
        "seed": settings.seed,
    }


def _choosing(place: AgentPlace) -> str:
    return SHAPE_OF[place.style].choose or place.name


def _as_action(found: Any, actions: int, method: str) -> int:
    """Return ``found`` as a whole number. Raises UserError where it is no action."""
    try:
        action = int(found)
        if action == found and 0 <= action < actions:
            return action
    except (TypeError, ValueError, OverflowError):
        pass
    text = "None" if found is None else shown(found)
    raise UserError(f"{method} returned {text}; expected an action: a whole number from 0 to {actions - 1}")
