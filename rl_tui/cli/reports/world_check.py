"""What an author should know of a world, as JSON and as text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from rl_tui.cli.output import columns
from rl_tui.cli.reports.flip_points import flips_document
from rl_tui.common.words import counted
from rl_tui.lab.world_check.report import WorldReport
from rl_tui.lab.world_check.words import LABELS, rows, warnings

if TYPE_CHECKING:
    from rl_tui.lab.run.recipe import Recipe
    from rl_tui.lab.world_check.words import Row
    from rl_tui.worlds.world import World


def check_document(faults: Sequence[str], world: World | None, report: WorldReport) -> dict[str, Any]:
    """Return the document of ``check --deep --json``; ``world`` is None where there are ``faults``."""
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
    """Return the same as text; the warnings are apart from it."""
    space = world.space
    states = counted(space.states, "state")
    title = f"{recipe.scenario.title}: {states}, {counted(len(space.action_names), 'action')}"
    if report.is_empty:
        return f"{title}; there is no table to work anything out from"
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
