"""Which worlds can be edited: the draft that a scenario begins with, or why there is none."""

from __future__ import annotations

import pkgutil
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Final

from rl_tui.common.errors import UserError

if TYPE_CHECKING:
    from rl_tui.worlds.editing.draft import Draft
    from rl_tui.worlds.files.scenario import Scenario

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
