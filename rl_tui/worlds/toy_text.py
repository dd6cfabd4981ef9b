"""Gymnasium environments that carry their transition table (``P``), as finite MDPs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rl_tui.worlds.blackjack import blackjack_world, is_blackjack
from rl_tui.worlds.findings import Finding, one_line
from rl_tui.worlds.limits import LARGEST_NUMBER
from rl_tui.worlds.mdp import Outcome, Transition, tabular_mdp
from rl_tui.worlds.registered import looked_at, reason_of, time_limit_of
from rl_tui.worlds.sizes import check_sizes
from rl_tui.worlds.tolerance import PROBABILITY_TOLERANCE
from rl_tui.worlds.toy_text_layout import Layout, layout_of
from rl_tui.worlds.world import World
from rl_tui.worlds.world_section import WorldRefusedError

if TYPE_CHECKING:
    from gymnasium import Env

_ENTRY: Final = 4  # probability, next state, reward, terminated


class NoTableError(WorldRefusedError):
    """The environment may be sound, but has no transition table that can be read."""


def _refusal(key: str, found: str, expected: str) -> WorldRefusedError:
    return WorldRefusedError(Finding((key,), found, expected))


def _no_table(found: str, expected: str) -> NoTableError:
    return NoTableError(Finding(("id",), found, expected))


def world_of(name: str, kwargs: Mapping[str, Any], *, computed: bool = False) -> World:
    """Return the world of the registered environment ``name`` made with ``kwargs``.

    States are called "0", "1", … where the environment has no better names; the time limit is the
    environment's own. ``computed`` also takes tables that are worked out here from the rules: that of
    Blackjack. Raises WorldRefusedError where it is not registered, cannot be made, has no start, rewards
    beyond ±1e12 or a table that contradicts itself; NoTableError where it is no finite MDP with a table that
    can be read.
    """
    with looked_at(name, kwargs) as environment:
        if computed and is_blackjack(environment.unwrapped):
            return blackjack_world(environment.unwrapped, time_limit_of(environment))
        states, actions = _sizes(name, environment)
        check_sizes(name, states, actions, "kwargs" if kwargs else "id")
        table = _table(name, environment, states, actions)
        start = _start(name, environment, states)
        limit = time_limit_of(environment)
        layout = layout_of(environment.unwrapped, states, actions, start)
    try:
        mdp = tabular_mdp(
            list(layout.state_names),
            layout.action_names,
            (
                Transition(state, action, _outcomes(table[state][action], layout, state, action))
                for state in range(states)
                for action in range(actions)
            ),
            start,
            limit,
        )
    except Exception as error:  # a table is an environment's own code too, and its numbers may be anything
        # not "no table": to step what contradicts itself would only hide that
        told = isinstance(error, TypeError | ValueError)
        found = f"a table in which {one_line(str(error), 200) if told else reason_of(error)}"
        expected = (
            "a sound transition table, or table = false in a scenario file, which steps it all the same"
        )
        raise _refusal("kwargs" if kwargs else "id", found, expected) from error
    largest = float(mdp.reward[np.argmax(np.abs(mdp.reward))])
    if abs(largest) > LARGEST_NUMBER:
        found = f"a reward of {largest:g}"
        raise _refusal("kwargs" if kwargs else "id", found, f"rewards within ±{LARGEST_NUMBER:g}")
    return World(mdp, layout.grid)


def _sizes(name: str, environment: Env[Any, Any]) -> tuple[int, int]:
    from gymnasium.spaces import Discrete

    sizes = []
    for what, space in (("states", environment.observation_space), ("actions", environment.action_space)):
        if not isinstance(space, Discrete) or space.start != 0:
            found = f"{name}, whose {what} are {type(space).__name__}"
            raise _no_table(found, f"discrete {what}, counted from 0")
        sizes.append(int(space.n))
    return sizes[0], sizes[1]


def _table(name: str, environment: Env[Any, Any], states: int, actions: int) -> Any:
    """Return P: ``P[state][action]`` is a list of (probability, next state, reward, terminated)."""
    table = getattr(environment.unwrapped, "P", None)
    if table is None:
        raise _no_table(f"{name}, which has no transition table", "one that has")
    try:
        outcomes = [table[s][a] for s in range(states) for a in range(actions)]
        complete = all(len(entries) > 0 for entries in outcomes)
        readable = all(len(entry) == _ENTRY for entries in outcomes for entry in entries)
    except (LookupError, TypeError):
        complete = readable = False
    if not complete:
        raise _no_table(f"{name}, whose table has gaps", "outcomes for every state and action")
    if not readable:
        raise _no_table(f"{name}, whose table has another form", "(probability, state, reward, terminated)")
    return table


def _start(name: str, environment: Env[Any, Any], states: int) -> dict[int, float]:
    distribution = getattr(environment.unwrapped, "initial_state_distrib", None)
    if distribution is None:
        raise _no_table(f"{name}, which does not tell its start", "initial_state_distrib")
    start = np.asarray(distribution, dtype=np.float64)
    sound = start.shape == (states,) and bool(np.all(start >= 0.0))
    if not sound or not abs(start.sum() - 1.0) <= PROBABILITY_TOLERANCE:
        raise _refusal("kwargs", "a world without a start", f"probabilities to start in the {states} states")
    return {state: float(probability) for state, probability in enumerate(start) if probability > 0.0}


def _outcomes(entries: Sequence[Any], layout: Layout, state: int, action: int) -> list[Outcome]:
    """Return the outcomes of one pair, kept apart even where they land alike."""
    return [
        Outcome(
            probability=float(probability),
            next_state=int(next_state),
            reward=float(reward),
            terminated=bool(terminated),
            action=layout.happened(state, action, place, len(entries), int(next_state)),
        )
        for place, (probability, next_state, reward, terminated) in enumerate(entries)
    ]
