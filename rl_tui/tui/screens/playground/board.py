"""The panels of the playground and the container that arranges them."""

from __future__ import annotations

from textual import events
from textual.app import ComposeResult
from textual.containers import Container
from textual.geometry import NULL_OFFSET, NULL_SPACING, Size
from textual.layout import ArrangeResult, Layout, WidgetPlacement
from textual.widget import Widget
from textual.widgets import Static

from rl_tui.lab.live.snapshot import Phase, Snapshot
from rl_tui.lab.live.viewport import Viewport
from rl_tui.lab.run.recipe import Recipe
from rl_tui.tui.panels.budget import BudgetPanel
from rl_tui.tui.panels.controls.controls import Controls
from rl_tui.tui.panels.curve.curve import ReturnCurve
from rl_tui.tui.panels.last_step.last_step import LastStepPanel
from rl_tui.tui.panels.microscope.microscope import Microscope, lit_sources
from rl_tui.tui.panels.pointing import Pointed
from rl_tui.tui.panels.q_table.q_table import QTable
from rl_tui.tui.panels.timeline.timeline import HINTS, TimelineBar
from rl_tui.tui.panels.world.make_view import make_world_view
from rl_tui.tui.panels.world.view import WorldView
from rl_tui.tui.screens.playground.arrangement import (
    BUDGET,
    CONTROLS,
    CURVE,
    LAST_STEP,
    MICROSCOPE,
    TABLE,
    TIMELINE,
    WORLD,
    Shape,
    arrangement,
)
from rl_tui.tui.theme.look import Look


class Board(Container):
    """Every panel, each with its name as id; one may be zoomed to cover all others.

    ``show`` draws a snapshot on all of them. The world's view is made for the first one: only then is its
    kind known.
    """

    def __init__(self, look: Look, recipe: Recipe) -> None:
        super().__init__(id="board")
        self.look = look
        self.table = QTable(look, id=TABLE, classes="panel")
        self.curve = ReturnCurve(look, id=CURVE, classes="panel")
        self.curve.can_focus = True
        self.timeline = TimelineBar(look, id=TIMELINE)
        self.budget = BudgetPanel(look, id=BUDGET, classes="panel")
        self.controls = Controls(look, recipe, id=CONTROLS, classes="panel")
        self.last_step = LastStepPanel(look, id=LAST_STEP, classes="panel")
        self.microscope = Microscope(look, id=MICROSCOPE, classes="panel")
        self.microscope.display = False
        self.world: WorldView | None = None
        self._arrangement = _BoardLayout()

    def compose(self) -> ComposeResult:
        """Yield the panels in the order of the tab key."""
        preparing = Static(f"preparing {self.look.glyphs.ellipsis}", id=WORLD, classes="panel")
        preparing.border_title = "World"
        yield preparing
        yield self.table
        yield self.curve
        yield self.timeline
        yield self.budget
        yield self.controls
        yield self.last_step
        yield self.microscope

    def show(self, snapshot: Snapshot, *, revealed: bool) -> None:
        """Draw ``snapshot``; ``revealed`` shows what a bandit keeps secret."""
        if self.world is None:
            self.world = make_world_view(snapshot.world, self.look)
            self.world.id, self.world.can_focus = WORLD, True
            self.world.add_class("panel")
            self.run_worker(self._replace_placeholder(self.world))
        self.reveal(revealed or snapshot.playback.phase is Phase.SPENT)
        self.table.sources = lit_sources(snapshot) if self.dissects else frozenset()
        for panel in (self.world, self.table, self.curve, self.budget, self.controls, self.last_step):
            panel.show(snapshot)
        self.timeline.show(snapshot)
        if self.dissects:
            self.microscope.show(snapshot)
        world = snapshot.world
        shape = Shape(world.drawing, self.table.rows, world.space.pairs)
        if shape != self._arrangement.shape:
            self._arrangement.shape = shape
            self._arrange_again()

    def reveal(self, revealed: bool) -> None:
        """Show or hide what a bandit keeps secret."""
        for panel in (self.world, self.table, self.curve, self.budget, self.microscope):
            if panel is not None:
                panel.revealed = revealed

    def on_descendant_focus(self, event: events.DescendantFocus) -> None:
        """Write the keys of the timeline, which has no border, on the border of the curve above it."""
        self.curve.hints = HINTS if event.widget is self.timeline else ()

    def on_descendant_blur(self) -> None:
        """Remove these keys."""
        self.curve.hints = ()

    def on_pointed(self, event: Pointed) -> None:
        """Show in the table where the world's cursor stands, and in the world where the table's does."""
        event.stop()
        for panel in (self.table, self.world):
            if panel is not None and panel is not event.panel:
                panel.point_at(event.pairs)

    @property
    def viewport(self) -> Viewport:
        """The parts of a large world that are in view."""
        return Viewport(self.world.cells if self.world else None, self.table.row_range)

    @property
    def is_complete(self) -> bool:
        """Whether the newest snapshot has all that is in view."""
        panels = (self.table, self.world, self.microscope if self.dissects else None)
        return all(panel is None or panel.is_complete for panel in panels)

    @property
    def zoomed(self) -> str | None:
        """The id of the panel that covers all others."""
        return self._arrangement.zoomed

    def zoom(self, panel: str | None) -> None:
        """Let ``panel`` cover all others; None shows all."""
        self._arrangement.zoomed = panel
        self._arrange_again()

    @property
    def dissects(self) -> bool:
        """Whether the microscope is open."""
        return self._arrangement.dissected

    def dissect(self, *, opened: bool) -> None:
        """Open or close the microscope; a panel that covers all others goes back to its place."""
        self._arrangement.dissected = self.microscope.display = opened
        self.zoom(None)

    def has_room_for(self, panel: str) -> bool:
        """Return whether ``panel`` has a place while none is zoomed, beside the microscope if it is open."""
        return panel in arrangement(self.size, self._arrangement.shape, dissected=self.dissects)

    def shows(self, panel: str) -> bool:
        """Return whether ``panel`` has a place on the screen."""
        return panel in self._arrangement.placed

    def panel_of(self, widget: Widget | None) -> str:
        """Return the id of the panel that ``widget`` stands in; of the world if in none."""
        for node in widget.ancestors_with_self if widget else ():
            if node.parent is self and node.id:
                return node.id
        return WORLD

    @property
    def layout(self) -> Layout:
        """The arrangement, in place of one from CSS."""
        return self._arrangement

    def _arrange_again(self) -> None:
        self.table.refresh(
            layout=True
        )  # a child's, since a container forgets its arrangement only for a child

    async def _replace_placeholder(self, view: WorldView) -> None:
        if not self.is_attached:
            return
        with self.app.batch_update():
            await self.query_one(f"#{WORLD}").remove()
            await self.mount(view, before=0)


class _BoardLayout(Layout):
    name = "board"

    def __init__(self) -> None:
        self.shape = Shape()
        self.zoomed: str | None = None
        self.dissected = False
        self.placed: frozenset[str] = frozenset()

    def arrange(
        self, parent: Widget, children: list[Widget], size: Size, greedy: bool = True
    ) -> ArrangeResult:
        regions = arrangement(size, self.shape, self.zoomed, dissected=self.dissected)
        self.placed = frozenset(regions)
        return [
            WidgetPlacement(regions[child.id], NULL_OFFSET, NULL_SPACING, child)
            for child in children
            if child.id in regions
        ]
