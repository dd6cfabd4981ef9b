"""The reports on flip points and on the world check."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Final

from rl_tui.commands.line.output import columns, number
from rl_tui.common.words import counted
from rl_tui.screen.draw.action_order import shown_pairs
from rl_tui.studies.world_check.report import WorldReport
from rl_tui.studies.world_check.words import LABELS, rows, warnings
from rl_tui.worlds.mdp.space import FiniteSpace
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.agents.exact.flips import Flip
    from rl_tui.runs.recipe import Recipe
    from rl_tui.studies.world_check.words import Row


# Flip points


NONE: Final = "no flip points: the same actions are optimal at every γ in (0, 1)"
HEAD: Final = ("γ", "", "state", "below", "above", "return below", "return above")
TURNS_THE_WAY: Final = "*"


def flips_document(space: FiniteSpace, flips: Sequence[Flip]) -> list[dict[str, Any]]:
    """Return flip points for JSON, with states and actions by name."""
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
    """Return flip points as text, with one line per changed state."""
    if not flips:
        return NONE
    limit = world.space.time_limit
    within = f", within {counted(limit, 'step')}" if limit else ""
    return "\n".join(
        (
            f"{counted(len(flips), 'flip point')}: where the optimal actions change as γ goes from 0 to 1",
            columns([HEAD, *(row for flip in flips for row in _rows(world, flip))], right=(5, 6)),
            f"{TURNS_THE_WAY} changes the optimal path",
            f"return: undiscounted{within}, of the optimal actions just below and just above",
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


# World check


def check_document(faults: Sequence[str], world: World | None, report: WorldReport) -> dict[str, Any]:
    """Return the document of ``check --deep --json``. `faults` are errors of the file."""
    wait, tried = report.first_update, report.tried
    return {
        "faults": list(faults),
        "warnings": list(warnings(report)),
        "random_return": report.random_return,
        "best_return": report.best_return,
        "shortest_way": report.shortest_way,
        "first_update": None if wait is None else asdict(wait),
        "flips": None if world is None or report.flips is None else flips_document(world.space, report.flips),
        "never_reached": _names(world, report.never_reached),
        "endless_states": _names(world, report.endless_states),
        "endless": None if report.endless is None else list(report.endless),
        "tried": None if tried is None else asdict(tried),
    }


def check_report(recipe: Recipe, world: World, report: WorldReport) -> str:
    """Return the world check as text, without its warnings."""
    space = world.space
    states = counted(space.states, "state")
    title = f"{recipe.scenario.title}: {states}, {counted(len(space.action_names), 'action')}"
    if report.is_empty:
        return f"{title}; no exact results without a transition table"
    listed = rows(report, space, recipe.hyperparameters.gamma)
    figures = [(LABELS[row.field], row.figure, row.remark) for row in listed[:3]]
    texts = [(LABELS[row.field], _in_a_line(row)) for row in listed[3:]]
    return "\n".join((title, "", columns(figures, right=(1,)), "", columns(texts)))


def _in_a_line(row: Row) -> str:
    return f"{row.figure} ({row.remark})" if row.remark else row.figure


def _names(world: World | None, states: Sequence[int] | None) -> list[str] | None:
    if world is None or states is None:
        return None
    return [world.space.state_names[state] for state in states]
