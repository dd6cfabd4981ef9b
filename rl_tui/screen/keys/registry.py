"""The list of all actions."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from rl_tui.screen.keys.action import Action, Group, Place
from rl_tui.screen.keys.playground_keys import AFTER_PANELS, BEFORE_PANELS
from rl_tui.screen.kit.row import PanelRow
from rl_tui.screen.panels.catalogue import PANELS

_LIST_ACTIONS: Final[tuple[Action, ...]] = (
    Action("open", "enter", "open", "Open the row under the cursor.", Group.LISTS, Place.CATALOGUE, rank=0),
    Action("filter", "slash", "find", "Filter worlds, lessons and words as you type.").also(
        group=Group.LISTS, place=Place.CATALOGUE, symbol="/", rank=1, aliases="search glossary"
    ),
    Action("new_world", "n", "new world", "Draw a new map, graph or bandit.").also(
        group=Group.LISTS, place=Place.CATALOGUE, rank=3, aliases="edit draw", for_the_owner=True
    ),
    *(
        Action(f"door_{number}", str(number), label, help_).also(
            group=Group.LISTS,
            place=Place.CATALOGUE,
            command=f"door({number})",
            rank=2 if number == 4 else None,
            hint=("1 2 3 4", "top row") if number == 4 else None,
            for_the_owner=number == 4,
        )
        for number, label, help_ in (
            (1, "learn", "Open the list of lessons."),
            (2, "watch", "Watch an agent learn to cross a lake."),
            (3, "continue", "Continue the newest session."),
            (4, "your code", "Show how to watch your script."),
        )
    ),
    Action("delete_session", "delete", "delete", "Delete the session under the cursor, after asking.").also(
        group=Group.LISTS, place=Place.CATALOGUE, symbol="del", for_the_owner=True
    ),
    Action("open_lesson", "enter", "go on", "Begin the lesson, or continue where you left it.").also(
        group=Group.LISTS, place=Place.LESSONS, rank=0
    ),
    Action("begin_again", "r", "begin again", "Begin the lesson again, after asking.").also(
        group=Group.LISTS, place=Place.LESSONS, rank=1, aliases="restart"
    ),
    Action("leave_lessons", "escape", "back", "Go back to the start screen.").also(
        group=Group.LISTS, place=Place.LESSONS, symbol="esc", rank=2, aliases="menu list", leaves=True
    ),
)

_MENUS: Final = tuple(
    Action(f"menu.{label}", key, label, help_).also(
        command=f"menus.open('{key}')", rank=rank, needs_world=True, keeps_page=True
    )
    for key, label, help_, rank in (
        ("a", "agent", "Open a menu: algorithm, policy, ties, settings.", 5),
        ("w", "world", "Open a menu: edit the world, model, exact values.", 6),
        ("t", "tools", "Open a menu: policies, many seeds, flip points.", 7),
        ("c", "compare", "Open a menu: compare with another algorithm, setting or seed.", 10),
        ("m", "more", "Open a menu: other moments, branches, save, export.", 11),
        ("r", "again", "Open a menu: start again, same seed or another.", 12),
    )
)

_PROGRAM_ACTIONS: Final[tuple[Action, ...]] = (
    Action("back", "escape", "back", "Close what is open, or go back.").also(
        group=Group.PROGRAM,
        symbol="esc",
        command="leaving.back",
        keeps_page=True,
        rank=18,
        aliases="menu list close load environment level lessons tutorial sessions",
        leaves=True,
    ),
    Action("help", "question_mark", "keys", "Show all keys, or explain the word you point at.").also(
        group=Group.PROGRAM,
        place=Place.EVERY,
        symbol="?",
        rank=-1,
        is_first=True,
        aliases="help manual shortcuts glossary",
    ),
    Action("find", "slash,ctrl+p", "find", "Find anything by its name.").also(
        group=Group.PROGRAM,
        place=Place.LESSONS | Place.PLAYGROUND,
        symbol="/",
        command="app.find",
        rank=16,
        is_first=True,
        aliases="palette glossary search",
    ),
    Action("redraw", "ctrl+l", "redraw", "Redraw the whole screen.").also(
        group=Group.PROGRAM, place=Place.EVERY, command="app.redraw", everywhere=True
    ),
    Action("suspend", "ctrl+z", "to shell", "Pause the program and go to the shell.").also(
        group=Group.PROGRAM,
        place=Place.EVERY,
        command="app.suspend_process",
        for_the_owner=True,
        everywhere=True,
        leaves=True,
    ),
    Action("quit", "q", "quit", "Close what is open, or quit.").also(
        group=Group.PROGRAM, place=Place.EVERY, rank=24, aliases="exit leave end bye", leaves=True
    ),
    Action("ask_to_quit", "ctrl+c", "confirm quit", "Ask whether to quit.").also(
        group=Group.PROGRAM, place=Place.EVERY, command="app.ask_to_quit", everywhere=True, leaves=True
    ),
)


def opening_actions(panels: Iterable[PanelRow]) -> tuple[Action, ...]:
    """Return the actions that open ``panels``."""
    return tuple(
        Action(f"board.{row.id}", row.opened_by.key, row.opened_by.label, row.opened_by.help).also(
            command=f"board.toggle('{row.id}')",
            old=row.opened_by.old,
            rank=row.opened_by.rank,
            needs_world=True,
            not_for_program=row.not_for_program,
            of_program=row.of_program,
            shows=row.shows,
        )
        for row in panels
        if row.opened_by is not None
    )


ACTIONS: Final = (
    *(*_LIST_ACTIONS, *BEFORE_PANELS, *opening_actions(PANELS), *AFTER_PANELS, *_MENUS, *_PROGRAM_ACTIONS),
)


def actions_of(place: Place) -> tuple[Action, ...]:
    """Return the actions of ``place`` in order."""
    screen, kiosk = place & Place.EVERY, Place.KIOSK in place
    return tuple(each for each in ACTIONS if screen in each.place and not (kiosk and each.for_the_owner))
