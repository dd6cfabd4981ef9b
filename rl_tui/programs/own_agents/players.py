"""Players: each asks an agent of one shape for actions."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from random import Random
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from rl_tui.programs.own_agents.binding import (
    FUNCTION,
    SHAPE_OF,
    AgentShape,
    Style,
    bind,
    bound_roles,
    constructor_arguments,
    role_of,
)
from rl_tui.programs.own_agents.loading import AgentPlace

# A player for each shape


Mask = npt.NDArray[np.int8] | None
"""1 for each available action, `[A]`, or None for all."""


class Happened(NamedTuple):
    """One step. `mask` has the available actions in `next_state`."""

    state: int
    action: int
    reward: float
    next_state: int
    terminated: bool
    truncated: bool
    mask: Mask = None


class AgentPlayer(ABC):
    """An agent in the loop."""

    @abstractmethod
    def begin(self, state: int, mask: Mask) -> Any:
        """Begin an episode and return its first action."""

    @abstractmethod
    def after(self, step: Happened) -> Any:
        """Learn from `step` and return the next action, irrelevant after an end."""

    def end(self, episode: int) -> None:  # noqa: B027
        """End the episode `episode`, from 0."""


class _LegalActions:
    """Berkeley's `actionFn`: the actions of the current state, () after the end."""

    def __init__(self, actions: int) -> None:
        self._all = tuple(range(actions))
        self._known: dict[int, tuple[int, ...]] = {}
        self._ended_in: int | None = None

    def __call__(self, state: Any) -> tuple[int, ...]:
        """Return the actions in `state`, all if it was never entered."""
        return () if state == self._ended_in else self._known.get(state, self._all)

    def enter(self, state: int, mask: Mask, *, terminated: bool = False) -> None:
        self._ended_in = state if terminated else None
        if mask is not None and not terminated:
            self._known[state] = tuple(np.flatnonzero(mask).tolist())


class _MethodsPlayer(AgentPlayer):
    """An object with methods to choose and to learn. It may ask `legal` for the available actions."""

    def __init__(self, agent: Any, shape: AgentShape, env: Any, legal: _LegalActions) -> None:
        self._env, self._either, self._legal = env, shape.done_is_either, legal
        self._choose = bind(getattr(agent, shape.choose), shape.choose, shape.roles[shape.choose])
        update = getattr(agent, shape.update)
        self._update = bind(update, shape.update, shape.roles[shape.update])
        self._looks_ahead = (
            "next_action" in bound_roles(update, shape.update, shape.roles[shape.update]).values()
        )
        decay = getattr(agent, "decay_epsilon", None) if "decay_epsilon" in shape.roles else None
        self._decay = bind(decay, "decay_epsilon", shape.roles["decay_epsilon"]) if callable(decay) else None
        self._episode = 0

    def begin(self, state: int, mask: Mask) -> Any:
        self._legal.enter(state, mask)
        return self._choose({"env": self._env, "state": state, "episode": self._episode})

    def after(self, step: Happened) -> Any:
        self._legal.enter(step.next_state, step.mask, terminated=step.terminated)
        over = step.terminated or step.truncated
        given = step._asdict() | {"env": self._env, "done": over if self._either else step.terminated}
        if self._looks_ahead:
            given["next_action"] = self.begin(step.next_state, step.mask)
            self._update(given)
            return given["next_action"]
        self._update(given)
        return None if over else self.begin(step.next_state, step.mask)

    def end(self, episode: int) -> None:
        if self._decay is not None:
            self._decay({"episode": episode})
        self._episode = episode + 1


class _GluePlayer(AgentPlayer):
    """An agent in RL-Glue's shape. `agent_end` is called only after a terminal step."""

    def __init__(self, agent: Any) -> None:
        roles = SHAPE_OF[Style.RL_GLUE].roles
        self._start, self._step, self._end = (
            bind(getattr(agent, name), name, roles[name])
            for name in ("agent_start", "agent_step", "agent_end")
        )

    def begin(self, state: int, mask: Mask) -> Any:
        return self._start({"state": state})

    def after(self, step: Happened) -> Any:
        if step.terminated:
            return self._end({"reward": step.reward})
        # also at a truncation, so that the last step is learned; the returned action is never taken
        return self._step({"reward": step.reward, "state": step.next_state})


class _FunctionPlayer(AgentPlayer):
    """An ε-greedy policy around a function that updates the table `q`, `[S, A]`, or returns another."""

    def __init__(
        self, update: Callable[..., Any], name: str, shape: tuple[int, int], settings: GivenSettings
    ) -> None:
        numbers = settings.numbers
        self.q: Any = np.full(shape, float(numbers.get("initial_q", 0.0)))
        self._shape = shape
        left_to_defaults = {"alpha", "gamma"}.difference(settings.given)
        self._roles = tuple(bound_roles(update, name, FUNCTION.roles[""], left_to_defaults).items())
        self._looks_ahead = any(role == "next_action" for _, role in self._roles)
        self._update, self._numbers, self._random = update, numbers, Random(f"{settings.seed} policy")
        self._all = range(shape[1])
        self._epsilon = numbers["epsilon"]

    def begin(self, state: int, mask: Mask) -> int:
        legal = self._all if mask is None or not mask.any() else np.flatnonzero(mask).tolist()
        if self._random.random() < self._epsilon:
            return self._random.choice(legal)
        row = np.asarray(self.q[state], float).tolist()
        best = max(row[action] for action in legal)
        ties = [action for action in legal if row[action] == best] or legal  # none if a value is not a number
        return self._random.choice(ties)

    def after(self, step: Happened) -> Any:
        ahead = self.begin(step.next_state, step.mask) if self._looks_ahead else None
        given = {"q": self.q, "done": step.terminated, "next_action": ahead}
        values = {**step._asdict(), **self._numbers, **given}
        returned = self._update(**{parameter: values[role] for parameter, role in self._roles})
        if np.shape(returned) == self._shape:
            self.q = returned
        return self.begin(step.next_state, step.mask) if ahead is None else ahead

    def end(self, episode: int) -> None:
        least, decay = self._numbers.get("epsilon_min", 0.0), self._numbers.get("epsilon_decay", 0.0)
        if decay > 0.0:
            start = self._numbers["epsilon"]
            self._epsilon = least + (start - least) * math.exp(-decay * (episode + 1))


# Making the agent


_IN_INFO: Final = frozenset({"alpha", "gamma", "epsilon"})


@dataclass(frozen=True, slots=True)
class GivenSettings:
    """Settings of an agent, by role. `defaults` has alpha, gamma and epsilon. `episodes` is None for a number
    of steps.
    """

    given: Mapping[str, float]
    defaults: Mapping[str, float]
    episodes: int | None
    seed: int

    @property
    def small_seed(self) -> int:
        """The seed in 32 bits, the limit of NumPy's legacy generators."""
        return self.seed % 2**32

    @property
    def numbers(self) -> dict[str, float]:
        """Numbers for parameters without a default."""
        return {**self.defaults, **self.given}


class ReadyAgent(NamedTuple):
    """The agent (for a function its player), the player, and given numbers that it does not use."""

    agent: Any
    player: AgentPlayer
    unused: frozenset[str]


def ready_agent(built: Any, place: AgentPlace, env: Any, settings: GivenSettings) -> ReadyAgent:
    """Make the agent. Raises UserError for unbound parameters, and any exception of the constructor."""
    sizes = int(env.observation_space.n), int(env.action_space.n)
    if place.style == Style.FUNCTION:
        return _of_function(built, place.name, sizes, settings)
    shape, legal = place.shape, _LegalActions(sizes[1])
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
    if place.style == Style.BERKELEY and not hasattr(agent, "getLegalActions"):
        agent.getLegalActions = legal
    if place.style == Style.RL_GLUE:
        if hasattr(agent, "agent_init"):
            bind(agent.agent_init, "agent_init", shape.roles["agent_init"])(surroundings)
            unused -= _IN_INFO
        return ReadyAgent(agent, _GluePlayer(agent), unused)
    return ReadyAgent(agent, _MethodsPlayer(agent, shape, env, legal), unused)


def _of_function(update: Any, name: str, sizes: tuple[int, int], settings: GivenSettings) -> ReadyAgent:
    function = _FunctionPlayer(update, name, sizes, settings)
    taken = bound_roles(update, name, FUNCTION.roles[""]).values()
    return ReadyAgent(function, function, frozenset(settings.given) & {"alpha", "gamma"} - set(taken))


def _agent_info(sizes: tuple[int, int], settings: GivenSettings) -> dict[str, float | int]:
    numbers = settings.numbers
    return {
        "num_states": sizes[0],
        "num_actions": sizes[1],
        "epsilon": numbers["epsilon"],
        "step_size": numbers["alpha"],
        "discount": numbers["gamma"],
        "seed": settings.small_seed,
    }
