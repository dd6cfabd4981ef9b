"""What a player can play: runs of ours, or a program of somebody else's."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from rl_tui.lab.live.commands import Command
from rl_tui.lab.live.record import LearnedTable, Record
from rl_tui.lab.live.snapshot import Phase, Snapshot
from rl_tui.lab.live.state import State


class MakePlayable(Protocol):
    """Makes what a player plays."""

    def __call__(self, on_news: Callable[[], None], *, automatic: bool) -> Playable:
        """Return it; ``on_news`` is called, from any thread, when there is something new to show.

        With ``automatic`` off no step passes but those that commands ask for.
        """


class Playable(Protocol):
    """Takes commands and works them off in short pieces: see :class:`Playback`, which is the model."""

    handled: int
    touched: bool

    @property
    def state(self) -> State:
        """What it is doing."""

    @property
    def phase(self) -> Phase:
        """What a snapshot says that it is doing."""

    @property
    def changed(self) -> bool:
        """Whether there is something new to show."""

    @property
    def loaded(self) -> tuple[bool, bool]:
        """What changes when libraries were loaded."""

    @property
    def on_the_way(self) -> bool:
        """Whether something that was asked for and has an end is not done yet."""

    @property
    def record(self) -> Record:
        """What is needed to come back to here."""

    @property
    def table(self) -> LearnedTable | None:
        """The live table of what is shown, None where there is none."""

    @property
    def unanswered(self) -> float:
        """For how many seconds what it waits for has not answered; 0 where it does not wait."""

    def takes(self, command: Command) -> bool:
        """Return True if ``command`` need not wait."""

    def handle(self, command: Command) -> None:
        """Carry out ``command``, or begin to."""

    def work(self) -> float | None:
        """Do what is due, for some milliseconds; return in how many seconds to call again, None for never."""

    def snapshot(self) -> Snapshot:
        """Return the newest picture."""

    def close(self) -> None:
        """End what it has started beside the player's thread; called from another one."""
