"""An agent made from its class or function, with what it asks for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np

from rl_tui.lab.own_agents.binding import bind, bound_roles, constructor_arguments, role_of
from rl_tui.lab.own_agents.loading import AgentPlace
from rl_tui.lab.own_agents.players import (
    AgentPlayer,
    BerkeleyPlayer,
    FunctionPlayer,
    GluePlayer,
    LegalActions,
    MethodsPlayer,
)
from rl_tui.lab.own_agents.shapes import FUNCTION, SHAPE_OF, Style

_IN_INFO: Final = frozenset({"alpha", "gamma", "epsilon"})
"""The numbers that RL-Glue's ``agent_info`` holds."""


@dataclass(frozen=True, slots=True)
class GivenSettings:
    """With what an agent learns.

    ``given`` are numbers by role that a person gave, ``defaults`` those of the scenario, which hold alpha,
    gamma and epsilon at least. ``episodes`` is None where the number of steps ends it.
    """

    given: Mapping[str, float]
    defaults: Mapping[str, float]
    episodes: int | None
    seed: int

    @property
    def small_seed(self) -> int:
        """The seed in 32 bits: NumPy's legacy generators, which many agents use, take no more."""
        return self.seed % 2**32

    @property
    def numbers(self) -> dict[str, float]:
        """What holds by role for who has no default of its own."""
        return {**self.defaults, **self.given}


class ReadyAgent(NamedTuple):
    """The agent, what plays it, and which of the given numbers, by role, it does not take.

    Of a bare function the first two are the same.
    """

    agent: Any
    player: AgentPlayer
    unused: frozenset[str]


def ready_agent(built: Any, place: AgentPlace, env: Any, settings: GivenSettings) -> ReadyAgent:
    """Make the agent of ``built``, the class or function at ``place``, for ``env``.

    Raises UserError, naming all that cannot be bound, and whatever its constructor raises.
    """
    sizes = int(env.observation_space.n), int(env.action_space.n)
    if place.style == Style.FUNCTION:
        return _of_function(built, place.name, sizes, settings)
    shape, legal = SHAPE_OF[place.style], LegalActions(sizes[1])
    surroundings = {
        "env": env,
        "action_space": env.action_space,
        "observation_space": env.observation_space,
        "states": sizes[0],
        "actions": sizes[1],
        "legal_actions": legal,
        "seed": settings.small_seed,
        "generator": np.random.default_rng(settings.seed),
        "episodes": settings.episodes or 0,
        "agent_info": _agent_info(sizes, settings),
    }
    arguments = constructor_arguments(built, place.name, surroundings, settings.given, settings.defaults)
    unused = frozenset(settings.given) - {role_of(name) for name in arguments}
    agent = built(**arguments)
    if place.style == Style.BERKELEY:
        if not hasattr(agent, "getLegalActions"):
            agent.getLegalActions = legal
        return ReadyAgent(agent, BerkeleyPlayer(agent, legal), unused)
    if place.style == Style.RL_GLUE:
        if hasattr(agent, "agent_init"):
            bind(agent.agent_init, "agent_init", shape.roles["agent_init"])(surroundings)
            unused -= _IN_INFO
        return ReadyAgent(agent, GluePlayer(agent), unused)
    return ReadyAgent(agent, MethodsPlayer(agent, shape, env), unused)


def _of_function(update: Any, name: str, sizes: tuple[int, int], settings: GivenSettings) -> ReadyAgent:
    function = FunctionPlayer(update, name, sizes, settings.numbers, settings.given, settings.seed)
    taken = bound_roles(update, name, FUNCTION.roles[""]).values()
    return ReadyAgent(function, function, frozenset(settings.given) & {"alpha", "gamma"} - set(taken))


def _agent_info(sizes: tuple[int, int], settings: GivenSettings) -> dict[str, float | int]:
    """Return what RL-Glue's ``agent_init`` is given."""
    numbers = settings.numbers
    return {
        "num_states": sizes[0],
        "num_actions": sizes[1],
        "epsilon": numbers["epsilon"],
        "step_size": numbers["alpha"],
        "discount": numbers["gamma"],
        "seed": settings.small_seed,
    }
