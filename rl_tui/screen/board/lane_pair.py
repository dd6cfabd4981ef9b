"""Two runs side by side."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.kit.panel import BoardPanel
from rl_tui.screen.kit.row import WORLD, PanelRow, beside
from rl_tui.screen.panels.side_by_side import (
    Differing,
    name_panels,
    seen_differences,
    sides,
    stand_alone,
)
from rl_tui.screen.panels.world.view import WorldView
from rl_tui.screen.panels.world_views import make_world_view
from rl_tui.screen.theme.look import Look


class LanePair:
    """The widgets of twofold rows: ``panels`` at the left, ``twins`` at the right.

    The left run has the lower number, but the right one may be controlled (``leads_right``).
    """

    def __init__(self, panels: Mapping[str, BoardPanel], look: Look) -> None:
        self.twins: dict[str, BoardPanel] = {}
        """The widgets at the right, by row id."""
        self.is_shown = self.leads_right = False
        self._panels = panels
        self._look = look
        self._note: tuple[str, ...] = ()

    def make(self, snapshot: Snapshot, rows: Iterable[PanelRow]) -> None:
        """Make the twins of the twofold ``rows``."""
        for row in rows:
            if row.is_twofold:
                name = beside(row.id)
                twin = (
                    make_world_view(snapshot.world, self._look, id=name, classes="panel")
                    if row.id == WORLD
                    else row.make(self._look, name)
                )
                twin.caption = row.caption
                self.twins[row.id] = twin

    def led(self, panel: str) -> str:
        """Return the row's widget with the controlled run."""
        return beside(panel) if self.leads_right and panel in self.twins else panel

    def row_of(self, panel: str) -> str | None:
        """Return the widget's twofold row."""
        return next((row for row in self.twins if panel in (row, beside(row))), None)

    @property
    def panels(self) -> list[BoardPanel]:
        """The panels of one of the two runs."""
        return [each for row, twin in self.twins.items() for each in (self._panels[row], twin)]

    def take_lead(self, snapshot: Snapshot, *, is_shown: bool) -> bool:
        """Update the controlled run, and return whether anything changed."""
        group, before = snapshot.run_group, (self.is_shown, self.leads_right)
        self.is_shown = is_shown
        self.leads_right = is_shown and group.beside is not None and group.beside < group.shown
        if not is_shown:
            for row in self.twins:
                stand_alone(self._panels[row])
        return before != (self.is_shown, self.leads_right)

    def mark(self, snapshot: Snapshot, layer: Layer) -> None:
        """Title both, and mark where their actions differ in ``layer``."""
        left, right = sides(snapshot)
        world, table = seen_differences(left, right, layer)
        at_left = [self._panels[row] for row in self.twins]
        differing, beside = Differing(world.states, table.states), Differing(world.right, table.right)
        name_panels(at_left, left, differing, is_led=not self.leads_right, look=self._look)
        name_panels(self.twins.values(), right, beside, is_led=self.leads_right, look=self._look)
        # equal exact answers of one world say nothing about the runs
        self._note = world.words(left) if world.states or layer is not Layer.OPTIMAL else ()
        self._place_note()

    def show(self, snapshot: Snapshot, layer: Layer) -> None:
        """Draw both. The controlled one decides which part is in view."""
        self.mark(snapshot, layer)
        left, right = sides(snapshot)
        led, other = (right, left) if self.leads_right else (left, right)
        for row, twin in self.twins.items():
            first, second = (twin, self._panels[row]) if self.leads_right else (self._panels[row], twin)
            first.show(led)
            second.align_with(first)
            second.show(other)
            _align(first, second)

    def follow_focus(self) -> None:
        """Leave the focused world's border to its keys."""
        self._place_note()
        for panel in (self._panels[WORLD], *self.twins.values()):
            if self.is_shown and isinstance(panel, WorldView):
                panel.redraw()

    def _place_note(self) -> None:
        left, right = self._panels[WORLD], self.twins.get(WORLD)
        if isinstance(left, WorldView) and isinstance(right, WorldView):
            left.has_note, right.has_note = right.has_focus, not right.has_focus
            for view in (left, right):
                view.note = self._note if view.has_note else ()

    def align(self, panel: object) -> None:
        """Align the other run's panel if both are in view."""
        for row, twin in self.twins.items():
            left = self._panels[row]
            if self.is_shown and panel in (left, twin):
                _align(*((twin, left) if panel is left else (left, twin)))


def _align(panel: BoardPanel, twin: BoardPanel) -> None:
    if panel.stance != twin.stance:
        panel.align_with(twin)
        panel.redraw()
