"""An action, and where it applies."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import Flag, StrEnum, auto
from typing import Any, Final

MENUS: Final = {"a": "Agent", "w": "World", "t": "Tools", "c": "Compare", "m": "More", "r": "Again"}
"""The title of each menu, by the key that opens it."""


class Place(Flag):
    """Screens of an action, plus KIOSK for one without files."""

    CATALOGUE = auto()
    LESSONS = auto()
    PLAYGROUND = auto()
    KIOSK = auto()
    EVERY = CATALOGUE | LESSONS | PLAYGROUND


class Group(StrEnum):
    """Headings of keys outside menus, in order."""

    LISTS = "Lists"
    LESSON = "Lesson"
    DRAWING = "Drawing"
    RUN = "Run"
    PROGRAM = "Program"


def menu_title(key: str, listed: Iterable[Action]) -> str:
    """Return a menu's title."""
    return "Draw" if any(each.group is Group.DRAWING for each in listed) else MENUS[key]


@dataclass(frozen=True, slots=True)
class Action:
    """One thing a person can do.

    * ``key``: Textual's name, several with commas, or a menu key and a letter (``t p``).
    * ``symbol``: the key as people see it, if different.
    * ``old``: an earlier key, which names the new one and still works, unless ``old_only_tells``.
    * ``rank``: order on the key line; the highest is dropped first, None is never shown.
    * ``hint``, ``entry``: key and label on the key line and on the page of all keys.
    * ``is_first``: on the key line from the start. ``while_running``: label while the run goes on.
    * ``command``: method ``object.method`` of the screen, ``app.…`` or ``action_…``; default ``id``.
    * ``for_the_owner``: not in a kiosk. ``everywhere``: also in dialogs.
    * ``leaves``: does not wait for queued keys. ``unfocused``: only without a panel in focus.
    * ``not_for_program``, ``not_in_lesson``: reason, with ``{file}`` for the program's file.
    * ``takes_steps``: waits while a prediction is open. ``shows``: parts that a lesson may hide.
    * ``keeps_page``: leaves the lesson page in view. ``value``: current value, for a menu.
    * ``refused``: why it can do nothing now. ``stays``: on the key line even then.
    """

    id: str
    key: str
    label: str
    help: str
    group: Group = Group.RUN
    place: Place = Place.PLAYGROUND
    symbol: str = ""
    command: str = ""
    old: str = ""
    old_only_tells: bool = False
    rank: int | None = None
    hint: tuple[str, str] | None = None
    is_first: bool = False
    entry: tuple[str, str] | None = None
    while_running: str = ""
    aliases: str = ""
    for_the_owner: bool = False
    needs_world: bool = False
    everywhere: bool = False
    leaves: bool = False
    not_for_program: str = ""
    of_program: bool = False
    of_lesson: bool = False
    not_in_lesson: str = ""
    takes_steps: bool = False
    shows: tuple[str, ...] = ()
    keeps_page: bool = False
    refused: str = ""
    stays: bool = False
    unfocused: bool = False
    value: str = ""

    def also(self, **more: Any) -> Action:
        """Set ``more`` fields of a row."""
        return replace(self, **more)

    @property
    def menu(self) -> str:
        """The menu's key, or empty."""
        return self.key[0] if " " in self.key else ""

    @property
    def letter(self) -> str:
        """The letter in the menu, or empty."""
        return self.key[-1] if self.menu else ""

    @property
    def heading(self) -> str:
        """The heading that lists its key."""
        return MENUS.get(self.menu, self.group)

    @property
    def keys(self) -> list[str]:
        """Textual's names of single keys, with the old one."""
        single = "" if self.menu else self.key
        return [key for key in (*single.split(","), *self.old.split(",")) if key]

    @property
    def shown(self) -> str:
        """The key as people see it."""
        return self.symbol or self.key

    @property
    def sentence(self) -> str:
        """The help, or why it is unavailable."""
        return f"Not here: {self.refused}." if self.refused else self.help

    @property
    def textual_action(self) -> str:
        """The action for Textual, which does not know the objects of a screen."""
        command = self.command or self.id
        target, dot, _ = command.partition(".")
        verb = "do_unfocused" if self.unfocused else "do"
        return f"{verb}({command!r})" if dot and target != "app" else command

    @property
    def key_hint(self) -> tuple[str, str]:
        """Keys and label on the key line."""
        return self.hint or (self.shown, self.label)
