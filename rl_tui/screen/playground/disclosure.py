"""The choice of the panels in view."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from rl_tui.lessons.file.view import LessonRecord
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.kit.row import BUDGET, CAPTION, CONTROLS, CURVE, LAST_STEP, TABLE, TIMELINE, WORLD
from rl_tui.screen.kit.snapshot_facts import has_optimal_policy

_CHANGES_AGENT: Final = ("agent", "menus.open('a')")
"""Starts of the commands that bring the settings into view."""
FIRST_PANELS: Final = frozenset({WORLD, CAPTION})
"""The first panels of a run whose panels appear one by one."""
_LATER: Final = frozenset({TABLE, CURVE, TIMELINE, BUDGET, LAST_STEP, CONTROLS})
_ONCE_LEARNED: Final = frozenset({TABLE, LAST_STEP})


def panels_in_view(
    lesson: LessonRecord | None, so_far: frozenset[str] | None, *, shows_all: bool
) -> frozenset[str] | None:
    """Return the panels in view (None: all)."""
    if shows_all:
        return None
    return so_far if lesson is None else lesson.lesson.panels_of(lesson.page)


def _is_one_step(before: Snapshot, snapshot: Snapshot) -> bool:
    is_still = before.playback.phase is not Phase.RUNNING and snapshot.playback.phase is Phase.PAUSED
    return is_still and abs(snapshot.counters.step - before.counters.step) == 1


@dataclass(eq=False)
class Disclosure(Subject):
    """The panels ``so_far`` (None: all), and more as they get a meaning."""

    so_far: frozenset[str] | None
    is_gradual: bool
    _before: Snapshot | None = None

    @property
    def in_view(self) -> frozenset[str] | None:
        """The panels in view, None for all."""
        shows_all = self.board.legends.shows_all_panels
        return panels_in_view(self.link.wanted.lesson, self.so_far, shows_all=shows_all)

    @property
    def hides_some(self) -> bool:
        """True if a usual panel is hidden."""
        return self.in_view is not None and not self.in_view >= _LATER

    def follow(self, snapshot: Snapshot) -> None:
        """Add panels that have a meaning in ``snapshot``."""
        if self.is_gradual and self.so_far is not None:
            self.so_far |= self._meaningful(snapshot, self.so_far)
        self._before = snapshot
        self.board.reshape(shown=self.in_view)

    def _meaningful(self, snapshot: Snapshot, so_far: frozenset[str]) -> frozenset[str]:
        agent, found = snapshot.agent, set[str]()
        if snapshot.counters.episodes:
            found |= {CURVE, TIMELINE, BUDGET}
        is_looked_for = not so_far >= _ONCE_LEARNED
        if is_looked_for and np.any(agent.q[agent.visits > 0] != snapshot.recipe.hyperparameters.initial_q):
            if TABLE in so_far and snapshot.playback.phase is Phase.PAUSED:
                found.add(LAST_STEP)
            found.add(TABLE)
        if self._before is not None and _is_one_step(self._before, snapshot):
            found.add(LAST_STEP)
        if CONTROLS not in so_far and has_optimal_policy(snapshot):
            found.add(CONTROLS)
        return frozenset(found)

    def note(self, command: str) -> None:
        """Show the settings before ``command`` changes one."""
        if self.so_far is not None and command.startswith(_CHANGES_AGENT):
            self.so_far |= {CONTROLS}
            self.board.reshape(shown=self.in_view)

    def turn(self) -> None:
        """Switch between all panels and meaningful ones."""
        self.board.legends.turn_panels()
        is_all = self.board.legends.shows_all_panels
        self.screen.tell("All panels are shown." if is_all else "Only useful panels are shown now. m p: all.")
        self.board.reshape(shown=self.in_view)
        self.board.post_message(self.board.Toggled())

    def why_not(self, deed: str) -> str:
        """Explain why no panel is left out."""
        is_all = self.in_view is None and not self.board.legends.shows_all_panels
        return "all panels are in view" if is_all else ""

    def value(self, deed: str) -> str:
        """Return whether all panels are in view."""
        return "all" if self.in_view is None else "few"
