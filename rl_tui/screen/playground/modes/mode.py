"""What modes have in common: which keys they take from the panels, and what stands on the world's border."""

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
    """Return the bindings of all keys of ``modes``; they count before the world, which uses some of them."""
    words = {key: word for mode in modes for key, word in mode.keys.items()}
    return [
        Binding(key, f"mode_key('{key}')", key, show=False, priority=True, id=f"mode.{key}", tooltip=word)
        for key, word in words.items()
    ]


class Modes:
    """The mode that is on, if one is: entering another leaves it."""

    def __init__(self) -> None:
        self.current: KeyMode | None = None

    @property
    def actions(self) -> tuple[Action, ...]:
        """What a person can do in the mode that is on, besides all else."""
        return () if self.current is None else self.current.actions

    def takes(self, key: str) -> bool:
        """Return whether ``key`` is for the mode; else it is left to the panels."""
        mode = self.current
        return mode is not None and (mode.has_keys or mode.has_on_a_page(key)) and mode.takes(key)

    def press(self, key: str) -> None:
        """Do what ``key`` means in the mode."""
        if self.current is not None:
            self.current.press(key)

    def point(self, event: Touched, snapshot: Snapshot | None) -> None:
        """Let the mode take notice of what is pointed at, which may have other keys, or drawn."""
        if self.current is None or snapshot is None:
            return
        if isinstance(event, PartPointed):
            self.current.point(event.step)
        elif not isinstance(event, Pointed):
            self.current.draw(event)
        self.show(snapshot)  # of the mode, unless that was left by a click

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
    """A subject that has keys of its own while it is on and a world has the focus.

    Entering it gives the world the focus, leaving it gives that back; unless it ``needs_focus``, its keys
    count where nothing has the focus as well. In any other panel the keys are those of that panel, and the
    key line tells them; then ``way_back`` stands on the world's border, the longest form first.
    """

    modes: Modes
    _focused_before: Widget | None = None
    keys: ClassVar[Mapping[str, str]]
    """The keys it may take, as Textual names them, and what each does."""
    way_back: ClassVar[tuple[str, ...]] = ()
    needs_focus: ClassVar[bool] = True

    @property
    def is_on(self) -> bool:
        """Whether it was entered and not left."""
        return self.modes.current is self

    @property
    def actions(self) -> tuple[Action, ...]:
        """What a person can do in it; what has the same key, or stands in the same menu, waits meanwhile."""
        return ()

    @property
    def has_keys(self) -> bool:
        """Whether its keys count: it is on, and no other panel than a world has the focus."""
        focused = self.screen.focused
        is_free = focused is None and not self.needs_focus
        return self.is_on and (is_free or isinstance(focused, WorldView))

    def has_on_a_page(self, key: str) -> bool:
        """Return whether ``key`` counts although a lesson's page, which has no use for it, has the focus."""
        return False

    def takes(self, key: str) -> bool:
        """Return whether ``key`` means something to it, while a world has the focus."""
        raise NotImplementedError

    def press(self, key: str) -> None:
        """Do what ``key`` means."""
        raise NotImplementedError

    def toggle(self) -> None:
        """Enter it, or leave it and say so."""
        raise NotImplementedError

    def point(self, step: tuple[int, int] | None) -> None:
        """Do what a second click under the cursor means, towards a side or in the middle (None)."""

    def draw(self, event: Touched) -> None:
        """Draw where the pointer was drawn over the world or the wheel was turned, or as was clicked."""

    def note(self, command: Command) -> None:
        """Take notice of ``command``, which is being sent."""

    def show(self, snapshot: Snapshot) -> None:
        """Show what can be done in ``snapshot``."""
        raise NotImplementedError

    def enter(self) -> None:
        """Let its keys count, and give the world the focus."""
        if self.modes.current is not None:
            self.modes.current.leave()
        self.modes.current = self
        self.board.keeps_focus = True
        self._focused_before = self.screen.focused
        if self.needs_focus or self.screen.focused is not None:
            self.screen.set_focus(self.board.world)

    def leave(self) -> None:
        """Give the keys back, and the focus where it came from."""
        if self.is_on:
            if self.has_keys:
                before = self._focused_before
                self.screen.set_focus(before if before in self.screen.focus_chain else None)
            self.modes.current = None
            self.board.keeps_focus = False
            self._write((), (), ())

    def _write(self, title: Sequence[str], prompt: Sequence[str], hints: Hints) -> None:
        """Write title and prompt, the longest forms first, on the world's border, and ``hints`` below all.

        Where its keys do not count, they are not told.
        """
        has_keys = self.has_keys
        if self.board.world is not None:
            prompts = tuple(prompt) if has_keys or not self.is_on else self.way_back
            self.board.world.show_mode(tuple(title), prompts, has_keys=has_keys)
        self.screen.query_one(KeyLine).hints = hints if has_keys else ()
