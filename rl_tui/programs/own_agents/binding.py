"""The shapes of users' agents, and the binding of parameters by name."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Container, Iterable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path
from typing import Any, Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line, shown

# Shapes of an agent


class Style(StrEnum):
    """Ids of the shapes."""

    GYMNASIUM = "gymnasium"
    UDACITY = "udacity"
    BERKELEY = "berkeley"
    RL_GLUE = "rl-glue"
    FUNCTION = "function"


@dataclass(frozen=True, slots=True)
class AgentShape:
    """A shape of agents.

    Attributes:
        choose: Method that chooses an action.
        update: Method that learns.
        roles: Roles of `NAMES` that each method's parameters may have.
        done_is_either: True if `done` is also true at a truncation. A missing bootstrap there is then not the
            author's fault.
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
"""Roles that every bare function must have, which distinguish it from other functions."""
OF_LEARNING: Final = ("state", "action", "reward", "next_state")
"""Roles that the parameters of a learning method must have, if it has another name than `update`."""
CHOOSING: Final = (
    *("get_action", "choose_action", "select_action", "sample_action", "take_action", "pick_action"),
    *("get_next_action", "act", "choose"),
)
LEARNING: Final = (
    *("update", "learn", "train", "step", "update_q", "update_q_table", "update_q_value", "update_table"),
    *("update_q_values", "learn_step"),
)
"""Names of methods in Gymnasium's shape, the usual name first."""


def style_of_methods(methods: frozenset[str]) -> Style | None:
    """Return the style of a class with these `methods`."""
    return next((each.style for each in SHAPES if each.methods and methods.issuperset(each.methods)), None)


def shape_with(choose: str, update: str) -> AgentShape:
    """Return Gymnasium's shape with other names of its methods."""
    usual = SHAPE_OF[Style.GYMNASIUM]
    roles = {choose: usual.roles[usual.choose], update: usual.roles[usual.update]}
    decay = {"decay_epsilon": usual.roles["decay_epsilon"]}
    return replace(usual, methods=(choose, update), choose=choose, update=update, roles={**roles, **decay})


def shapes_in_words() -> str:
    """List the methods of each style, as a sentence."""
    styles = "; ".join(f"{shape.style} has {shape.signatures}" for shape in SHAPES)
    return f"An agent needs the methods of one of these styles: {styles}"


# Binding by name


NAMES: Final[Mapping[str, tuple[str, ...]]] = {
    "state": (
        *("s", "state", "obs", "observation", "current_state", "prev_state", "last_state", "st", "s0"),
        *("state1", "old_state", "old_obs", "discrete_obs", "cur_state"),
    ),
    "action": ("a", "action", "act", "last_action", "prev_action", "a0", "action1"),
    "reward": ("r", "reward", "rew"),
    "next_state": (
        *("s_next", "next_s", "next_state", "new_state", "state_next", "s_prime", "s2", "sp", "s_", "state_"),
        *("next_obs", "new_obs", "obs_next", "next_observation", "new_observation", "observation_", "sn"),
        *("successor", "state2", "following_state", "next_discrete_obs"),
    ),
    "next_action": (
        *("a_next", "next_a", "next_action", "new_action", "a_prime", "a2", "ap", "a_", "action_", "action2"),
    ),
    "terminated": ("terminated", "terminal", "term", "is_terminal"),
    "truncated": ("truncated", "trunc"),
    "done": ("done", "is_done", "d", "finished", "over"),
    "episode": ("episode", "i_episode", "episode_number"),
    "q": ("q", "q_table", "q_values", "qtable", "table", "action_values"),
    "agent_info": ("agent_info", "agent_init_info", "info"),
    "env": ("env", "environment"),
    "action_space": ("action_space",),
    "observation_space": ("observation_space", "obs_space"),
    "actions": (
        *("n_actions", "na", "num_actions", "action_size", "n_action", "action_dim", "number_of_actions"),
        *("no_of_actions", "action_space_size", "action_n"),
    ),
    "states": (
        *("n_states", "ns", "num_states", "state_size", "n_state", "state_dim", "number_of_states"),
        *("no_of_states", "observation_size", "state_space_size", "n_observations", "state_n"),
    ),
    "legal_actions": ("actionfn", "action_fn"),
    "alpha": ("alpha", "learning_rate", "lr", "step_size"),
    "gamma": ("gamma", "discount_factor", "discount", "discount_rate"),
    "epsilon": (
        *("epsilon", "initial_epsilon", "exploration_rate", "eps", "epsilon_start", "start_epsilon"),
        *("eps_start", "initial_exploration"),
    ),
    "epsilon_decay": ("epsilon_decay", "eps_decay", "epsilon_decay_rate", "exploration_decay", "decay_rate"),
    "epsilon_min": (
        *("epsilon_min", "final_epsilon", "min_epsilon", "eps_min", "epsilon_end", "eps_end", "min_eps"),
        *("epsilon_final", "min_exploration_rate"),
    ),
    "initial_q": ("initial_q", "initial_value", "q_init", "init_q"),
    "seed": ("seed", "random_seed", "random_state"),
    "generator": ("rng", "generator", "random_generator"),
    "episodes": ("n_episodes", "num_training", "numtraining", "num_episodes", "episodes", "max_episodes"),
}
"""Lower-case names of each role, the clearest first. Underscores are optional."""

_ROLE_OF: Final = {name: role for role, names in NAMES.items() for name in names}
_WITHOUT_UNDERSCORES: Final = {
    name.replace("_", ""): role for name, role in _ROLE_OF.items() if "_" in name.strip("_")
}
_NAMED: Final = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
_LONGEST: Final = 40


def role_of(name: str) -> str:
    """Return the role of a parameter, or "". Case and underscores do not matter."""
    small = name.lower()
    return _ROLE_OF.get(small) or _WITHOUT_UNDERSCORES.get(small.replace("_", ""), "")


def _signature_of(called: Callable[..., Any], name: str) -> inspect.Signature:
    try:
        return inspect.signature(called)
    except (TypeError, ValueError) as fault:
        raise UserError(f"{name}: its parameters cannot be read ({one_line(str(fault), 80)})") from fault


def bound_roles(
    called: Callable[..., Any], name: str, known: Iterable[str], left_to_defaults: Container[str] = ()
) -> dict[str, str]:
    """Return the role of each parameter that must be given. Raises UserError with all that cannot be bound.

    A default is kept if the role is not in `known`, or is in `left_to_defaults`.
    """
    known, roles, unknown = frozenset(known), dict[str, str](), []
    for parameter in _signature_of(called, name).parameters.values():
        role, has_default = role_of(parameter.name), parameter.default is not inspect.Parameter.empty
        if role in known and parameter.kind in _NAMED and not (has_default and role in left_to_defaults):
            roles[parameter.name] = role
        elif not (has_default or parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD)):
            unknown.append(parameter.name)
    if unknown:
        raise UserError(_cannot_bind(name, unknown, known))
    return roles


def bind(called: Callable[..., Any], name: str, known: Iterable[str]) -> Callable[[Mapping[str, Any]], Any]:
    """Return a function that calls `called` with values by role. Raises UserError as `bound_roles`."""
    roles = tuple(bound_roles(called, name, known).items())

    def call(values: Mapping[str, Any]) -> Any:
        return called(**{parameter: values[role] for parameter, role in roles})

    return call


def constructor_arguments(
    called: Callable[..., Any],
    name: str,
    surroundings: Mapping[str, Any],
    given: Mapping[str, float],
    defaults: Mapping[str, float],
) -> dict[str, Any]:
    """Return the arguments for an agent's constructor by parameter.

    A constructor with `**arguments` receives only numbers and the legal actions. Raises UserError with all
    parameters that cannot be bound.

    Args:
        called: The constructor.
        name: Name of the agent.
        surroundings: Environment, sizes and seed by role.
        given: Numbers from the user by role, which have precedence.
        defaults: Numbers by role for parameters without a default.
    """
    values, unknown = dict[str, Any](), []
    parameters = _signature_of(called, name).parameters
    for parameter in parameters.values():
        role, has_default = role_of(parameter.name), parameter.default is not inspect.Parameter.empty
        if parameter.kind is inspect.Parameter.VAR_KEYWORD:
            values |= _arguments_of_any_name({**defaults, **given}, surroundings, parameters)
        elif parameter.kind not in _NAMED:
            continue
        elif role in surroundings and not (has_default and role == "episodes"):
            values[parameter.name] = surroundings[role]
        elif role in given:
            values[parameter.name] = given[role]
        elif role in defaults and not has_default:
            values[parameter.name] = defaults[role]
        elif not has_default:
            unknown.append(parameter.name)
    if unknown:
        raise UserError(_cannot_bind(f"{name}.__init__", unknown, (*surroundings, *defaults)))
    return values


def _arguments_of_any_name(
    numbers: Mapping[str, float], surroundings: Mapping[str, Any], named: Iterable[str]
) -> dict[str, Any]:
    usual = {
        "actionFn": surroundings["legal_actions"],
        "alpha": numbers["alpha"],
        "epsilon": numbers["epsilon"],
        "gamma": numbers["gamma"],
        "numTraining": surroundings["episodes"],
    }
    roles = {role_of(name) for name in named}
    return {name: value for name, value in usual.items() if role_of(name) not in roles}


def _cannot_bind(name: str, unknown: Iterable[str], known: Iterable[str]) -> str:
    names = ", ".join(one_line(each, _LONGEST) for each in unknown)
    understood = ", ".join(NAMES[role][0] for role in NAMES if role in frozenset(known))
    return (
        f"{name}: unknown parameter {names}; give it a default, or rename it to one of {understood}. "
        f"{shapes_in_words()}"
    )


# Skeletons without the update


_FOLDER = Path(__file__).parent / "skeletons"


def skeleton(style: Style) -> str:
    """Return an agent in `style` without its update."""
    return (_FOLDER / f"{style.value}.py.txt").read_text(encoding="utf-8")


def write_skeleton(path: Path, style: Style) -> None:
    """Write a skeleton to a new file. Raises UserError if that fails."""
    from rl_tui.common.files import write_new

    if path.suffix != ".py":
        raise UserError(f"{shown(str(path))}: expected the name of a Python file, one that ends in .py")
    write_new(path, skeleton(style))
