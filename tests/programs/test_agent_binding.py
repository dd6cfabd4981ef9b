"""The arguments of an agent, matched by name."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import pytest

from rl_tui.common.errors import UserError
from rl_tui.programs.own_agents.binding import NAMES, bind, bound_roles, constructor_arguments, role_of

SURROUNDINGS = {
    "env": "the environment",
    "action_space": "its actions",
    "observation_space": "its states",
    "states": 16,
    "actions": 4,
    "legal_actions": len,
    "seed": 7,
    "generator": "a generator",
    "episodes": 50,
    "agent_info": {},
}
DEFAULTS = {
    "alpha": 0.1,
    "gamma": 0.99,
    "epsilon": 0.2,
    "epsilon_decay": 0.0,
    "epsilon_min": 0.2,
    "initial_q": 0.0,
}


def made(constructor: Callable[..., Any], **given: float) -> dict[str, Any]:
    return constructor_arguments(constructor, "Agent", SURROUNDINGS, given, DEFAULTS)


@pytest.mark.parametrize(
    ("name", "role"),
    [
        *(("nextState", "next_state"), ("next_obs", "next_state"), ("s_prime", "next_state"), ("Q", "q")),
        *(("nA", "actions"), ("n_states", "states"), ("actionFn", "legal_actions"), ("lr", "alpha")),
        *(("discountFactor", "gamma"), ("initial_epsilon", "epsilon"), ("final_epsilon", "epsilon_min")),
        *(("numTraining", "episodes"), ("colour", ""), ("s", "state"), ("S", "state")),
    ],
)
def test_a_name_says_what_it_is(name: str, role: str) -> None:
    assert role_of(name) == role


def test_no_name_stands_for_two_things() -> None:
    names = [name for names in NAMES.values() for name in names]
    assert len(names) == len(set(names))


def test_what_a_person_gives_goes_before_the_agents_own_default() -> None:
    def constructor(learning_rate: float = 0.5) -> None: ...

    assert made(constructor) == {}
    assert made(constructor, alpha=0.3) == {"learning_rate": 0.3}


def test_what_has_no_default_comes_from_the_scenario() -> None:
    def constructor(epsilon_decay: float, final_epsilon: float, gamma: float) -> None: ...

    assert made(constructor) == {"epsilon_decay": 0.0, "final_epsilon": 0.2, "gamma": 0.99}


def test_sizes_are_those_of_the_world_whatever_the_default() -> None:
    def constructor(state_size: int, nA: int = 6, seed: int = 1) -> None: ...  # noqa: N803

    assert made(constructor) == {"state_size": 16, "nA": 4, "seed": 7}


def test_what_a_base_class_is_handed_on() -> None:
    def constructor(alpha: float = 0.5, **more: Any) -> None: ...

    assert set(made(constructor)) == {"actionFn", "epsilon", "gamma", "numTraining"}
    assert made(constructor, alpha=0.25)["alpha"] == 0.25


def test_all_that_cannot_be_bound_is_named_with_the_shapes() -> None:
    def constructor(colour: str, env: Any, taste: float, smell: str = "of roses") -> None: ...

    with pytest.raises(
        UserError, match=r"Agent\.__init__: .*colour, taste.*gymnasium has get_action"
    ) as raised:
        made(constructor)
    assert "smell" not in str(raised.value)
    assert "\n" not in str(raised.value)


def test_arguments_go_by_name_in_any_order() -> None:
    heard = []

    def update(nextState: int, *, reward: float, action: int, state: int) -> None:  # noqa: N803
        heard.append((state, action, reward, nextState))

    told = {"state": 1, "action": 2, "reward": 3.0, "next_state": 4, "terminated": True}
    bind(update, "update", told)(told)
    assert heard == [(1, 2, 3.0, 4)]


def test_a_parameter_with_a_default_and_another_name_is_left_alone() -> None:
    def update(state: int, verbose: bool = False, *arguments: Any, **more: Any) -> None: ...

    assert bound_roles(update, "update", ["state"]) == {"state": "state"}


def test_a_default_of_its_own_stays_where_nothing_is_given() -> None:
    def update(q: Any, alpha: float = 0.5, gamma: float = 0.9) -> None: ...

    known = ("q", "alpha", "gamma")
    assert bound_roles(update, "update", known, {"alpha"}) == {"q": "q", "gamma": "gamma"}


def test_a_method_that_wants_what_is_not_known_there() -> None:
    def get_action(state: int, reward: float) -> None: ...

    with pytest.raises(UserError, match=re.escape("get_action: unknown parameter reward")):
        bind(get_action, "get_action", ("env", "state"))
