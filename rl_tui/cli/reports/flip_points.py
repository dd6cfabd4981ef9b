"""Every γ at which the optimal actions change, as JSON and as text."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

from rl_tui.cli.output import columns, number
from rl_tui.common.words import counted
from rl_tui.tui.draw.action_order import shown_pairs
from rl_tui.worlds.mdp.space import FiniteSpace
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.agents.exact.flips.flips import Flip

NONE: Final = "no flips: the same actions are best at every γ in (0, 1)"
HEAD: Final = ("γ", "", "state", "below", "above", "return below", "return above")
TURNS_THE_WAY: Final = "*"


def flips_document(space: FiniteSpace, flips: Sequence[Flip]) -> list[dict[str, Any]]:
    """Return ``flips`` as the JSON has them: states and actions by name, actions in the world's order."""
    names = space.action_names
    return [
        {
            "gamma": flip.gamma,
            "turns_the_way": flip.turns_the_way,
            "expected_return": list(flip.expected_return),
            "changes": [
                {
                    "state": space.state_names[turn.state],
                    "from": [names[space.pair_action[pair]] for pair in turn.before],
                    "to": [names[space.pair_action[pair]] for pair in turn.after],
                }
                for turn in flip.turns
            ],
        }
        for flip in flips
    ]


def flips_report(world: World, flips: Sequence[Flip]) -> str:
    """Return ``flips`` as text: a line for each state that changes, actions in the order of the screen."""
    if not flips:
        return NONE
    limit = world.space.time_limit
    within = f", within {counted(limit, 'step')}" if limit else ""
    return "\n".join(
        (
            f"{counted(len(flips), 'flip')}: where the best actions change as γ goes from 0 to 1",
            columns([HEAD, *(row for flip in flips for row in _rows(world, flip))], right=(5, 6)),
            f"{TURNS_THE_WAY} turns the way from the start",
            f"return: undiscounted{within}, of the best actions just below and just above",
        )
    )


def _rows(world: World, flip: Flip) -> list[tuple[str, ...]]:
    gamma = (number(flip.gamma, ".12g"), TURNS_THE_WAY if flip.turns_the_way else "")
    returns = tuple(number(each, ".5f") for each in flip.expected_return)
    return [
        (
            *(("", "") if place else gamma),
            world.space.state_names[turn.state],
            _actions(world, turn.before),
            _actions(world, turn.after),
            *(("", "") if place else returns),
        )
        for place, turn in enumerate(flip.turns)
    ]


def _actions(world: World, pairs: Sequence[int]) -> str:
    space = world.space
    return ", ".join(space.action_names[space.pair_action[pair]] for pair in shown_pairs(world, pairs))
