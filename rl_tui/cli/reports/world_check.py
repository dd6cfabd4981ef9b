"""What an author should know of a world, as JSON and as text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Final

from rl_tui.agents.catalogue import BY_ID
from rl_tui.cli.output import columns, number
from rl_tui.cli.reports.flip_points import flips_document
from rl_tui.common.words import counted
from rl_tui.lab.answers.first_update_words import wait_in_words
from rl_tui.lab.world_check.report import WorldReport

if TYPE_CHECKING:
    from rl_tui.lab.run.recipe import Recipe
    from rl_tui.worlds.world import World

_NOT_KNOWN: Final = "not known"
_MOST_NAMED: Final = 12


def check_document(faults: Sequence[str], world: World | None, report: WorldReport) -> dict[str, Any]:
    """Return the document of ``check --deep --json``; ``world`` is None where there are ``faults``."""
    wait, tried = report.first_update, report.tried
    return {
        "faults": list(faults),
        "warnings": list(report.warnings),
        "random_return": report.random_return,
        "best_return": report.best_return,
        "shortest_way": report.shortest_way,
        "first_update": None if wait is None else asdict(wait),
        "flips": None if world is None or report.flips is None else flips_document(world.space, report.flips),
        "never_reached": _names(world, report.never_reached),
        "endless_states": _names(world, report.endless_states),
        "endless": None if report.endless is None else list(report.endless),
        "tried": None
        if tried is None
        else {"seeds": list(tried.seeds), "episodes": tried.episodes, "steps": tried.steps},
    }


def check_report(recipe: Recipe, world: World, report: WorldReport) -> str:
    """Return the same as text; the warnings are told apart from it."""
    space, hyperparameters = world.space, recipe.hyperparameters
    states = counted(space.states, "state")
    title = f"{recipe.scenario.title}: {states}, {counted(len(space.action_names), 'action')}"
    if report.is_empty:
        return f"{title}; there is no table to work anything out from"
    limit = f" within {counted(space.time_limit, 'step')}" if space.time_limit else ""
    clock = ", choosing by the clock too" if limit else ""
    steps, wait = report.shortest_way, report.first_update
    rows = [
        ("random policy", number(report.random_return, ".5f"), f"expected return, undiscounted{limit}"),
        ("best policy", number(report.best_return, ".5f"), f"likewise{clock}"),
        (
            "best way",
            _NOT_KNOWN if steps is None else counted(steps, "step"),
            f"at least, by the best actions for γ {hyperparameters.gamma:g}",
        ),
    ]
    lines = [
        ("first update", _NOT_KNOWN if wait is None else wait_in_words(wait)),
        ("flips", _flips(report)),
        ("never reached", _some(_names(world, report.never_reached))),
        ("no way out", _some(_names(world, report.endless_states))),
        ("may never end", _endless(report)),
    ]
    return "\n".join((title, "", columns(rows, right=(1,)), "", columns(lines)))


def _names(world: World | None, states: Sequence[int] | None) -> list[str] | None:
    if world is None or states is None:
        return None
    return [world.space.state_names[state] for state in states]


def _some(names: Sequence[str] | None) -> str:
    if names is None:
        return _NOT_KNOWN
    if not names:
        return "no state"
    more = f" and {len(names) - _MOST_NAMED:,} more" if len(names) > _MOST_NAMED else ""
    return f"{counted(len(names), 'state')}: {', '.join(names[:_MOST_NAMED])}{more}"


def _flips(report: WorldReport) -> str:
    if report.flips is None:
        return _NOT_KNOWN
    if not report.flips:
        return "none: the same actions are best at every γ in (0, 1)"
    at = ", ".join(number(flip.gamma, ".6g") for flip in report.flips[:_MOST_NAMED])
    more = ", …" if len(report.flips) > _MOST_NAMED else ""
    return f"{counted(len(report.flips), 'flip')} of the best actions: at γ {at}{more}"


def _endless(report: WorldReport) -> str:
    tried = report.tried
    if report.endless is None or tried is None:
        return _NOT_KNOWN
    if not tried.seeds:
        return "no greedy policy: in this world each policy ends"
    how = f"seeds {tried.seeds[0]} to {tried.seeds[-1]}, {counted(tried.episodes, 'episode')} each"
    if not report.endless:
        return f"no greedy policy of any algorithm, as far as tried ({how})"
    names = ", ".join(BY_ID[algorithm].name for algorithm in report.endless)
    return f"a greedy policy of {names} ({how})"
