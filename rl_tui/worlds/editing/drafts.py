"""Which worlds can be edited: the draft that a scenario begins with, or why there is none."""

from __future__ import annotations

import pkgutil
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Final

from rl_tui.common.errors import UserError

if TYPE_CHECKING:
    from rl_tui.worlds.editing.arms_draft import Draft
    from rl_tui.worlds.files.scenario import Scenario
    from rl_tui.worlds.world import World

_DRAFTED_BY: Final[Mapping[str, str]] = {
    "grid": "rl_tui.worlds.editing.grid_draft:grid_draft",
    "mdp": "rl_tui.worlds.editing.graph_draft:graph_draft",
    "bandit": "rl_tui.worlds.editing.arms_draft:arms_draft",
    "gymnasium": "rl_tui.worlds.editing.gymnasium_draft:gymnasium_draft",
}
"""For each kind of table what makes its draft, ``module:function``, imported when it is asked for."""


def first_draft(scenario: Scenario, seed: int) -> Draft:
    """Return the draft of ``scenario`` as ``seed`` draws it: built, it is the same table, bit for bit.

    Raises UserError, with the reason, where its world cannot be edited.
    """
    make: Callable[[Scenario, int], Draft] = pkgutil.resolve_name(_DRAFTED_BY[scenario.kind])
    return make(scenario, seed)


def refusal(scenario: Scenario, seed: int) -> str:
    """Return why the world of ``scenario`` cannot be edited; empty where it can."""
    try:
        first_draft(scenario, seed)
    except UserError as reason:
        return str(reason)
    return ""


def seen_refusal(scenario: Scenario, world: World) -> str:
    """Return why ``world``, which ``scenario`` has made, cannot be edited, as far as a look at it tells.

    It makes no draft, so it is quick; a map that turns out to be none is refused by :func:`first_draft` only.
    """
    if scenario.kind == "gymnasium":
        from rl_tui.worlds.editing.gymnasium_draft import seen_at_once
        from rl_tui.worlds.gym.section import GymnasiumSection

        assert isinstance(scenario.section, GymnasiumSection)
        return str(seen_at_once(scenario.section, world) or "")
    return refusal(scenario, 0) if scenario.kind == "mdp" else ""
