"""Which panels are in view: all, those that a page of a lesson names, or those that mean something so far."""

from __future__ import annotations

from typing import Final

import numpy as np

from rl_tui.lessons.file.view import LessonRecord
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.kit.row import CONTROLS, CURVE, LAST_STEP, TABLE, TIMELINE, WORLD

_CHANGES_AGENT: Final = ("agent", "menus.open('a')")
"""What the commands begin with after which the settings are in view."""
_FIRST: Final = frozenset({WORLD})
_ONCE_LEARNED: Final = frozenset({TABLE, LAST_STEP})


def first_panels(lesson: LessonRecord | None, *, is_gradual: bool, shows_all: bool) -> frozenset[str] | None:
    """Return the ids of the panels with which a run, or the open page of ``lesson``, begins; None: all."""
    if shows_all:
        return None
    if lesson is not None:
        return lesson.lesson.panels_of(lesson.page)
    return _FIRST if is_gradual else None


class Disclosure(Subject):
    """Adds a panel once it means something, where a run began with ``is_gradual``; none ever goes again.

    The panels in view are a function of what was run and done. A person may ask for all of them.
    """

    is_gradual = False
    _so_far: frozenset[str] = _FIRST

    @property
    def in_view(self) -> frozenset[str] | None:
        """The ids of the panels in view, None: all."""
        shows_all = self.board.legends.shows_all_panels
        named = first_panels(self.link.wanted.lesson, is_gradual=self.is_gradual, shows_all=shows_all)
        return self._so_far if named is _FIRST else named

    def follow(self, snapshot: Snapshot) -> None:
        """Bring into view what means something in ``snapshot``."""
        if self.is_gradual:
            self._so_far |= self._meaningful(snapshot)
        self.board.reshape(shown=self.in_view)

    def _meaningful(self, snapshot: Snapshot) -> frozenset[str]:
        agent, found = snapshot.agent, set[str]()
        if snapshot.counters.episodes:
            found |= {CURVE, TIMELINE}
        is_looked_for = not self._so_far >= _ONCE_LEARNED
        if is_looked_for and np.any(agent.q[agent.visits > 0] != snapshot.recipe.hyperparameters.initial_q):
            if TABLE in self._so_far and snapshot.playback.phase is Phase.PAUSED:
                found.add(LAST_STEP)
            found.add(TABLE)
        return frozenset(found)

    def note(self, command: str) -> None:
        """Bring the settings into view before ``command`` goes to them."""
        if command.startswith(_CHANGES_AGENT):
            self._so_far |= {CONTROLS}
            self.board.reshape(shown=self.in_view)

    def turn(self) -> None:
        """Show all panels from now on, or again only those that mean something."""
        self.board.legends.turn_panels()
        is_all = self.board.legends.shows_all_panels
        self.screen.tell("All panels." if is_all else "Only panels that mean something so far. m p: all.")
        self.board.reshape(shown=self.in_view)

    def why_not(self, deed: str) -> str:
        """Return why no panel is left out."""
        is_all = self.in_view is None and not self.board.legends.shows_all_panels
        return "all panels are in view" if is_all else ""

    def value(self, deed: str) -> str:
        """Return whether all panels are in view."""
        return "all" if self.in_view is None else "few"
