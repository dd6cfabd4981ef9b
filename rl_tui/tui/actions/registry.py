"""Everything a person can do, once: bindings, palette, help panel and key line derive from this list.

The keys that open panels come from the table of panels.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from rl_tui.tui.actions.action import Action, Group, Place
from rl_tui.tui.actions.playground_actions import PLAYGROUND_ACTIONS
from rl_tui.tui.actions.program_actions import CATALOGUE_ACTIONS, PROGRAM_ACTIONS
from rl_tui.tui.panels.catalogue import PANELS, PanelRow

_ACTIONS: Final = (*CATALOGUE_ACTIONS, *PLAYGROUND_ACTIONS, *PROGRAM_ACTIONS)


def all_actions(panels: Iterable[PanelRow] = PANELS) -> tuple[Action, ...]:
    """Return every action; those that open ``panels`` follow the one that zooms them."""
    after = next(number for number, action in enumerate(_ACTIONS, start=1) if action.id == "view.zoom")
    opening = (
        Action(
            f"board.{row.id}",
            row.opened_by.key,
            row.opened_by.label,
            row.opened_by.help,
            Group.VIEW,
            command=f"board.toggle('{row.id}')",
            rank=row.opened_by.rank,
            needs_world=True,
        )
        for row in panels
        if row.opened_by is not None
    )
    return (*_ACTIONS[:after], *opening, *_ACTIONS[after:])


ACTIONS: Final = all_actions()


def actions_of(place: Place, panels: Iterable[PanelRow] = PANELS) -> tuple[Action, ...]:
    """Return the actions that apply in ``place``, in the order of the list."""
    screen = place & Place.BOTH
    kiosk = Place.KIOSK in place
    return tuple(
        action
        for action in all_actions(panels)
        if screen in action.place and not (kiosk and action.for_the_owner)
    )
