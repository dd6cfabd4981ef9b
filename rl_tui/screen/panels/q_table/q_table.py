"""The Q-table as a heat map."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import ClassVar, Final

from rich.segment import Segment
from textual import events
from textual.binding import BindingType
from textual.cache import LRUCache
from textual.geometry import Size
from textual.message import Message
from textual.strip import Strip

from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.live.viewport import RowRange
from rl_tui.runs.large_worlds import is_large
from rl_tui.screen.draw.canvas import Piece, strips_of
from rl_tui.screen.draw.number_form import SteadyForms
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.counterparts import are_alike, pair_in, pairs_in
from rl_tui.screen.kit.layers import EXACT_LAYERS, Layer, shown_exact, veils_exact
from rl_tui.screen.kit.panel import (
    GREEDY_IN_FULL,
    BoardPanel,
    Legend,
    LegendSign,
    Panel,
    agent_meaning,
    no_value_sign,
)
from rl_tui.screen.kit.pointing import NOWHERE, Moved, Pointed
from rl_tui.screen.kit.scrolling import Scrolled
from rl_tui.screen.kit.snapshot_facts import has_estimates, is_new_run
from rl_tui.screen.kit.value_scale import SteadyScale
from rl_tui.screen.panels.grid.landscape import has_landscape
from rl_tui.screen.panels.policies.studied import as_studied
from rl_tui.screen.panels.q_table import sheet as sheets
from rl_tui.screen.panels.q_table.forms import list_form, matrix_form
from rl_tui.screen.panels.q_table.layers import (
    LEARNED_NOT,
    Figures,
    exact_of,
    lacks_values,
    layer_choices,
    lit_pair,
)
from rl_tui.screen.panels.q_table.world import NO_ROW, Scene, TableWorld, state_followed
from rl_tui.screen.panels.world.edit_marks import mark_signs
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.world import World

WAITING: Final = "the estimates Q(s, a) come with the first step"
_MOST_CACHED: Final = 512  # rows


class QTable(Panel, can_focus=True):
    """The table of Q: a row per state, or a row per pair.

    It follows the agent until cursor or view are moved. ``lights`` highlights the updated cell and its
    ``sources``. ``lane``: number of one of two runs. ``differing``: states to mark.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        binding("up", "move(-1, 0)", "table.up", "Move the cursor up"),
        binding("down", "move(1, 0)", "table.down", "Move the cursor down"),
        binding("left", "move(0, -1)", "table.left", "Move the cursor left"),
        binding("right", "move(0, 1)", "table.right", "Move the cursor right"),
        binding("pageup", "page(-1)", "table.page_up", "A page up"),
        binding("pagedown", "page(1)", "table.page_down", "A page down"),
        binding("home", "end(False)", "table.first", "Go to the first row"),
        binding("end", "end(True)", "table.last", "Go to the last row"),
        binding("escape,full_stop", "follow", "table.follow", "Follow the agent again"),
    ]

    @dataclass
    class CursorMoved(Message):
        """The user moved the cursor. None follows the agent."""

        pair: int | None

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(look, id=id, classes=classes)
        self.lights = True
        self.sources: frozenset[int] = frozenset()
        self.lane = ""
        self.differing: frozenset[int] = frozenset()
        # set by the user, None while the table follows the agent
        self.cursor_pair: int | None = None
        self.heading = "Q"
        self.wanted_layer = Layer.Q
        """The layer to show if available, also in the world."""
        self.cell: Size | None = None  # size of a map cell, set by the board
        self._choices = layer_choices(None)
        self._following = True
        self.pointed = self.subject = NOWHERE
        self._first = 0
        self._height = 0  # of the last picture
        self._world: TableWorld | None = None
        self._sheet: sheets.Sheet | None = None
        self._rare: Legend = ()
        self._cache = LRUCache[tuple[Segment, ...], Strip](_MOST_CACHED)
        self._requested: RowRange | None = None
        self._forms = SteadyForms()
        self._scale = SteadyScale()

    @property
    def layer_choices(self) -> tuple[Layer, ...]:
        """The available layers, with those of the world."""
        shown = self.snapshot
        if shown is None or not has_estimates(shown) or not has_landscape(shown.world, self.cell, self.look):
            return self._choices
        return *self._choices, Layer.LANDSCAPE

    @property
    def shown_layer(self) -> Layer:
        """The numbers' layer, Q for a landscape."""
        return self.wanted_layer if self.wanted_layer in self._choices else Layer.Q

    def rows_of(self, snapshot: Snapshot) -> int:
        """Count the rows of the whole table."""
        world = self._world_of(snapshot)
        return world.space.pairs + 2 if world.is_sparse else len(world.live)

    @property
    def row_range(self) -> RowRange | None:
        """The visible pairs."""
        sheet = self._sheet
        if sheet is None or self.snapshot is None:
            return None
        most = sheet.shown * len(self.snapshot.world.space.action_names)
        return RowRange(most, sheet.pairs.start if self.pointed or not self._following else None)

    @property
    def is_complete(self) -> bool:
        """True if the snapshot contains all visible pairs."""
        window = None if self.snapshot is None else self.snapshot.agent.part
        if window is None or self._sheet is None:
            return True
        pairs = self._sheet.pairs
        return bool(window.held[pairs.start : pairs.stop].all())

    def redraw(self) -> None:
        """Draw again, and report another visible part."""
        super().redraw()
        if self.snapshot is None or not self.is_attached or not is_large(self.snapshot.world):
            return
        row_range = self.row_range
        if row_range != self._requested:
            self._requested = row_range
            self.post_message(Scrolled())

    def show(self, snapshot: Snapshot) -> None:
        """Draw ``snapshot``. Another world starts at the top."""
        if self.snapshot is not None and self.snapshot.world.space is not snapshot.world.space:
            self.cursor_pair, self._following, self._first = None, True, 0
            pointed = pairs_in(self.pointed, self.snapshot.world, snapshot.world)
            self.pointed = NOWHERE if is_new_run(self.snapshot, snapshot) else pointed
        if self._following and self.snapshot is not None and self.snapshot.playback.phase is Phase.PREPARING:
            self._first = 0  # no step to follow while the run was prepared
        if is_new_run(self.snapshot, snapshot):
            self._forms.clear()
            self._scale.clear()
        self._choices = layer_choices(snapshot)
        super().show(snapshot)

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Draw the visible rows, or a text."""
        self._sheet = None
        if snapshot is None:
            return strips_of([[Piece(f" {WAITING}", self.look.palette.dim)]], width, height, self.look)
        layer = self.shown_layer
        if layer in EXACT_LAYERS and shown_exact(snapshot) is None:
            self.heading = sheets.TITLES[layer]
            self.footing = self._footing(width)
            return strips_of(sheets.no_answer(snapshot, width, self.look), width, height, self.look)
        form, scene = self._form(snapshot, width, height)
        if self._following and height != self._height and not self.is_led:
            self._first = 0  # discard the scroll position of an unfinished layout
        self._height = height
        self._sheet = sheet = sheets.Sheet(form, scene, width, height)
        if self.pointed:
            sheet.scroll_to(self._first, self.pointed.start)
        else:
            follows = self._following and not self.is_led
            sheet.scroll(self._first, state_followed(snapshot) if follows else None)
            if follows and self.sources and snapshot.counters.last_step is not None:
                sheet.reach(snapshot.counters.last_step.updated_pair, state_followed(snapshot))
        self._first = sheet.first
        self.free_rows = sheet.free_rows
        self.heading = self.fitting(sheets.headings(snapshot, layer, self, self.lane), width)
        self.footing = self._footing(width, sheet.part if sheet.is_scrolled and not self.pointed else "")
        strips = sheet.strips(self._cache)
        self._rare = sheets.rare_signs(strips, self.look)
        return strips

    def legend(self, snapshot: Snapshot) -> Legend:
        """Return the signs of cells."""
        palette, glyphs = self.look.palette, self.look.glyphs
        frame, state = glyphs.mark_left + glyphs.mark_right, snapshot.world.space.states > 1
        layer, has_choice = self.shown_layer, len(snapshot.world.space.action_names) > 1
        is_learned = layer not in LEARNED_NOT
        greedy = GREEDY_IN_FULL if is_learned else ""  # in Q*, greedy is optimal
        lit = lit_pair(snapshot)
        updated = palette.good if lit is None else palette.error(lit.error)
        framed = "likeliest" if layer is Layer.POLICY else "greedy"
        if layer is Layer.Q and not has_estimates(snapshot):
            return ()
        return (
            *mark_signs(snapshot.editor, self.look),
            *([LegendSign(frame, framed, palette.best, greedy)] if has_choice else []),
            *([no_value_sign(self.look)] if lacks_values(snapshot, layer) else []),
            *([LegendSign(glyphs.lit, "just updated", updated)] if is_learned and self.lights else []),
            LegendSign(glyphs.agent, agent_meaning(snapshot) if state else "last pull", palette.agent),
            *self._rare,
            *([LegendSign(glyphs.untried, "not tried", palette.unvisited)] if is_learned else []),
            *([LegendSign(glyphs.cursor, "cursor", palette.you)] if self.has_focus else []),
        )

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Leave escape to the screen while following."""
        return not self._following if action == "follow" else True

    def action_move(self, rows: int, columns: int) -> None:
        """Move the cursor."""
        pair = self.shown_cursor
        if self._sheet is not None and pair is not None:
            self._put_cursor(self._sheet.form.moved(pair, rows, columns))

    def action_page(self, pages: int) -> None:
        """Move by pages."""
        if self._sheet is not None:
            self.action_move(pages * self._sheet.page, 0)

    def action_end(self, last: bool) -> None:
        """Go to the first or last row."""
        if self._sheet is not None:
            self.action_move(self._sheet.form.entries * (1 if last else -1), 0)

    def action_follow(self) -> None:
        """Follow the agent again."""
        self.cursor_pair, self._following = None, True
        self._show_moved()

    def foot_pieces(self, foot: str, look: Look) -> tuple[Segment, ...]:
        """Style signs, keys and the layer."""
        signs = () if self.snapshot is None else self.legend(self.snapshot)
        return sheets.footing_pieces(foot, self._named_layer, self.layer_choices, signs, look)

    @property
    def _named_layer(self) -> Layer:
        return self.wanted_layer if self.wanted_layer in self.layer_choices else Layer.Q

    def on_click(self, event: events.Click) -> None:
        """Move the cursor, or choose a layer."""
        if (column := self.footing_column(event)) is not None:
            layer = sheets.layer_at(self.footing, column, self.layer_choices, self.look.glyphs)
            if layer is not None:
                event.prevent_default()
                self.call_later(self.run_action, f"screen.do('board.show_layer(\"{layer}\")')")
            elif column == sheets.key_column(self.footing):
                self.app.simulate_key("v")
        offset = event.get_content_offset(self)
        pair = None if offset is None else self.pair_at(*offset)
        if pair is not None:
            self._put_cursor(pair)

    def pair_at(self, x: int, y: int) -> int | None:
        """Return the pair here, or None."""
        return None if self._sheet is None else self._sheet.pair_at(x, y)

    def turn_wheel(self, rows: int, event: events.MouseEvent) -> None:
        """Scroll, and stop following the agent."""
        if self._sheet is not None and self._sheet.is_scrolled:
            event.stop()
            self._following = False
            self._first += rows
            self.redraw()
            self.post_message(Moved(self))

    def on_resize(self) -> None:
        """Align the other run's table."""
        if not self.is_led:
            self.post_message(Moved(self))

    def watch_has_focus(self, has_focus: bool) -> None:
        """Show or hide the cursor."""
        super().watch_has_focus(has_focus)
        self._tell()

    def point_at(self, pairs: range) -> None:
        """Show another panel's cursor."""
        if pairs != self.pointed:
            self.pointed = pairs
            self.redraw()

    @property
    def stance(self) -> object:
        """Cursor and visible rows."""
        return self.cursor_pair, self._following, self._first

    def align_with(self, twin: BoardPanel) -> None:
        """Take the stance of ``twin``."""
        if isinstance(twin, QTable):
            self._forms, self._scale = twin._forms, twin._scale
            if self.snapshot and twin.snapshot and not are_alike(twin.snapshot.world, self.snapshot.world):
                self._translate(twin, twin.snapshot.world, self.snapshot.world)
                return
            self.cursor_pair, self._following, self._first = twin.cursor_pair, twin._following, twin._first

    def _translate(self, twin: QTable, theirs: World, own: World) -> None:
        cursor = None if twin.cursor_pair is None else pair_in(twin.cursor_pair, theirs, own)
        if cursor is not None or self.is_led:
            self.cursor_pair = cursor
        if self.is_led and self._sheet is not None and twin._sheet is not None:
            self._following, first = twin._following, pair_in(twin._sheet.pairs.start, theirs, own)
            self._first = twin._first if first is None else self._sheet.form.entry_of_pair(first)

    def _tell(self) -> None:
        if self.is_attached:
            pair = self.cursor_pair if self.has_focus else None
            self.post_message(Pointed(self, NOWHERE if pair is None else range(pair, pair + 1)))

    def _put_cursor(self, pair: int) -> None:
        self.cursor_pair, self._following = pair, False
        if self._sheet is not None:
            self._sheet.scroll_to(self._first, pair)
            self._first = self._sheet.first
        self._show_moved()

    def _show_moved(self) -> None:
        self.redraw()
        self.post_message(self.CursorMoved(self.cursor_pair))
        self._tell()

    @property
    def shown_cursor(self) -> int | None:
        """The cursor's pair, by default the agent's."""
        if self.cursor_pair is not None or self.snapshot is None:
            return self.cursor_pair
        world = self._world_of(self.snapshot)
        state = state_followed(self.snapshot) if self._following else int(world.live[0])
        if world.row_of(state) == NO_ROW:
            state = int(world.live[0])
        return world.pairs_shown(state)[0]

    def _world_of(self, snapshot: Snapshot) -> TableWorld:
        known, glyphs = self._world, self.look.glyphs
        if known is None or known.world is not snapshot.world or known.glyphs is not glyphs:
            known = self._world = TableWorld(snapshot.world, glyphs)
        return known

    def _form(self, snapshot: Snapshot, width: int, height: int) -> tuple[sheets.Form, Scene]:
        if not self._world_of(snapshot).is_sparse:
            scene = self._scene(snapshot, (self.shown_layer,))
            matrix = matrix_form(scene, width, height - 1)
            if matrix is not None:
                return matrix, scene
        scene = self._scene(snapshot, self._choices)
        is_scrolled = scene.world.space.pairs > height - 1
        return list_form(scene, width - 1 if is_scrolled else width), scene

    def _scene(self, snapshot: Snapshot, layers: Iterable[Layer]) -> Scene:
        exact = {layer: exact_of(snapshot, layer) for layer in layers}
        lit = lit_pair(snapshot) if self.lights else None
        shown = self.shown_layer
        if shown in (Layer.Q, Layer.POLICY):
            scale = self._scale.of(as_studied(snapshot))
        else:
            scale = self._scale.of(snapshot, shown)
        figures = {
            layer: Figures(snapshot, layer, self.look, known, self._forms, scale, lit, self.sources)
            for layer, known in exact.items()
            if known is not None or layer not in EXACT_LAYERS
        }
        return Scene(
            world=self._world_of(snapshot),
            figures=figures,
            shown=figures[shown],
            snapshot=snapshot,
            cursor=self.shown_cursor if self.has_focus else None,
            look=self.look,
            forms=self._forms,
            pointed=self.pointed,
            differing=self.differing,
        )

    def _footing(self, width: int, part: str = "") -> str:
        is_hidden = self.snapshot is not None and veils_exact(self.snapshot)
        forms = sheets.footings(self._named_layer, self.layer_choices, hides_exact=is_hidden)
        if part:
            forms = sheets.followed(forms, part, is_following=self._following)
        return self.fitting(forms, width)
