"""The shapes in which people are taught to write an agent, as rows of a table.

An agent has one of them by the methods that it has; it needs no base class.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Final


class Style(StrEnum):
    """The ids of the shapes."""

    GYMNASIUM = "gymnasium"
    UDACITY = "udacity"
    BERKELEY = "berkeley"
    RL_GLUE = "rl-glue"
    FUNCTION = "function"


@dataclass(frozen=True, slots=True)
class AgentShape:
    """One shape.

    ``methods`` are those that tell it: each is there. ``update`` is the one that learns, ``choose`` the one
    that chooses an action. ``roles`` says what the parameters of each method may be, by the roles of
    :data:`rl_tui.lab.own_agents.binding.NAMES`. ``signatures`` is how the shape is shown to people.
    ``done_is_either`` says that its ``done`` is true at a truncation too, so that nothing is bootstrapped
    there: a property of the shape, no fault of who writes in it.
    """

    style: Style
    title: str
    methods: tuple[str, ...]
    choose: str
    update: str
    roles: Mapping[str, tuple[str, ...]]
    signatures: str
    done_is_either: bool = False


_EXPERIENCE: Final = ("state", "action", "reward", "next_state", "terminated", "truncated", "done")

SHAPES: Final = (
    AgentShape(
        Style.GYMNASIUM,
        "the shape of Gymnasium's tutorials",
        ("get_action", "update"),
        "get_action",
        "update",
        {
            "get_action": ("env", "state"),
            "update": (*_EXPERIENCE, "next_action", "env"),
            "decay_epsilon": ("episode",),
        },
        "get_action(obs), update(obs, action, reward, terminated, next_obs), decay_epsilon()",
    ),
    AgentShape(
        Style.UDACITY,
        "the shape of Udacity's course",
        ("select_action", "step"),
        "select_action",
        "step",
        {"select_action": ("state", "episode"), "step": _EXPERIENCE},
        "select_action(state), step(state, action, reward, next_state, done)",
        done_is_either=True,
    ),
    AgentShape(
        Style.BERKELEY,
        "the shape of Berkeley's course",
        ("getAction", "update"),
        "getAction",
        "update",
        {"getAction": ("state",), "update": ("state", "action", "next_state", "reward")},
        "getAction(state), update(state, action, nextState, reward)",
    ),
    AgentShape(
        Style.RL_GLUE,
        "the shape of RL-Glue",
        ("agent_start", "agent_step", "agent_end"),
        "agent_step",
        "agent_step",
        {
            "agent_init": ("agent_info",),
            "agent_start": ("state",),
            "agent_step": ("reward", "state"),
            "agent_end": ("reward",),
        },
        "agent_init(agent_info), agent_start(obs), agent_step(reward, obs), agent_end(reward)",
    ),
    AgentShape(
        Style.FUNCTION,
        "a bare function",
        (),
        "",
        "",
        {"": ("q", *_EXPERIENCE, "next_action", "alpha", "gamma")},
        "update(q, s, a, r, s_next, alpha, gamma)",
    ),
)
SHAPE_OF: Final[Mapping[Style, AgentShape]] = {shape.style: shape for shape in SHAPES}
FUNCTION: Final = SHAPE_OF[Style.FUNCTION]
OF_FUNCTION: Final = ("q", "state", "action", "reward", "next_state")
"""The roles that each parameter list of a bare function has; by them it is told from other functions."""


def style_of_methods(methods: frozenset[str]) -> Style | None:
    """Return the style of a class with these ``methods``, None for none of them."""
    return next((each.style for each in SHAPES if each.methods and methods.issuperset(each.methods)), None)


def shapes_in_words() -> str:
    """Return all shapes as people see them, for messages."""
    return "; ".join(f"{shape.style}: {shape.signatures}" for shape in SHAPES)
