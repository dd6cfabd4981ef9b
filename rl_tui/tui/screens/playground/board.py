"""The panels of the playground and the container that arranges them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TypeVar

from textual import events
from textual.app import ComposeResult
from textual.containers import Container
from textual.geometry import NULL_OFFSET, NULL_SPACING, Region, Size
from textual.layout import ArrangeResult, Layout, WidgetPlacement
from textual.message import Message
from textual.widget import Widget

from rl_tui.lab.live.snapshot import Phase, Snapshot
from rl_tui.lab.live.viewport import Viewport
from rl_tui.tui.panels.catalogue import (
    CONTROLS,
    CURVE,
    MICROSCOPE,
    PANELS,
    TABLE,
    TIMELINE,
    WORLD,
    PanelRow,
)
from rl_tui.tui.panels.controls.controls import Controls
from rl_tui.tui.panels.controls.slider import Slider
from rl_tui.tui.panels.curve.curve import ReturnCurve
from rl_tui.tui.panels.microscope.microscope import Microscope, lit_sources
from rl_tui.tui.panels.panel import BoardPanel
from rl_tui.tui.panels.pointing import Pointed
from rl_tui.tui.panels.q_table.q_table import QTable
from rl_tui.tui.panels.timeline.timeline import HINTS, TimelineBar
from rl_tui.tui.panels.world.make_view import make_world_view
from rl_tui.tui.panels.world.view import WorldView
from rl_tui.tui.screens.legend_switch import LegendSwitch
from rl_tui.tui.screens.playground.arrangement import Shape, arrangement
from rl_tui.tui.screens.playground.wanted import Wanted
from rl_tui.tui.theme.look import Look

Kind = TypeVar("Kind", bound=BoardPanel)


class Board(Container):
    """One widget for each row of ``panels``, its id that of the row.

    One panel may be zoomed to cover all others, and one of those that have a key of their own may be open.
    ``show`` draws a snapshot on all of them, and what is ``wanted`` though no snapshot has it yet. The view
    of the world is made for the first one: only then is its kind known.
    """

    class Toggled(Message):
        """A panel was opened or closed."""

    def __init__(self, look: Look, wanted: Wanted, panels: Sequence[PanelRow] = PANELS) -> None:
        super().__init__(id="board")
        self.look = look
        self.rows = {row.id: row for row in panels}
        self._panels = {row.id: row.make(look) for row in panels}
        self.world: WorldView | None = None
        self._is_explained = False
        self.legends = LegendSwitch(None)
        self.table = self._made(TABLE, QTable)
        self.curve = self._made(CURVE, ReturnCurve)
        self.timeline = self._made(TIMELINE, TimelineBar)
        self.controls = self._made(CONTROLS, Controls)
        self.controls.begin_with(wanted.recipe)
        self.microscope = self._made(MICROSCOPE, Microscope)
        self._wanted = wanted
        self._focused_before: Widget | None = None
        self._focused_beside_sliders: Widget | None = None
        self._arrangement = _BoardLayout(panels)

    def _made(self, panel: str, kind: type[Kind]) -> Kind:
        made = self._panels[panel]
        assert isinstance(made, kind)
        return made

    def compose(self) -> ComposeResult:
        """Yield the panels in the order of the tab key."""
        yield from self._panels.values()

    def panel(self, panel: str) -> BoardPanel:
        """Return the widget of the row ``panel``."""
        return self._panels[panel]

    def show(self, snapshot: Snapshot) -> None:
        """Draw ``snapshot``; what a person can set is drawn as it is wanted."""
        if self.world is None:
            self.world = make_world_view(snapshot.world, self.look, id=WORLD, classes="panel")
            self.world.caption, self.world.is_explained = self.rows[WORLD].caption, self.is_explained
            self.world.is_numbered = self.is_numbered
            self.world.shows_actions = self.shows_actions
            self._panels[WORLD] = self.world
            self.run_worker(self._replace_placeholder(self.world))
        self.table.sources = lit_sources(snapshot) if self.opened == MICROSCOPE else frozenset()
        self.controls.wanted = self._wanted.recipe.hyperparameters
        self.timeline.sought = self._wanted.step
        for panel in self._shown():
            panel.revealed = self._wanted.revealed or snapshot.playback.phase is Phase.SPENT
            panel.show(snapshot)
        world = snapshot.world
        shape = Shape(world.drawing, self.table.rows, world.space.pairs, int(self.is_explained))
        if shape != self._arrangement.shape:
            self._arrangement.shape = shape
            self._arrange_again()

    @property
    def is_explained(self) -> bool:
        """Whether the panels show their captions and legends."""
        return self._is_explained

    @is_explained.setter
    def is_explained(self, is_explained: bool) -> None:
        self._is_explained = is_explained
        for panel in self._panels.values():
            panel.is_explained = is_explained

    @property
    def is_numbered(self) -> bool:
        """Whether the cells of a map have the numbers of their states."""
        return self.legends.numbers_states

    @is_numbered.setter
    def is_numbered(self, is_numbered: bool) -> None:
        self.legends.numbers_states = is_numbered
        if self.world is not None:
            self.world.is_numbered = is_numbered

    @property
    def shows_actions(self) -> bool:
        """Whether the cells of a map show Q of every action, where they have room."""
        return self.legends.shows_actions

    @shows_actions.setter
    def shows_actions(self, shows_actions: bool) -> None:
        self.legends.shows_actions = shows_actions
        if self.world is not None:
            self.world.shows_actions = shows_actions

    def _shown(self) -> Iterator[BoardPanel]:
        """Yield the panels that are not closed."""
        for row in self.rows.values():
            if row.opened_by is None or row.id == self.opened:
                yield self._panels[row.id]

    def on_descendant_focus(self, event: events.DescendantFocus) -> None:
        """Write the keys of the timeline, which has no border, on the border of the curve above it."""
        self.curve.hints = HINTS if event.widget is self.timeline else ()
        if not isinstance(event.widget, Slider):
            self._focused_beside_sliders = event.widget

    def leave_slider(self) -> None:
        """Give the focus back to the panel that had it before the sliders; to none if none had."""
        before = self._focused_beside_sliders
        self.screen.set_focus(before if before in self.screen.focus_chain else None)

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
        return all(panel.is_complete for panel in self._shown())

    @property
    def zoomed(self) -> str | None:
        """The id of the panel that covers all others."""
        return self._arrangement.zoomed

    def zoom(self, panel: str | None) -> None:
        """Let ``panel`` cover all others; None shows all."""
        self._arrangement.zoomed = panel
        self._arrange_again()

    @property
    def opened(self) -> str | None:
        """The id of the panel that was opened by its key."""
        return self._arrangement.opened

    def toggle(self, panel: str) -> None:
        """Open ``panel``, which takes the focus, in place of the one that is open; or close it."""
        was_open, row = self.opened, self.rows[panel]
        if was_open != panel and not row.needs(self._arrangement.shape.drawing):
            self.notify(f"{row.title}: there is nothing to show of this world", markup=False)
            return
        self.close()
        if was_open == panel:
            return
        self._focused_before = self.screen.focused
        self._open(panel)
        self._panels[panel].focus()

    def close(self) -> None:
        """Close the panel that is open; if it had the focus, that goes back to where it was."""
        if self.opened is not None:
            had_focus = self._panels[self.opened].has_focus_within
            self._open(None)
            if had_focus:
                self.screen.set_focus(self._focused_before)
            self._focused_before = None

    def _open(self, panel: str | None) -> None:
        for each, is_open in ((self.opened, False), (panel, True)):
            if each is not None:
                self._panels[each].display = is_open
        self._arrangement.opened = panel
        self.zoom(None)
        self.post_message(self.Toggled())

    def bring_into_view(self, panel: str) -> None:
        """Show ``panel``: end the zoom, and close the panel that stands in its place."""
        if self.zoomed not in (None, panel):
            self.zoom(None)
        if panel not in self._arrangement.regions(self.size, None):
            self.close()

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
        # a child's, since a container forgets its arrangement only for a child
        self.table.refresh(layout=True)

    async def _replace_placeholder(self, view: WorldView) -> None:
        if not self.is_attached:
            return
        with self.app.batch_update():
            await self.query_one(f"#{WORLD}").remove()
            await self.mount(view, before=0)


class _BoardLayout(Layout):
    name = "board"

    def __init__(self, panels: Sequence[PanelRow]) -> None:
        self.shape = Shape()
        self.zoomed: str | None = None
        self.opened: str | None = None
        self.placed: frozenset[str] = frozenset()
        self._panels = panels

    def regions(self, size: Size, zoomed: str | None) -> dict[str, Region]:
        return arrangement(size, self.shape, zoomed, self.opened, self._panels)

    def arrange(
        self, parent: Widget, children: list[Widget], size: Size, greedy: bool = True
    ) -> ArrangeResult:
        regions = self.regions(size, self.zoomed)
        self.placed = frozenset(regions)
        return [
            WidgetPlacement(regions[child.id], NULL_OFFSET, NULL_SPACING, child)
            for child in children
            if child.id in regions
        ]
