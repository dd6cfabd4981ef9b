"""What modes have in common: which keys they take from the panels, and what stands on the world's border."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from textual.binding import Binding, BindingType

from rl_tui.lab.live.commands import Command
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.panels.pointing import PartPointed, Pointed
from rl_tui.tui.screens.key_line import Hints, KeyLine
from rl_tui.tui.screens.playground.actions.modes.action_keys import DIGITS
from rl_tui.tui.screens.playground.actions.subject import Subject

STEPS: Final = {"up": (-1, 0), "down": (1, 0), "left": (0, -1), "right": (0, 1)}
WITH_SHIFT: Final = "shift+"
LEAVE: Final = "escape"
CLEAR: Final = "C"


def _binding(key: str, tooltip: str) -> Binding:
    # Before whatever is in focus: a slider or a table has uses of its own for these keys
    return Binding(
        key, f"mode_key('{key}')", key, show=False, priority=True, id=f"mode.{key}", tooltip=tooltip
    )


MODE_BINDINGS: Final[list[BindingType]] = [
    *(_binding(key, "Go there") for key in STEPS),
    *(_binding(f"{WITH_SHIFT}{key}", "Draw this action") for key in STEPS),
    *(_binding(digit, "Take or draw this action") for digit in DIGITS),
    _binding("enter", "Draw the arm under the cursor"),
    *(_binding(key, "Draw no action here") for key in ("delete", "backspace")),
    _binding(CLEAR, "Draw afresh"),
    _binding(LEAVE, "Leave the mode"),
]


class Modes:
    """The mode that is on, if one is: entering another leaves it."""

    def __init__(self) -> None:
        self.current: KeyMode | None = None

    def takes(self, key: str) -> bool:
        """Return whether ``key`` is for the mode; else it is left to the panels."""
        return self.current is not None and self.current.takes(key)

    def press(self, key: str) -> None:
        """Do what ``key`` means in the mode."""
        if self.current is not None:
            self.current.press(key)

    def point(self, event: Pointed | PartPointed, snapshot: Snapshot | None) -> None:
        """Let the mode take notice of what is pointed at, which may have other keys."""
        if self.current is not None and snapshot is not None:
            if isinstance(event, PartPointed):
                self.current.point(event.step)
            self.current.show(snapshot)

    def note(self, command: Command) -> None:
        """Let the mode take notice of ``command``, which is being sent."""
        if self.current is not None:
            self.current.note(command)

    def show(self, snapshot: Snapshot) -> None:
        """Show what can be done in ``snapshot``."""
        if self.current is not None:
            self.current.show(snapshot)


@dataclass(eq=False)
class KeyMode(Subject):
    """A subject that has keys of its own while it is on."""

    modes: Modes

    @property
    def is_on(self) -> bool:
        """Whether its keys count."""
        return self.modes.current is self

    def takes(self, key: str) -> bool:
        """Return whether ``key`` means something to it, while it is on."""
        raise NotImplementedError

    def press(self, key: str) -> None:
        """Do what ``key`` means."""
        raise NotImplementedError

    def point(self, step: tuple[int, int] | None) -> None:
        """Do what a second click under the cursor means, towards a side or in the middle (None)."""

    def note(self, command: Command) -> None:
        """Take notice of ``command``, which is being sent."""

    def show(self, snapshot: Snapshot) -> None:
        """Show what can be done in ``snapshot``."""
        raise NotImplementedError

    def enter(self) -> None:
        """Let its keys count."""
        if self.modes.current is not None:
            self.modes.current.leave()
        self.modes.current = self

    def leave(self) -> None:
        """Give the keys back."""
        if self.is_on:
            self.modes.current = None
            self._write((), (), ())

    def _write(self, title: Sequence[str], prompt: Sequence[str], hints: Hints) -> None:
        """Write title and prompt, the longest forms first, on the world's border, and ``hints`` below all."""
        if self.board.world is not None:
            self.board.world.show_mode(tuple(title), tuple(prompt))
        self.screen.query_one(KeyLine).hints = hints
