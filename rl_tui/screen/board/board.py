"""The panels of the playground."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Final, TypeVar

import numpy as np
from textual import events
from textual.app import ComposeResult
from textual.containers import Container
from textual.layout import Layout
from textual.message import Message
from textual.widget import Widget

from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.live.viewport import Viewport
from rl_tui.screen.board.board_layout import BoardLayout, LessonPlace
from rl_tui.screen.board.lane_pair import LanePair
from rl_tui.screen.board.wanted import Wanted
from rl_tui.screen.frame.legend_switch import LegendSwitch
from rl_tui.screen.frame.shape import Shape
from rl_tui.screen.kit import row as rows
from rl_tui.screen.kit.counterparts import pairs_in
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.kit.panel import BoardPanel
from rl_tui.screen.kit.pointing import NOWHERE, Moved, Pointed
from rl_tui.screen.kit.snapshot_facts import as_learned, is_secret
from rl_tui.screen.panels.caption import CaptionLine
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.screen.panels.controls.controls import Controls
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.screen.panels.curve.curve import ReturnCurve
from rl_tui.screen.panels.discount import DiscountPanel
from rl_tui.screen.panels.draw_panel import DrawPanel
from rl_tui.screen.panels.lesson.lesson import LessonPanel
from rl_tui.screen.panels.lesson.words import open_page
from rl_tui.screen.panels.microscope.microscope import Microscope, lit_sources
from rl_tui.screen.panels.model import ModelPanel
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.screen.panels.status_line import StatusLine
from rl_tui.screen.panels.timeline import HINTS, TimelineBar
from rl_tui.screen.panels.world.view import WorldView
from rl_tui.screen.panels.world_views import make_world_view
from rl_tui.screen.theme.look import Look

Kind = TypeVar("Kind", bound=BoardPanel)
_LEAST_WITH_HEADING: Final = {rows.LAST_STEP: 5}  # rows
_LEAST_WITH_KEYS: Final = 7


class Board(Container):
    """One widget per row of the panel table, with the same id.

    With two runs, a twofold row has a second widget at the right. ``world`` and ``table`` show the controlled
    run. With ``keeps_focus`` an opened panel does not take the focus from the world.
    """

    class Toggled(Message):
        """A panel or its full screen was toggled."""

    def __init__(self, look: Look, wanted: Wanted, legends: LegendSwitch, shape: Shape) -> None:
        super().__init__(id="board")
        self.look = look
        self.legends, self.rows = legends, {row.id: row for row in PANELS}
        self._panels = {row.id: row.make(look) for row in PANELS}
        self._pair = LanePair(self._panels, look)
        self.table = self._made(rows.TABLE, QTable)
        """The table of the controlled run."""
        self.world: WorldView | None = None
        """The world of the controlled run, None before the first snapshot."""
        self.is_one_lane = self.keeps_focus = False
        self.wanted_layer = Layer.Q  # of worlds and tables
        self.curve = self._made(rows.CURVE, ReturnCurve)
        self.curve.begin_with(wanted.recipe)
        self.timeline = self._made(rows.TIMELINE, TimelineBar)
        self.caption = self._made(rows.CAPTION, CaptionLine)
        self.controls = self._made(rows.CONTROLS, Controls)
        self.controls.begin_with(wanted.recipe)
        self.microscope = self._made(rows.MICROSCOPE, Microscope)
        self.discount = self._made(rows.DISCOUNT, DiscountPanel)
        self.model = self._made(rows.MODEL, ModelPanel)
        self.tools = self._made(rows.DRAW, DrawPanel)
        self._wanted = wanted
        self._focused_before: Widget | None = None
        self._focused_beside_sliders: Widget | None = None
        self._arrangement = BoardLayout(shape)
        self.lesson = LessonPlace(self, self._made(rows.LESSON, LessonPanel), self._arrangement)
        self._snapshot: Snapshot | None = None
        self._about = NOWHERE  # pairs that the open panel is about
        self._mounting = asyncio.Lock()
        self.apply_switches()

    def _made(self, panel: str, kind: type[Kind]) -> Kind:
        made = self._panels[panel]
        assert isinstance(made, kind)
        return made

    def compose(self) -> ComposeResult:
        """Yield the panels in tab order."""
        yield from self._panels.values()

    def panel(self, panel: str) -> BoardPanel:
        """Return the widget with the id ``panel``."""
        return self._panels[panel]

    def show(self, snapshot: Snapshot) -> None:
        """Draw ``snapshot``, with wanted settings."""
        self._snapshot = snapshot
        if self.world is None:
            view = make_world_view(snapshot.world, self.look, id=rows.WORLD, classes="panel")
            self._panels[rows.WORLD] = self.world = view
            view.caption = self.rows[rows.WORLD].caption
            self.apply_switches()
            self.run_worker(self._replace_placeholder(view))
        if snapshot.beside is not None and not self._pair.twins:
            self._pair.make(snapshot, self.rows.values())
            self._panels |= {rows.beside(row): twin for row, twin in self._pair.twins.items()}
            self.apply_switches()
            self.run_worker(self._mount_twins())
        # a resumed session announces its runs before they are ready
        awaits_lanes = self._arrangement.shape.lanes and snapshot.playback.phase is Phase.PREPARING
        self.reshape(
            lanes=(snapshot.beside is not None or awaits_lanes) and not self.is_one_lane,
            is_program=snapshot.program is not None,
            has_lesson=snapshot.lesson is not None,
            spotlight=None if snapshot.lesson is None else open_page(snapshot.lesson.record).spotlight,
            is_fresh=not snapshot.timeline.current.end,
            drawing=snapshot.world.drawing,
            table_rows=self.table.rows_of(snapshot),
            hides_exact=is_secret(snapshot),
            actions=int(np.diff(snapshot.world.space.first_pair).max(initial=1)),
        )
        if self._pair.twins:
            self._take_lead(snapshot)
        if snapshot.lesson is not None:
            self.lesson.place(snapshot.lesson, self.screen.size)
        self.table.sources = lit_sources(snapshot) if self.opened == rows.MICROSCOPE else frozenset()
        self.controls.wanted = self._wanted.recipe.hyperparameters
        self.controls.marks_all_flips = self.opened == rows.DISCOUNT
        self.timeline.sought = self._wanted.step
        learned, pair = as_learned(snapshot), self._pair.panels if self._pair.is_shown else []
        for panel in self._shown():
            if isinstance(panel, WorldView):
                panel.names_policies_key = self.opened != rows.POLICIES
                panel.replaces_header = self.caption.replaces_header
            if panel not in pair:
                panel.show(learned if isinstance(panel, WorldView | QTable) else snapshot)
        if pair:
            self._pair.show(learned, self.wanted_layer)
        if self._subject_in(snapshot) != self._about:
            self._point_at(NOWHERE)

    def reshape(self, **changes: Any) -> None:
        """Arrange the panels again if the shape changes."""
        shape = replace(self._arrangement.shape, **changes)
        if shape != self._arrangement.shape:
            self._arrangement.shape = shape
            self._arrange_again()

    def _take_lead(self, snapshot: Snapshot) -> None:
        world, layout = self.world, self._arrangement
        lanes = snapshot.beside is not None and layout.shape.lanes
        is_pair = lanes and rows.beside(rows.WORLD) in layout.regions(self.screen.size, None)
        if not self._pair.take_lead(snapshot, is_shown=is_pair):
            return
        self.table = self._made(self._pair.led(rows.TABLE), QTable)
        self.world = self._made(self._pair.led(rows.WORLD), WorldView)
        if world is not None and self.world is not None and world is not self.world:
            self.world.take_over(world)
        zoomed = None if self.zoomed is None else self._pair.row_of(self.zoomed)
        if zoomed is not None:
            self.zoom(self._pair.led(zoomed))
        self._keep_focus_in_view()

    async def _mount_twins(self) -> None:
        async with self._mounting:
            if self.is_attached:
                for row, twin in self._pair.twins.items():
                    await self.mount(twin, after=f"#{row}")
                self._arrange_again()

    def turn_lanes(self) -> None:
        """Switch between one and two runs, if they fit."""
        self.is_one_lane = self.is_paired
        if self._snapshot is not None:
            self.show(self._snapshot)

    @property
    def is_paired(self) -> bool:
        """True if two runs are side by side."""
        return self._pair.is_shown

    def on_resize(self) -> None:
        """Adapt header, runs and lesson."""
        self._place_header()
        self._arrange_again()  # the last arrangement may have been for another size
        snapshot = self._snapshot
        if snapshot is not None and (snapshot.beside is not None or snapshot.lesson is not None):
            self.show(snapshot)

    def show_layer(self, layer: str) -> None:
        """Show ``layer`` in all worlds and tables."""
        self.wanted_layer = Layer(layer)
        self.apply_switches()

    def apply_switches(self) -> None:
        """Apply legends, cells and layer to every panel."""
        legends = self.legends
        if self._pair.is_shown and self._snapshot is not None:
            self._pair.mark(as_learned(self._snapshot), self.wanted_layer)
        for panel in self._panels.values():
            was_explained, panel.is_explained = panel.is_explained, legends.is_on
            if isinstance(panel, WorldView | QTable):
                panel.wanted_layer = self.wanted_layer
            if isinstance(panel, WorldView):
                panel.is_numbered, panel.shows_actions = legends.numbers_states, legends.shows_actions
            if isinstance(panel, WorldView | QTable) or panel.is_explained != was_explained:
                panel.redraw()

    def _shown(self) -> Iterator[BoardPanel]:
        shape, opened, pair = self._arrangement.shape, self.opened, self._pair
        for row in self.rows.values():
            if row.of_program if not shape.is_program else row.id == rows.CONTROLS:
                continue
            if (row.of_lesson and not shape.has_lesson) or (row.of_drawing and not shape.is_drawn):
                continue
            if row.opened_by is None or row.id == opened:
                yield self._panels[row.id]
                if pair.is_shown and row.id in pair.twins:
                    yield pair.twins[row.id]

    def on_descendant_focus(self, event: events.DescendantFocus) -> None:
        """Show the timeline's keys on the curve."""
        self.curve.hints = HINTS if event.widget is self.timeline else ()
        if not isinstance(event.widget, Slider):
            self._focused_beside_sliders = event.widget
        self._pair.follow_focus()

    def leave_slider(self) -> None:
        """Return the focus from the sliders."""
        before = self._focused_beside_sliders
        self.screen.set_focus(before if before in self.screen.focus_chain else None)

    def on_descendant_blur(self) -> None:
        """Remove the keys of the timeline."""
        self.curve.hints = ()

    def on_pointed(self, event: Pointed) -> None:
        """Show the cursor in all other panels."""
        self._pair.align(event.panel)
        cursor = event.panel.cursor_pair if isinstance(event.panel, QTable) else None
        cursor = event.panel.cursor if isinstance(event.panel, WorldView) else cursor
        if event.pairs or cursor is None:  # a panel without focus still points
            self.discount.point_at(event.pairs)
            self.model.point_at(event.pairs)
        self._point_at(event.pairs, event.panel)

    def _point_at(self, pairs: range, by: Widget | None = None) -> None:
        source = by.snapshot if isinstance(by, QTable | WorldView) else self._snapshot
        if source is None:
            return
        about = self._about = self._subject_in(source)
        for panel in self._panels.values():
            if isinstance(panel, QTable | WorldView):
                world = (panel.snapshot or source).world
                panel.subject = pairs_in(about, source.world, world)
                if panel is not by:
                    panel.point_at(pairs_in(pairs, source.world, world) or panel.subject)

    def _subject_in(self, snapshot: Snapshot) -> range:
        return NOWHERE if self.opened is None else self._panels[self.opened].subject_in(snapshot)

    def on_moved(self, event: Moved) -> None:
        """Scroll the other run's panel to the same part."""
        event.stop()
        self._pair.align(event.panel)

    @property
    def viewport(self) -> Viewport:
        """The visible parts of a large world."""
        pair = self.model.pair if self.opened == rows.MODEL else None
        return Viewport(self.world.cells if self.world else None, self.table.row_range, pair)

    @property
    def is_complete(self) -> bool:
        """True if the snapshot has everything in view."""
        return all(panel.is_complete for panel in self._shown() if self.shows(panel.id or ""))

    @property
    def shown(self) -> frozenset[str] | None:
        """The panels in view, None for all."""
        return self._arrangement.shape.shown

    @property
    def zoomed(self) -> str | None:
        """The panel in full screen."""
        return self._arrangement.zoomed

    def zoom(self, panel: str | None) -> None:
        """Show ``panel`` in full screen, or all for None."""
        self._arrangement.zoomed = panel
        self._place_header()
        self._arrange_again()
        self._keep_focus_in_view()
        self.post_message(self.Toggled())

    def _place_header(self) -> None:
        has_header = self._arrangement.has_header(self.screen.size)
        self.caption.replaces_header = self.lesson.panel.replaces_header = not has_header
        self.screen.query_one(StatusLine).styles.height = int(has_header)

    def _keep_focus_in_view(self) -> None:
        screen = self.screen
        focused, regions = screen.focused, self._arrangement.regions(screen.size, self.zoomed)
        panel = self.panel_of(focused)
        row = None if focused is None else self._pair.row_of(panel)
        if row is None or panel in regions:
            return
        for each in (self._pair.led(row), self._pair.led(rows.WORLD)):
            if each in regions:
                self.panel(each).focus()
                return

    @property
    def opened(self) -> str | None:
        """The panel opened by its key."""
        return self._arrangement.opened

    def why_not(self, deed: str) -> str:
        """Return why the opened panel has nothing to show."""
        panel, snapshot = deed.removeprefix("toggle('").removesuffix("')"), self._snapshot
        return "" if snapshot is None or self.opened == panel else self.rows[panel].lacks(snapshot)

    def toggle(self, panel: str) -> None:
        """Open and focus ``panel``, or close it."""
        was_open = self.opened
        self.close()
        if was_open == panel:
            return
        self.lesson.reads = False
        self._focused_before = self.screen.focused
        self._open(panel)
        is_seen = self.panel_of(self._focused_before) in self._arrangement.regions(self.screen.size, None)
        if not (self.keeps_focus and is_seen and isinstance(self._focused_before, WorldView | None)):
            self._panels[panel].focus()

    def close(self) -> None:
        """Close the open panel, and return its focus."""
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
        self.model.show_pair(self.table.cursor_pair)
        self.zoom(None)

    def bring_into_view(self, panel: str) -> None:
        """Show ``panel``, without full screen."""
        panel = self._pair.led(panel)
        self.lesson.reads = False
        if self.zoomed not in (None, panel):
            self.zoom(None)
        if panel not in self._arrangement.regions(self.screen.size, None):
            self.close()

    def shows(self, panel: str) -> bool:
        """Return whether ``panel`` has a place."""
        return panel in self._arrangement.placed

    def panel_of(self, widget: Widget | None) -> str:
        """Return the panel around ``widget``, else the world."""
        for node in widget.ancestors_with_self if widget else ():
            if node.parent is self and node.id:
                return node.id
        return self._pair.led(rows.WORLD)

    @property
    def layout(self) -> Layout:
        """The arrangement, instead of CSS."""
        return self._arrangement

    def _dress(self) -> None:
        regions = self._arrangement.regions(self.screen.size, self.zoomed)
        self.caption.is_in_view = rows.CAPTION in regions
        for panel, region in regions.items():
            if panel in self._panels:
                least = _LEAST_WITH_HEADING.get(panel, 3)
                self._panels[panel].set_class(region.height < least, "-bare")
                self._panels[panel].set_class(region.height < _LEAST_WITH_KEYS, "-low")

    def _arrange_again(self) -> None:
        self._dress()
        # a container forgets its arrangement only if a child refreshes
        self.table.refresh(layout=True)

    async def _replace_placeholder(self, view: WorldView) -> None:
        async with self._mounting:
            if not self.is_attached:
                return
            with self.app.batch_update():
                await self.query_one(f"#{rows.WORLD}").remove()
                await self.mount(view, before=0)
