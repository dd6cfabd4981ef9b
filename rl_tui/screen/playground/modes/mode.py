"""The base of modes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Final

from textual.binding import Binding, BindingType
from textual.widget import Widget

from rl_tui.live.commands import Command
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.frame.key_line import Hints, KeyLine
from rl_tui.screen.keys.action import Action
from rl_tui.screen.kit.pointing import PartPointed, Pointed, Touched
from rl_tui.screen.panels.world.view import WorldView

STEPS: Final = {"up": (-1, 0), "down": (1, 0), "left": (0, -1), "right": (0, 1)}
WITH_SHIFT: Final = "shift+"
LEAVE: Final = "escape"


def mode_bindings(*modes: type[KeyMode]) -> list[BindingType]:
    """Return the bindings of all modes' keys, which come first."""
    words = {key: word for mode in modes for key, word in mode.keys.items()}
    return [
        Binding(key, f"mode_key('{key}')", key, show=False, priority=True, id=f"mode.{key}", tooltip=word)
        for key, word in words.items()
    ]


class Modes:
    """The active mode, if any. Entering another one leaves it."""

    def __init__(self) -> None:
        self.current: KeyMode | None = None

    @property
    def actions(self) -> tuple[Action, ...]:
        """The active mode's actions."""
        return () if self.current is None else self.current.actions

    def takes(self, key: str) -> bool:
        """Return whether ``key`` is for the mode, not for panels."""
        mode = self.current
        return mode is not None and (mode.has_keys or mode.has_on_a_page(key)) and mode.takes(key)

    def press(self, key: str) -> None:
        """Press ``key`` in the mode."""
        if self.current is not None:
            self.current.press(key)

    def point(self, event: Touched, snapshot: Snapshot | None) -> None:
        """Pass on an event of the pointer."""
        if self.current is None or snapshot is None:
            return
        if isinstance(event, PartPointed):
            self.current.point(event.step)
        elif not isinstance(event, Pointed):
            self.current.draw(event)
        self.show(snapshot)  # unless the click has ended the mode

    def note(self, command: Command) -> None:
        """Tell the mode about a command being sent."""
        if self.current is not None:
            self.current.note(command)

    def show(self, snapshot: Snapshot) -> None:
        """Show the available actions."""
        if self.current is not None:
            self.current.show(snapshot)


@dataclass(eq=False)
class KeyMode(Subject):
    """A subject with its own keys while it is active and a world has the focus.

    Without ``needs_focus`` they also count while nothing has the focus. In other panels the world's border
    shows ``way_back``.
    """

    modes: Modes
    _focused_before: Widget | None = None
    keys: ClassVar[Mapping[str, str]]
    """The keys it may take, by Textual's names, and what each does."""
    way_back: ClassVar[tuple[str, ...]] = ()
    needs_focus: ClassVar[bool] = True

    @property
    def is_on(self) -> bool:
        """True if it is active."""
        return self.modes.current is self

    @property
    def actions(self) -> tuple[Action, ...]:
        """Its actions, which hide others with the same key."""
        return ()

    @property
    def has_keys(self) -> bool:
        """True if its keys count: no other panel has the focus."""
        focused = self.screen.focused
        is_free = focused is None and not self.needs_focus
        return self.is_on and (is_free or isinstance(focused, WorldView))

    def has_on_a_page(self, key: str) -> bool:
        """Return whether ``key`` counts on a lesson page."""
        return False

    def takes(self, key: str) -> bool:
        """Return whether ``key`` counts on a world."""
        raise NotImplementedError

    def press(self, key: str) -> None:
        """Do what ``key`` means."""
        raise NotImplementedError

    def toggle(self) -> None:
        """Enter the mode, or leave with a message."""
        raise NotImplementedError

    def point(self, step: tuple[int, int] | None) -> None:
        """Handle a second click, sideways or in the middle (None)."""

    def draw(self, event: Touched) -> None:
        """Handle stroke, wheel or click."""

    def note(self, command: Command) -> None:
        """Handle ``command``, which is being sent."""

    def show(self, snapshot: Snapshot) -> None:
        """Show the available actions."""
        raise NotImplementedError

    def enter(self) -> None:
        """Take keys, and focus the world."""
        if self.modes.current is not None:
            self.modes.current.leave()
        self.modes.current = self
        self.board.keeps_focus = True
        self._focused_before = self.screen.focused
        if self.needs_focus or self.screen.focused is not None:
            self.screen.set_focus(self.board.world)

    def leave(self) -> None:
        """Return keys and focus."""
        if self.is_on:
            if self.has_keys:
                before = self._focused_before
                self.screen.set_focus(before if before in self.screen.focus_chain else None)
            self.modes.current = None
            self.board.keeps_focus = False
            self._write((), (), ())

    def _write(self, title: Sequence[str], prompt: Sequence[str], hints: Hints) -> None:
        has_keys = self.has_keys
        if self.board.world is not None:
            prompts = tuple(prompt) if has_keys or not self.is_on else self.way_back
            self.board.world.show_mode(tuple(title), prompts, has_keys=has_keys)
        self.screen.query_one(KeyLine).hints = hints if has_keys else ()
