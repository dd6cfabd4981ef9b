"""The scenario's file, which somebody may edit while its world is on screen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from rl_tui.common.errors import ScenarioError, UserError
from rl_tui.common.findings import one_line
from rl_tui.lab.export.scenario_file import is_on_screen
from rl_tui.lab.run.library import recipe_with, reread
from rl_tui.lab.run.recipe import Recipe
from rl_tui.tui.screens.dialogs.choice import Candidate, Choice
from rl_tui.tui.screens.playground.actions.subject import Subject
from rl_tui.worlds.files.scenario import Scenario

_NEW: Final = "new"
_OLD: Final = "old"
_LONGEST_NAME: Final = 60
_UNTIL_READ: Final = 15.0


@dataclass(eq=False)
class ScenarioActions(Subject):
    """Goes to other scenarios, and offers what the file of this one says now, where that is not on screen.

    ``is_known`` tells whether the world came from that file: a session brings its own copy. In a lesson the
    world stays as it is. ``take`` opens
    another recipe in place of the run; ``go_by`` goes to a scenario that stands so many places further in the
    catalogue.
    """

    is_known: bool
    take: Callable[[Recipe], None]
    go_by: Callable[[int], None]
    _declined = ""

    def previous(self) -> None:
        """Go to the previous scenario of the catalogue."""
        self.go_by(-1)

    def following(self) -> None:
        """Go to the next scenario of the catalogue."""
        self.go_by(1)

    def map_settings(self) -> None:
        """Show how the run would do with other settings; one of those runs may be opened in its place."""
        # it brings much that the first paint has no need of
        from rl_tui.tui.screens.atlas.opening import open_atlas

        open_atlas(self, self.take)

    def begin_with_old_or_new(self, start_again: Callable[[], None]) -> None:
        """Ask whether the run is to begin anew with the new content, if there is any.

        ``start_again`` starts it with the old content: where there is no other, or that is the answer, or the
        new one has faults, which are shown.
        """
        scenario, fault = None, ""
        try:
            if self.is_known and self.link.wanted.lesson is None and not self.screen.in_kiosk:
                scenario = reread(self.link.wanted.recipe.scenario)
        except ScenarioError as error:
            more = f"; and {len(error.faults) - 1} more" if len(error.faults) > 1 else ""
            fault = f"the file has changed, and the old world stays: {error.faults[0]}{more}"
        if scenario is not None and scenario.text != self._declined and not self._is_on_screen(scenario):
            self._ask(scenario, start_again)
            return
        start_again()
        if fault:
            self._warn(fault)

    def _is_on_screen(self, scenario: Scenario) -> bool:
        """Return whether the file says no more than what is on screen: it was saved from here."""
        snapshot = self.snapshot
        return snapshot is not None and is_on_screen(scenario, snapshot.recipe, snapshot.world.mdp)

    def _ask(self, scenario: Scenario, start_again: Callable[[], None]) -> None:
        def answer(chosen: str) -> None:
            if chosen == _OLD:
                self._declined = scenario.text
                start_again()
                return
            try:
                self.take(recipe_with(scenario, self.link.wanted.recipe))
            except UserError as fault:
                self._warn(str(fault))

        name = one_line(scenario.source.name, _LONGEST_NAME)
        new = Candidate(_NEW, "as the file is now", ("a new run in the new world; the old run is kept",))
        old = Candidate(_OLD, "as it was", ("the old world once more; it is not asked again",))
        self.ask(Choice(f"Start again: {name} has changed", (new, old), "", self.glyphs), answer)

    def _warn(self, text: str) -> None:
        self.screen.tell(text, severity="warning", timeout=_UNTIL_READ)
