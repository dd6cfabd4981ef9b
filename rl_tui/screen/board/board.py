"""The board: the panels of the playground and their arrangement."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, Final, TypeVar

import numpy as np
from textual import events
from textual.app import ComposeResult
from textual.containers import Container
from textual.geometry import Size
from textual.layout import Layout
from textual.message import Message
from textual.widget import Widget

from rl_tui.lessons.file.view import LessonView
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.live.viewport import Viewport
from rl_tui.screen.board.board_layout import BoardLayout
from rl_tui.screen.board.lane_pair import LanePair
from rl_tui.screen.board.wanted import Wanted
from rl_tui.screen.frame.legend_switch import LegendSwitch
from rl_tui.screen.frame.shape import Shape, docks_lesson
from rl_tui.screen.kit.counterparts import pairs_in
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.kit.panel import BoardPanel
from rl_tui.screen.kit.pointing import Moved, Pointed
from rl_tui.screen.kit.row import (
    CAPTION,
    CONTROLS,
    CURVE,
    DISCOUNT,
    DRAW,
    LAST_STEP,
    LESSON,
    MICROSCOPE,
    POLICIES,
    TABLE,
    TIMELINE,
    WORLD,
    PanelRow,
    beside,
)
from rl_tui.screen.kit.snapshot_facts import as_learned, is_secret
from rl_tui.screen.panels.caption import CaptionLine
from rl_tui.screen.panels.controls.controls import Controls
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.screen.panels.curve.curve import ReturnCurve
from rl_tui.screen.panels.discount import DiscountPanel
from rl_tui.screen.panels.draw_panel import DrawPanel
from rl_tui.screen.panels.lesson.lesson import LessonPanel, Spotlight
from rl_tui.screen.panels.lesson.words import open_page
from rl_tui.screen.panels.microscope.microscope import Microscope, lit_sources
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.screen.panels.status_line import StatusLine
from rl_tui.screen.panels.timeline import HINTS, TimelineBar
from rl_tui.screen.panels.world.view import WorldView
from rl_tui.screen.panels.world_views import make_world_view
from rl_tui.screen.theme.look import Look


class LessonPlace:
    """The lesson ``panel`` on the ``board``, next to the world or in turn with it."""

    def __init__(self, board: Board, panel: LessonPanel, arrangement: BoardLayout) -> None:
        self.panel = panel
        self._board = board
        self._arrangement = arrangement
        self._focused_before: Widget | None = None
        self._spotlit: str | None = None

    @property
    def is_docked(self) -> bool:
        """True if the page is next to the world."""
        size, layout = self._board.screen.size, self._arrangement
        return not layout.is_big and docks_lesson(size, layout.in_view(size))

    @property
    def is_in_view(self) -> bool:
        """True if the whole page is in view, not only its row."""
        return self._arrangement.has_page(self._board.screen.size)

    @property
    def reads(self) -> bool:
        """True if the page takes the place of the world when both do not fit."""
        return self._arrangement.shape.reads and not self._arrangement.is_big

    @reads.setter
    def reads(self, reads: bool) -> None:
        if reads == self.reads:
            return
        if self._arrangement.is_big:
            self._board.zoom(None)
        self._board.reshape(reads=reads)
        self._board.post_message(self._board.Toggled())
        if not self.is_docked:
            (self.focus if reads else self.leave)()

    def focus(self) -> None:
        """Focus the page."""
        if self._board.screen.focused is not self.panel:
            self._focused_before = self._board.screen.focused
            self.panel.focus()

    def leave(self) -> None:
        """Return the focus to the widget that had it before."""
        if self._board.screen.focused is self.panel:
            before, self._focused_before = self._focused_before, None
            self._board.screen.set_focus(before if before is not None and before.is_attached else None)

    def place(self, lesson: LessonView, size: Size) -> None:
        """Tell the panels how page and world share the board, before a page is drawn."""
        self.panel.set_class(self._arrangement.has_lesson_in_a_row(size), "-row")
        self.panel.takes_turns = self.reads and not self.is_docked
        if self.panel.takes_turns:
            self.focus()
        self._point_at(open_page(lesson.record).spotlight, size)

    def _point_at(self, wanted: str | None, size: Size) -> None:
        row = None if wanted is None else self._board.rows.get(wanted)
        spotlit = None if row is None else row.id
        for panel, is_spotlit in ((self._spotlit, False), (spotlit, True)):
            if panel is not None and spotlit != self._spotlit:
                widget = self._board.panel(panel)
                widget.is_spotlit = is_spotlit
                widget.set_class(is_spotlit, "-spotlit")
                widget.redraw()
        self._spotlit = spotlit
        self.panel.spotlight = None
        if row is not None:
            key = "" if row.opened_by is None else row.opened_by.key
            if self.reads and self._arrangement.has_place(row.id, size):
                key = "esc"
            is_seen = row.id in self._arrangement.regions(size, self._arrangement.zoomed)
            self.panel.spotlight = Spotlight(row.title, is_seen, key)


# The board


Kind = TypeVar("Kind", bound=BoardPanel)
_LEAST_WITH_HEADING: Final = {LAST_STEP: 5}  # rows
_LEAST_WITH_KEYS: Final = 7


class Board(Container):
    """One widget per row of ``panels``, with the same id.

    One panel may be in full screen, and one with its own key may be open. If two runs are side by side, a
    twofold row has a second widget at the right. ``world`` and ``table`` show the controlled run. With
    ``keeps_focus`` an opened panel does not take the focus from the world.
    """

    class Toggled(Message):
        """A panel was opened, closed, or its full screen began or ended."""

    def __init__(
        self, look: Look, wanted: Wanted, legends: LegendSwitch, shape: Shape, panels: Sequence[PanelRow]
    ) -> None:
        super().__init__(id="board")
        self.look = look
        self.legends, self.rows = legends, {row.id: row for row in panels}
        self._panels = {row.id: row.make(look) for row in panels}
        self._pair = LanePair(self._panels, look)
        self.table = self._made(TABLE, QTable)
        """The table of the controlled run."""
        self.world: WorldView | None = None
        """The world of the controlled run, None before the first snapshot."""
        self.is_one_lane = self.keeps_focus = False
        self.wanted_layer = Layer.Q  # of worlds and tables
        self.curve = self._made(CURVE, ReturnCurve)
        self.curve.begin_with(wanted.recipe)
        self.timeline = self._made(TIMELINE, TimelineBar)
        self.caption = self._made(CAPTION, CaptionLine)
        self.controls = self._made(CONTROLS, Controls)
        self.controls.begin_with(wanted.recipe)
        self.microscope = self._made(MICROSCOPE, Microscope)
        self.discount = self._made(DISCOUNT, DiscountPanel)
        self.tools = self._made(DRAW, DrawPanel)
        self._wanted = wanted
        self._focused_before: Widget | None = None
        self._focused_beside_sliders: Widget | None = None
        self._arrangement = BoardLayout(shape, panels)
        self.lesson = LessonPlace(self, self._made(LESSON, LessonPanel), self._arrangement)
        self._snapshot: Snapshot | None = None
        self._mounting = asyncio.Lock()
        self.apply_switches()

    def _made(self, panel: str, kind: type[Kind]) -> Kind:
        made = self._panels[panel]
        assert isinstance(made, kind)
        return made

    def compose(self) -> ComposeResult:
        """Yield the panels in the order of the tab key."""
        yield from self._panels.values()

    def panel(self, panel: str) -> BoardPanel:
        """Return the widget with the id ``panel``."""
        return self._panels[panel]

    def show(self, snapshot: Snapshot) -> None:
        """Draw ``snapshot``, with settings at their wanted values."""
        self._snapshot = snapshot
        if self.world is None:
            view = make_world_view(snapshot.world, self.look, id=WORLD, classes="panel")
            self._panels[WORLD] = self.world = view
            view.caption = self.rows[WORLD].caption
            self.apply_switches()
            self.run_worker(self._replace_placeholder(view))
        if snapshot.beside is not None and not self._pair.twins:
            self._pair.make(snapshot, self.rows.values())
            self._panels |= {beside(row): twin for row, twin in self._pair.twins.items()}
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
        self.table.sources = lit_sources(snapshot) if self.opened == MICROSCOPE else frozenset()
        self.controls.wanted = self._wanted.recipe.hyperparameters
        self.controls.marks_all_flips = self.opened == DISCOUNT
        self.timeline.sought = self._wanted.step
        learned, pair = as_learned(snapshot), self._pair.panels if self._pair.is_shown else []
        for panel in self._shown():
            if isinstance(panel, WorldView):
                panel.names_policies_key = self.opened != POLICIES
                panel.replaces_header = self._arrangement.is_big
            if panel not in pair:
                panel.show(learned if isinstance(panel, WorldView | QTable) else snapshot)
        if pair:
            self._pair.show(learned)

    def reshape(self, **changes: Any) -> None:
        """Arrange the panels again if one of ``changes`` to the shape is new."""
        shape = replace(self._arrangement.shape, **changes)
        if shape != self._arrangement.shape:
            self._arrangement.shape = shape
            self._arrange_again()

    def _take_lead(self, snapshot: Snapshot) -> None:
        world = self.world
        is_pair = snapshot.beside is not None and self._arrangement.is_pair(self.screen.size)
        if not self._pair.take_lead(snapshot, is_shown=is_pair):
            return
        self.table = self._made(self._pair.led(TABLE), QTable)
        self.world = self._made(self._pair.led(WORLD), WorldView)
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
        """Switch between one run and two side by side, if they fit."""
        self.is_one_lane = self.is_paired
        if self._snapshot is not None:
            self.show(self._snapshot)

    @property
    def is_paired(self) -> bool:
        """True if two runs are side by side."""
        return self._pair.is_shown

    def on_resize(self) -> None:
        """Adapt runs and lesson to the new size."""
        self._arrange_again()  # the last arrangement may have been for another size
        snapshot = self._snapshot
        if snapshot is not None and (snapshot.beside is not None or snapshot.lesson is not None):
            self.show(snapshot)

    def show_layer(self, layer: Layer) -> None:
        """Show ``layer`` in all worlds and tables."""
        self.wanted_layer = layer
        for panel in self._panels.values():
            if isinstance(panel, WorldView | QTable):
                panel.wanted_layer = layer
                panel.redraw()

    def on_qtable_layer_chosen(self, event: QTable.LayerChosen) -> None:
        """Show the layer whose name was clicked."""
        self.show_layer(event.layer)

    def apply_switches(self) -> None:
        """Apply the switches of legends and cells to every panel, including twins."""
        legends = self.legends
        for panel in self._panels.values():
            panel.is_explained = legends.is_on
            if isinstance(panel, WorldView | QTable):
                panel.wanted_layer = self.wanted_layer
            if isinstance(panel, WorldView):
                panel.is_numbered, panel.shows_actions = legends.numbers_states, legends.shows_actions
            panel.redraw()

    def _shown(self) -> Iterator[BoardPanel]:
        shape, opened, pair = self._arrangement.shape, self.opened, self._pair
        for row in self.rows.values():
            if row.of_program if not shape.is_program else row.id == CONTROLS:
                continue
            if (row.of_lesson and not shape.has_lesson) or (row.of_drawing and not shape.is_drawn):
                continue
            if row.opened_by is None or row.id == opened:
                yield self._panels[row.id]
                if pair.is_shown and row.id in pair.twins:
                    yield pair.twins[row.id]

    def on_descendant_focus(self, event: events.DescendantFocus) -> None:
        """Show the keys of the timeline on the curve above it."""
        self.curve.hints = HINTS if event.widget is self.timeline else ()
        if not isinstance(event.widget, Slider):
            self._focused_beside_sliders = event.widget
        self._pair.follow_focus()

    def leave_slider(self) -> None:
        """Return the focus to the panel that had it before the sliders."""
        before = self._focused_beside_sliders
        self.screen.set_focus(before if before in self.screen.focus_chain else None)

    def on_descendant_blur(self) -> None:
        """Remove the keys of the timeline."""
        self.curve.hints = ()

    def on_pointed(self, event: Pointed) -> None:
        """Show the cursor of a world or table in all others."""
        self._pair.align(event.panel)
        source = event.panel.snapshot if isinstance(event.panel, QTable | WorldView) else None
        for panel in self._panels.values():
            if isinstance(panel, QTable | WorldView) and panel is not event.panel:
                if source is None or panel.snapshot is None:
                    panel.point_at(event.pairs)
                else:
                    panel.point_at(pairs_in(event.pairs, source.world, panel.snapshot.world))
        cursor = event.panel.cursor_pair if isinstance(event.panel, QTable) else None
        cursor = event.panel.cursor if isinstance(event.panel, WorldView) else cursor
        if event.pairs or cursor is None:  # a panel without focus still points
            self.discount.point_at(event.pairs)

    def on_moved(self, event: Moved) -> None:
        """Scroll the panel of the other run to the same part."""
        event.stop()
        self._pair.align(event.panel)

    @property
    def viewport(self) -> Viewport:
        """The parts of a large world that are in view."""
        return Viewport(self.world.cells if self.world else None, self.table.row_range)

    @property
    def is_complete(self) -> bool:
        """True if the newest snapshot has everything in view."""
        return all(panel.is_complete for panel in self._shown() if self.shows(panel.id or ""))

    @property
    def shown(self) -> frozenset[str] | None:
        """The ids of the panels in view, None for all."""
        return self._arrangement.shape.shown

    @property
    def zoomed(self) -> str | None:
        """The id of the panel in full screen, or None."""
        return self._arrangement.zoomed

    def zoom(self, panel: str | None) -> None:
        """Show ``panel`` in full screen, or all panels for None."""
        self._arrangement.zoomed = panel
        self.caption.replaces_header = self.lesson.panel.replaces_header = self._arrangement.is_big
        self.screen.query_one(StatusLine).styles.height = 0 if self._arrangement.is_big else 1
        self._arrange_again()
        self._keep_focus_in_view()
        self.post_message(self.Toggled())

    def _keep_focus_in_view(self) -> None:
        """Move the focus to the controlled run if its panel is out of view."""
        screen = self.screen
        focused, regions = screen.focused, self._arrangement.regions(screen.size, self.zoomed)
        panel = self.panel_of(focused)
        row = None if focused is None else self._pair.row_of(panel)
        if row is None or panel in regions:
            return
        for each in (self._pair.led(row), self._pair.led(WORLD)):
            if each in regions:
                self.panel(each).focus()
                return

    @property
    def opened(self) -> str | None:
        """The id of the panel opened by its key, or None."""
        return self._arrangement.opened

    def why_not(self, deed: str) -> str:
        """Return why the panel that ``deed`` opens has nothing to show, or ""."""
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
        """Close the open panel, and return the focus if it had it."""
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

    def bring_into_view(self, panel: str) -> None:
        """Show ``panel`` of the controlled run, without full screen."""
        panel = self._pair.led(panel)
        self.lesson.reads = False
        if self.zoomed not in (None, panel):
            self.zoom(None)
        if panel not in self._arrangement.regions(self.screen.size, None):
            self.close()

    def shows(self, panel: str) -> bool:
        """Return True if ``panel`` has a place on the screen."""
        return panel in self._arrangement.placed

    def panel_of(self, widget: Widget | None) -> str:
        """Return the id of the panel around ``widget``, by default the controlled world."""
        for node in widget.ancestors_with_self if widget else ():
            if node.parent is self and node.id:
                return node.id
        return self._pair.led(WORLD)

    @property
    def layout(self) -> Layout:
        """The arrangement, in place of one from CSS."""
        return self._arrangement

    def _dress(self) -> None:
        regions = self._arrangement.regions(self.screen.size, self.zoomed)
        self.caption.is_in_view = CAPTION in regions
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
                await self.query_one(f"#{WORLD}").remove()
                await self.mount(view, before=0)
