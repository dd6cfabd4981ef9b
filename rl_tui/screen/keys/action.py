"""What one thing is that a person can do, where, and with which keys."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Flag, StrEnum, auto
from typing import Final

MENUS: Final = {"a": "Agent", "w": "World", "t": "Tools", "c": "Compare", "m": "More", "r": "Again"}
"""The title of each menu, by the key that opens it."""


class Place(Flag):
    """The screens on which an action applies; KIOSK beside one says that it has no files there."""

    CATALOGUE = auto()
    LESSONS = auto()
    PLAYGROUND = auto()
    KIOSK = auto()
    EVERY = CATALOGUE | LESSONS | PLAYGROUND


class Group(StrEnum):
    """The heading of keys that are in no menu, in the order of the pages."""

    LISTS = "Lists"
    LESSON = "Lesson"
    DRAWING = "Drawing"
    RUN = "Run"
    PROGRAM = "Program"


def menu_title(key: str, listed: Iterable[Action]) -> str:
    """Return the title of the menu of ``key``, which lists these actions: tools while a person draws."""
    return "Draw" if any(each.group is Group.DRAWING for each in listed) else MENUS[key]


@dataclass(frozen=True, slots=True)
class Action:
    """One thing a person can do.

    Keys
        ``key`` is Textual's name of the key, of several with commas between them, or the key of a menu and a
        letter there (``t p``). ``symbol`` is how people see it where that is otherwise. ``old`` is a key that
        did the same before there were menus: it still does it and names the new one; with ``old_only_tells``
        it names the new one and does nothing.
    Words
        ``label`` has at most two words, ``help`` is one sentence. ``rank`` orders the key line (a lower one
        is kept longer where it is narrow; None: not on it), and ``hint`` replaces key and label there, for
        two actions that share an entry; ``entry`` does so on the page of all keys, where it is empty for
        those that stand in the entry of another. What ``is_first`` is on the key line from the start, before
        a person has done anything. While the run goes on, ``while_running`` is the word there.
        ``aliases`` are other words by which it is found.
    Command
        ``command`` does it; the default is the ``id``. ``object.method`` is a method of an object that the
        screen has under that name, ``app.…`` an action of the app, and a bare name a method ``action_…`` of
        the screen.
    Where
        What is ``for_the_owner`` of the machine is not for a kiosk; what ``needs_world`` waits until there is
        one; what counts ``everywhere`` does so in dialogs too. What ``leaves`` a panel, a screen or the
        program does not wait for a flood of other keys. ``not_for_program`` is why it cannot be done to a
        watched program, and what to do instead, with ``{file}`` for the program's file, ``not_in_lesson`` the
        same for a lesson. What is ``of_program`` is for such a program only, what is ``of_lesson`` for a
        lesson. What ``takes_steps``, of this run or another, waits while a prediction is open; what a page
        may keep back of what it would show is in ``shows``. What ``keeps_page`` leaves a page in view where
        that takes turns with the world. ``refused`` is why it can do nothing now; what ``stays`` is on the
        key line all the same, since the next step may change that. What is ``unfocused`` counts while no
        panel has the focus. ``value`` is the current value of a tool of drawing, for its row in a menu.
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

    @property
    def menu(self) -> str:
        """The key of the menu that lists it; empty where a single key does it."""
        return self.key[0] if " " in self.key else ""

    @property
    def letter(self) -> str:
        """Its letter in the menu."""
        return self.key[-1] if self.menu else ""

    @property
    def heading(self) -> str:
        """The heading under which its key is listed."""
        return MENUS.get(self.menu, self.group)

    @property
    def keys(self) -> list[str]:
        """Textual's names of the single keys that do it, the old one included."""
        single = "" if self.menu else self.key
        return [key for key in (*single.split(","), *self.old.split(",")) if key]

    @property
    def shown(self) -> str:
        """How people see the key."""
        return self.symbol or self.key

    @property
    def sentence(self) -> str:
        """What it does, or why it can do nothing now."""
        return f"Not here: {self.refused}." if self.refused else self.help

    @property
    def textual_action(self) -> str:
        """The action for Textual, which knows screen and app, but not the objects of a screen."""
        command = self.command or self.id
        target, dot, _ = command.partition(".")
        verb = "do_unfocused" if self.unfocused else "do"
        return f"{verb}({command!r})" if dot and target != "app" else command

    @property
    def key_hint(self) -> tuple[str, str]:
        """The keys and the word on the key line."""
        return self.hint or (self.shown, self.label)
