"""The first draft of a scenario, or the reason why its world cannot be edited."""

from __future__ import annotations

import pkgutil
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.errors import UserError
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.editing.grid_draft import GridDraft, draft_of_lines
from rl_tui.worlds.gym.section import GymnasiumSection
from rl_tui.worlds.mdp.digest import table_digest

if TYPE_CHECKING:
    from rl_tui.worlds.editing.arms_draft import Draft
    from rl_tui.worlds.files.scenario import Scenario
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
    from rl_tui.worlds.world import World


# Gymnasium's lakes and cliff as maps: the same table, bit for bit


_CHARACTERS: Final[Mapping[CellKind, str]] = {
    CellKind.START: "S",
    CellKind.FLOOR: ".",
    CellKind.HOLE: "H",
    CellKind.GOAL: "G",
    CellKind.CLIFF: "C",
}
_STEP: Final = -1.0  # reward of each step and of a fall in Gymnasium's CliffWalking
_FALL: Final = -100.0
_STEPPED: Final = "has no transition table"
_MAPS: Final = "maps, graphs and bandits of scenario files, lakes and the cliff"


def gymnasium_draft(scenario: Scenario, seed: int) -> GridDraft:
    """Return the map that equals a Gymnasium lake or cliff.

    Raises:
        UserError: It is neither, or no map describes it.
    """
    section = scenario.section
    assert isinstance(section, GymnasiumSection)
    if section.bins is not None or section.table is False:
        raise _refused(section.id, _STEPPED)
    import numpy as np

    world = scenario.build(np.random.default_rng(seed))
    refused = seen_at_once(section, world)
    if refused is not None:
        raise refused
    assert isinstance(world.drawing, Grid)
    assert world.mdp is not None
    return _same_map(section.id, world.drawing, world.mdp, world)


def seen_at_once(section: GymnasiumSection, world: World) -> UserError | None:
    """Return why `world` cannot be a map, without building one."""
    if world.mdp is None:
        return _refused(section.id, _STEPPED)
    if not isinstance(world.drawing, Grid) or world.drawing.legend or None in world.drawing.directions:
        return _refused(section.id, "has states that are not cells of a map")
    return None


def _same_map(name: str, drawing: Grid, mdp: TabularMDP, world: World) -> GridDraft:
    characters = [_CHARACTERS.get(kind, "?") for kind in drawing.kinds]
    columns = drawing.columns
    lines = ["".join(characters[row * columns : (row + 1) * columns]) for row in range(drawing.rows)]
    for rules in _rules(mdp):
        draft = draft_of_lines(lines, rules)
        if draft.findings:
            continue
        built = draft.build()
        same = built.mdp is not None and table_digest(built.mdp) == table_digest(mdp)
        if same and built.drawing == world.drawing:
            return draft
    raise _refused(name, "has rules that no map can express")


def _refused(name: str, why: str) -> UserError:
    return UserError(f"{name} {why}, so it cannot be edited; you can edit {_MAPS}")


def _rules(mdp: TabularMDP) -> list[dict[str, Any]]:
    limit = {"time_limit": mdp.time_limit} if mdp.time_limit else {}
    cliff = {
        "moves": "clockwise",
        "step_reward": _STEP,
        "legend": {
            "C": {"kind": "cliff", "back": True, "reward": _FALL - _STEP},
            "G": {"kind": "goal", "reward": 0.0},
        },
    }
    return [
        {**rules, **({"slippery": True} if slippery else {}), **limit}
        for rules in ({}, cliff)
        for slippery in (False, True)
    ]


_DRAFTED_BY: Final[Mapping[str, str]] = {
    "grid": "rl_tui.worlds.editing.grid_draft:grid_draft",
    "mdp": "rl_tui.worlds.editing.graph_draft:graph_draft",
    "bandit": "rl_tui.worlds.editing.arms_draft:arms_draft",
    "gymnasium": "rl_tui.worlds.editing.drafts:gymnasium_draft",
}
"""Factory of the draft for each kind of table, as ``module:function``, imported on use."""


def first_draft(scenario: Scenario, seed: int) -> Draft:
    """Return a draft with the table of `scenario`, bit for bit.

    Raises:
        UserError: The world cannot be edited.
    """
    make: Callable[[Scenario, int], Draft] = pkgutil.resolve_name(_DRAFTED_BY[scenario.kind])
    return make(scenario, seed)


def refusal(scenario: Scenario, seed: int) -> str:
    """Return why a world cannot be edited. Empty if it can."""
    try:
        first_draft(scenario, seed)
    except UserError as reason:
        return str(reason)
    return ""


def seen_refusal(scenario: Scenario, world: World) -> str:
    """Return why `world` cannot be edited, without building a draft.

    Only :func:`first_draft` finds an environment that equals no map.
    """
    if scenario.kind == "gymnasium":
        from rl_tui.worlds.gym.section import GymnasiumSection

        assert isinstance(scenario.section, GymnasiumSection)
        return str(seen_at_once(scenario.section, world) or "")
    return refusal(scenario, 0) if scenario.kind == "mdp" else ""
