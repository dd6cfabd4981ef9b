"""What one thing is that a person can do, and where."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Flag, StrEnum, auto


class Place(Flag):
    """The screens on which an action applies; KIOSK beside one says that it has no files there."""

    CATALOGUE = auto()
    LESSONS = auto()
    PLAYGROUND = auto()
    KIOSK = auto()
    EVERY = CATALOGUE | LESSONS | PLAYGROUND


class Group(StrEnum):
    """The headings of the help panel, in its order."""

    LESSON = "Lesson"
    DRAWING = "Drawing"
    RUN = "Run"
    TIME = "Time"
    AGENT = "Agent"
    VIEW = "View"
    SESSION = "Session"
    SCENARIO = "Scenario"
    PROGRAM = "Program"


@dataclass(frozen=True, slots=True)
class Action:
    """One thing a person can do.

    ``key`` is Textual's name of the key, of several with commas between them, ``symbol`` how people see it
    where that is otherwise. ``label`` is a word or two for the key line, ``help`` one sentence. ``command``
    does it; where it is not given, it is the ``id``. ``object.method`` is a method of an object that the
    screen has under that name, ``app.…`` an action of the app, and a bare name a method ``action_…`` of the
    screen. ``rank`` orders the key line (a lower one is kept longer where it is narrow; None: not on it), and
    ``hint`` replaces key and label there, for two actions that share an entry. ``aliases`` are other words
    by which the palette finds it. What is ``for_the_owner`` of the machine is not for a kiosk; what
    ``needs_world`` waits until there is one; what counts ``everywhere`` does so in dialogs too.
    What ``leaves`` a panel, a screen or the program does not wait for a flood of other keys. While the run
    goes on, ``while_running`` is the word on the key line, where there is one.

    What cannot be done to somebody's program that is watched says in ``not_for_program`` why, and what to do
    instead, as a sentence with ``{file}`` for the program's file. What is ``of_program`` is for such a
    program alone, what is ``of_lesson`` for a lesson. What can do nothing in this world is ``refused``, with
    the reason.
    """

    id: str
    key: str
    label: str
    help: str
    group: Group
    place: Place = Place.PLAYGROUND
    symbol: str = ""
    command: str = ""
    rank: int | None = None
    hint: tuple[str, str] | None = None
    while_running: str = ""
    aliases: str = ""
    for_the_owner: bool = False
    needs_world: bool = False
    everywhere: bool = False
    leaves: bool = False
    not_for_program: str = ""
    of_program: bool = False
    of_lesson: bool = False
    refused: str = ""

    @property
    def keys(self) -> list[str]:
        """Textual's names of the keys."""
        return self.key.split(",")

    @property
    def shown(self) -> str:
        """How people see the key."""
        return self.symbol or self.key

    @property
    def sentence(self) -> str:
        """What it does, or why it can do nothing here."""
        return f"Not here: {self.refused}." if self.refused else self.help

    @property
    def textual_action(self) -> str:
        """The action for Textual, which knows screen and app, but not the objects of a screen."""
        command = self.command or self.id
        target, dot, _ = command.partition(".")
        return f"do({command!r})" if dot and target != "app" else command

    @property
    def key_hint(self) -> tuple[str, str]:
        """The keys and the word on the key line."""
        return self.hint or (self.shown, self.label)
