"""Everything a person can do, once: bindings, palette, help panel and key line derive from this list.

The keys that open panels come from the table of panels.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from rl_tui.screen.keys.action import Action, Group, Place
from rl_tui.screen.keys.playground_keys import PLAYGROUND_ACTIONS
from rl_tui.screen.kit.row import PanelRow
from rl_tui.screen.panels.catalogue import PANELS

_KEPT: Final = "there is nothing to save: {file} and its seed make the same run again"
_STAYS: Final = "your program stands in no row of the catalogue: esc goes there"

_CATALOGUE_ACTIONS: Final[tuple[Action, ...]] = (
    Action(
        "open",
        "enter",
        "open",
        "Open the scenario or the list of lessons, or go on with the session.",
        Group.SCENARIO,
        Place.CATALOGUE,
        rank=0,
    ),
    Action(
        "delete_session",
        "delete",
        "delete",
        "Delete the session under the cursor, after asking; shift+tab goes to the sessions.",
        Group.SESSION,
        Place.CATALOGUE,
        symbol="del",
        for_the_owner=True,
    ),
)

_LESSON_ACTIONS: Final[tuple[Action, ...]] = (
    Action(
        "open_lesson",
        "enter",
        "go on",
        "Begin the lesson or go on where you left it; one that is finished opens as a reference.",
        Group.LESSON,
        Place.LESSONS,
        rank=0,
    ),
    Action(
        "begin_again",
        "r",
        "begin again",
        "Begin the lesson again, after asking; what you did in it until now stays among the sessions.",
        Group.LESSON,
        Place.LESSONS,
        rank=1,
        aliases="restart",
    ),
    Action(
        "leave_lessons",
        "escape",
        "back",
        "Go back to the catalogue.",
        Group.LESSON,
        Place.LESSONS,
        symbol="esc",
        rank=2,
        aliases="menu list",
        leaves=True,
    ),
)

_PROGRAM_ACTIONS: Final[tuple[Action, ...]] = (
    Action(
        "session.save",
        "w",
        "save",
        "Save the session under a name; it is kept by itself as well.",
        Group.SESSION,
        rank=19,
        for_the_owner=True,
        not_for_program=_KEPT,
    ),
    Action(
        "export.choose",
        "x",
        "export",
        "Write the run as a command, a Python script, tables or a picture.",
        Group.SESSION,
        rank=10,
        for_the_owner=True,
        needs_world=True,
        not_for_program="x writes down runs of our agents; your program stands in {file} already",
    ),
    Action(
        "previous_scenario",
        "left_square_bracket",
        "previous scenario",
        "Go to the previous scenario.",
        Group.SCENARIO,
        symbol="[",
        command="scenario.previous",
        rank=12,
        hint=("[ ]", "scenario"),
        not_for_program=_STAYS,
    ),
    Action(
        "next_scenario",
        "right_square_bracket",
        "next scenario",
        "Go to the next scenario.",
        Group.SCENARIO,
        symbol="]",
        command="scenario.following",
        not_for_program=_STAYS,
    ),
    Action(
        "back",
        "escape",
        "back",
        "Leave the zoom or an opened panel, else go back to the list: twice, once a step was taken.",
        Group.SCENARIO,
        symbol="esc",
        rank=18,
        aliases="menu list",
        leaves=True,
    ),
    Action(
        "help",
        "question_mark",
        "help",
        "Explain the word under the mouse or the panel in focus; else, and again, show this help.",
        Group.PROGRAM,
        Place.EVERY,
        symbol="?",
        rank=-1,
    ),
    Action(
        "glossary",
        "slash",
        "glossary",
        "Look a word up: each with its equation and where it stands in Sutton and Barto's book.",
        Group.PROGRAM,
        Place.EVERY,
        symbol="/",
    ),
    Action(
        "palette",
        "ctrl+p",
        "palette",
        "Find every action by its name, and the colour themes.",
        Group.PROGRAM,
        Place.EVERY,
        command="app.command_palette",
        rank=23,
    ),
    Action(
        "redraw",
        "ctrl+l",
        "draw again",
        "Draw the whole screen again, where something else wrote over it.",
        Group.PROGRAM,
        Place.EVERY,
        command="app.redraw",
        everywhere=True,
    ),
    Action(
        "suspend",
        "ctrl+z",
        "to the shell",
        "Stop here and go to the shell; its command fg comes back.",
        Group.PROGRAM,
        Place.EVERY,
        command="app.suspend_process",
        for_the_owner=True,
        everywhere=True,
        leaves=True,
    ),
    Action(
        "quit",
        "q",
        "quit",
        "Quit; in the help and in the model only close them.",
        Group.PROGRAM,
        Place.EVERY,
        command="app.quit",
        rank=24,
        aliases="exit leave end bye",
        leaves=True,
    ),
    Action(
        "ask_to_quit",
        "ctrl+c",
        "quit, asking",
        "Ask whether to quit; enter or a second ctrl+c does.",
        Group.PROGRAM,
        Place.EVERY,
        command="app.ask_to_quit",
        everywhere=True,
        leaves=True,
    ),
)

_ACTIONS: Final = (*_CATALOGUE_ACTIONS, *_LESSON_ACTIONS, *PLAYGROUND_ACTIONS, *_PROGRAM_ACTIONS)


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
            not_for_program=row.not_for_program,
            of_program=row.of_program,
        )
        for row in panels
        if row.opened_by is not None
    )
    return (*_ACTIONS[:after], *opening, *_ACTIONS[after:])


ACTIONS: Final = all_actions()


def actions_of(place: Place, panels: Iterable[PanelRow] = PANELS) -> tuple[Action, ...]:
    """Return the actions that apply in ``place``, in the order of the list."""
    screen = place & Place.EVERY
    kiosk = Place.KIOSK in place
    return tuple(
        action
        for action in all_actions(panels)
        if screen in action.place and not (kiosk and action.for_the_owner)
    )
