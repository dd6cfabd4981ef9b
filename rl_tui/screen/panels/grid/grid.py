"""The map, coloured by V(s), with greedy arrows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Final

from rich.style import Style
from textual.geometry import Size
from textual.strip import Strip

from rl_tui.live.snapshot import Snapshot
from rl_tui.live.viewport import Cells
from rl_tui.runs.large_worlds import is_large
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.number_form import NumberForm
from rl_tui.screen.kit.counterparts import are_same_size
from rl_tui.screen.kit.layers import ACTION_LAYERS, Layer
from rl_tui.screen.kit.numbers_in_common import all_q, all_v, ends
from rl_tui.screen.kit.panel import BoardPanel, LegendSign
from rl_tui.screen.kit.scrolling import Scrolled, kept_in_view, scrolled_to
from rl_tui.screen.panels.bodies import surrounded
from rl_tui.screen.panels.grid.action_form import ActionForm, part_form, whole_map_form
from rl_tui.screen.panels.grid.action_values import ActionArtist, draw_grid, name_room
from rl_tui.screen.panels.grid.cells import CellArtist
from rl_tui.screen.panels.grid.form import LEAST_ARROWS, LEAST_DIGITS, CellForm, cell_form, digits_needed
from rl_tui.screen.panels.grid.landscape import LandscapeArtist, has_landscape
from rl_tui.screen.panels.grid.map import CellContent, GridMap, MapPart, carried_place, with_extra
from rl_tui.screen.panels.grid.marks import SEVERAL, lead_steps, sign_text
from rl_tui.screen.panels.grid.motion import Mover
from rl_tui.screen.panels.grid.signs import (
    action_signs,
    differing_sign,
    ground_signs,
    heading_of_actions,
    heading_of_values,
    letter_signs,
    numbered,
    place_signs,
    reward_signs,
    shorter,
    where,
    wind_line,
    wind_strip,
)
from rl_tui.screen.panels.grid.trail import Trace, subject_traces, trace_signs, traces
from rl_tui.screen.panels.margins import NO_MARGINS, LabelledPart, margins_in
from rl_tui.screen.panels.world.scale_line import NamedScale
from rl_tui.screen.panels.world.shown_policy import TITLE
from rl_tui.screen.panels.world.view import SCALE_ROOM, WorldView
from rl_tui.screen.theme.roles import paled
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.world import World

_DECIMALS: Final = 2
PALE: Final = "pale: hardly better"
_LEAST_WITH_LEGEND: Final = 8  # rows of a map that scrolls


class GridView(WorldView):
    """A grid world. Its places are the cells, row by row."""

    _part: MapPart | None = None
    _form: CellForm | None = None
    _action_form: ActionForm | None = None  # while cells show every action
    _origin = (0, 0)  # column and row of the upper left cell
    _requested: Cells | None = None
    _artist: CellArtist | None = None
    _action_artist: ActionArtist | None = None
    _landscapes: LandscapeArtist | None = None
    _is_landscape = False  # of the last picture
    _names_bins = False  # in a heading above the map
    _digits = LEAST_DIGITS
    _action_digits = LEAST_DIGITS
    _longest_name = 0  # of the visible names
    _has_several = _has_greedy = _has_pale = _has_untried = False  # of the last picture

    def enter(self, world: World, *, goes_on: bool = False) -> None:
        """Switch to ``world``, following the agent unless it ``goes_on``."""
        assert isinstance(world.drawing, Grid)
        super().enter(world, goes_on=goes_on)
        self._map = GridMap(world.space, world.drawing)
        self._kinds = frozenset(world.drawing.kinds)
        if not goes_on:
            self._top, self._left, self._following = 0, 0, True
        self.heading = TITLE

    @cached_property
    def mover(self) -> Mover:
        """The animation after a step."""
        return Mover(self)

    @property
    def cells(self) -> Cells | None:
        """The visible part, or None for all."""
        part = self._part
        if part is None or self._is_whole:
            return None
        at = () if self._following else (part.top, part.left)
        return Cells(part.rows, part.columns, *at)

    @property
    def is_complete(self) -> bool:
        """True if the snapshot contains all visible cells."""
        return not self.snapshot or not self._part or self._map.holds(self._part, self.snapshot)

    @property
    def is_away(self) -> bool:
        """True if cursor or view left the agent."""
        return not self._following or super().is_away

    def agent_place(self, snapshot: Snapshot) -> int:
        """Return the agent's cell."""
        return int(self._map.grid.cell_of_state[snapshot.counters.state])

    def moved(self, place: int, rows: int, columns: int) -> int:
        """Return the cell that far away."""
        grid = self._map.grid
        row, column = divmod(place, grid.columns)
        row, column = max(0, min(row + rows, grid.rows - 1)), max(0, min(column + columns, grid.columns - 1))
        return row * grid.columns + column

    def place_at(self, x: int, y: int) -> int | None:
        """Return the cell here, or None."""
        part, form = self._part, self._form
        if part is None or form is None:
            return None
        row, column = (y - self._origin[1]) // form.height, (x - self._origin[0]) // form.width
        if not (0 <= row < part.rows and 0 <= column < part.columns):
            return None
        return (part.top + row) * self._map.grid.columns + part.left + column

    def state_at(self, place: int) -> int | None:
        """Return a cell's state, preferably the agent's."""
        return self._map.state_at(place, self.snapshot)

    def name_at(self, place: int) -> str:
        """Name a cell's state, and whether it is never reached."""
        name = super().name_at(place)
        return f"{name}, never reached" if place in self._map.unreached else name

    def carried(self, place: int, before: Snapshot, now: Snapshot) -> int:
        """Return a cell's place after an edit."""
        found, down, right = carried_place(place, before, now)
        self._top, self._left = self._top + down, self._left + right
        return found

    def place_in(self, place: int, world: World, other: World) -> int | None:
        """Return the cell at the same place."""
        return place if are_same_size(world, other) else None

    def place_of(self, pair: int) -> int:
        """Return the cell of the pair's state."""
        return int(self._map.grid.cell_of_state[self.world.space.state_of(pair)])

    @property
    def page_size(self) -> tuple[int, int]:
        """The visible rows and columns."""
        return self._part[2:] if self._part else (1, 1)

    def keep_in_view(self, place: int) -> None:
        """Scroll until a cell is visible."""
        if self._part is not None and not self._is_whole:
            row, column = divmod(place, self._map.grid.columns)
            self._following = False
            self._top = scrolled_to(self._top, row, self._part.rows)
            self._left = scrolled_to(self._left, column, self._part.columns)

    @property
    def stance(self) -> object:
        """Cursor, visible part and width of numbers."""
        digits = self._digits, self._action_digits
        return self.cursor, self._following, self._top, self._left, digits

    def align_with(self, twin: BoardPanel) -> None:
        """Take the twin's stance, and the wider numbers."""
        super().align_with(twin)
        if isinstance(twin, GridView):
            if self.takes_stance_of(twin):
                self._following, self._top, self._left = twin._following, twin._top, twin._left
            self._digits = max(self._digits, twin._digits)
            self._action_digits = max(self._action_digits, twin._action_digits)

    def show(self, snapshot: Snapshot) -> None:
        """Draw ``snapshot``. Numbers only get wider during a run."""
        if self.begins_anew(snapshot):
            self._digits = self._action_digits = LEAST_DIGITS + self.waits_for_study(snapshot)
            self._action_artist = None
            self.number_forms.clear()
        self.mover.follow(self.snapshot, snapshot, self._map, self._form if self._moves else None)
        super().show(snapshot)

    @property
    def _is_drawn(self) -> bool:
        """True while the reader draws: frames of steps would look like the cursor."""
        return self.is_drawn_on or self.shows_drawing

    def _traces(self, snapshot: Snapshot) -> dict[int, Trace]:
        if self._is_drawn:
            return {}
        if self.subject:
            return subject_traces(self.world, self._map.grid, self.subject, self.subject_next)
        return traces(snapshot, self._map.grid)

    @property
    def _moves(self) -> bool:
        shows_v = self.studied is None and self.drawn_layer is Layer.Q
        return shows_v and self._is_whole and not (self._action_form or self.is_drawn_on)

    def drawing(self, snapshot: Snapshot, width: int, height: int) -> list[Strip]:
        """Draw map, labels and body."""
        margins = NO_MARGINS
        if self.cell and not self.shows_actions:
            margins = margins_in(self._map.grid, self.cell, width, height)
        self._origin = margins.left, margins.above
        self._names_bins = margins.names_bins
        strips = self._drawn_map(snapshot, width - margins.left, height - margins.above)
        assert self._part is not None
        assert self._form is not None
        place = LabelledPart(*self._part, self._form[:2])
        return surrounded(strips, snapshot, place, margins, width, self.look)

    def _drawn_map(self, snapshot: Snapshot, width: int, height: int) -> list[Strip]:
        grid = self._map.grid
        if not grid.wind:
            return self._drawn_cells(snapshot, width, height)
        form = self._cell_form(width, height)
        is_free = height > grid.rows * form.height or grid.rows > height >= _LEAST_WITH_LEGEND
        strips = self._drawn_cells(snapshot, width, height - is_free)
        assert self._part is not None
        assert self._form is not None
        if is_free:
            row = wind_strip(grid, self._part, self._form, width, snapshot, self.look)
            strips.insert(self._part.rows * self._form.height, row)
        elif self._following:
            line = wind_line(grid, self._part, self.look)
            # the visible part comes first: wind without it would seem to be that of all columns
            forms = (f"{line} · {self.footing}", self.footing) if self.footing else (line,)
            self.footing = self.fitting(forms, width)
        return strips

    def _drawn_cells(self, snapshot: Snapshot, width: int, height: int) -> list[Strip]:
        grid, self._is_landscape = self._map.grid, False
        form = self._cell_form(width, height)
        actions = self._action_form
        rows = min(grid.rows, max(1, height // form.height))
        columns = min(grid.columns, max(1, width // form.width))
        row, column = divmod(self._map.cell_to_follow(snapshot), grid.columns)
        follows = self._following and not self.is_led
        self._top = kept_in_view(self._top, row if follows else None, rows, grid.rows)
        self._left = kept_in_view(self._left, column if follows else None, columns, grid.columns)
        self._part = part = MapPart(self._top, self._left, rows, columns)
        cells = self._map.contents(
            part,
            snapshot,
            self.shown_cursor,
            self.differing,
            with_actions=actions is not None,
            named=self.is_numbered or (actions is None and form.has_number and not grid.legend),
            picked=self.picked,
            traced=self._traces(snapshot),
        )
        self._longest_name = max((len(each.extra.name) for each in cells if each.extra), default=0)
        if self._longest_name > self._room_for_names(form):  # names replace numbers in all cells or in none
            cells = [each if each.extra is None else with_extra(each, name="") for each in cells]
        artist = self._artist_for(form)
        values = all_v(snapshot) if actions is None else all_q(snapshot)
        needed = digits_needed(ends(values)[0])
        if needed > (self._digits if actions is None else self._action_digits):
            if actions is None:  # steady width, so that the map does not jump
                self._digits = needed
            else:
                self._action_digits = needed
            return self._drawn_cells(snapshot, width, height)
        self.heading = self._what_is_drawn(form, width)
        self.footing = self._where(width - SCALE_ROOM) or self._where(width)
        self.free_columns = width - part.columns * form.width
        self._form = form
        if self.drawn_layer is Layer.LANDSCAPE:
            landscape = self._landscape(cells, part, form, width, height)
            self._is_landscape = landscape is not None
            if landscape is not None:
                return landscape
        number_form = self._number_form(values, form if actions is None else actions)
        motion = self.mover.motion if self._moves else None
        cells = cells if motion is None else motion.contents(cells)
        leads = lead_steps(self.range_of_v)
        strips = draw_grid(cells, artist, number_form, self.tints, leads, part, width, height)
        self._has_several = any(SEVERAL in strip.text for strip in strips)
        self._has_greedy = any(each.greedy for each in cells)
        self._has_untried = any(each.value is not None and not each.known for each in cells)
        self._has_pale = any(each.lead < leads[-2] for each in cells)  # the strongest two hardly differ
        return motion.laid_over(strips, form, part.columns, number_form, self.look) if motion else strips

    @property
    def has_landscape(self) -> bool:
        """True if a landscape of V fits here."""
        return not (self.title or self.lacks_table) and has_landscape(self.world, self.cell, self.look)

    @property
    def named_scale(self) -> NamedScale | None:
        """The colour scale, with a landscape's line step."""
        named = super().named_scale
        if named is None or not self._is_landscape or self._landscapes is None:
            return named
        step = numbers.brief(self._landscapes.step, self.look.glyphs)
        return named._replace(note=f"a line every {step}")

    def _landscape(
        self, cells: Sequence[CellContent], part: MapPart, form: CellForm, width: int, height: int
    ) -> list[Strip] | None:
        artist = self._landscapes
        if artist is None or artist.look is not self.look:
            artist = self._landscapes = LandscapeArtist(self.look)
        cell = Size(form.width, form.height)
        return artist.strips(cells, part, cell, self.tints, Size(width, height))

    def _number_form(self, values: FloatArray, form: CellForm | ActionForm) -> NumberForm:
        key, layer = type(form).__name__, self.drawn_layer
        if layer is Layer.VISITS and isinstance(form, CellForm):
            return self.number_forms.form((key, layer), values, form.most_digits, most=0)
        return self.number_forms.form((key, layer), values, form.digits, most=_DECIMALS)

    def _cell_form(self, width: int, height: int) -> CellForm:
        grid = self._map.grid
        self._action_form = actions = self._form_of_actions(width, height)
        if actions is not None:
            return CellForm(actions.width, actions.height)
        if self.cell:
            return CellForm(self.cell.width, self.cell.height, self._digits)
        return cell_form(grid.rows, grid.columns, width, height, self._digits)

    def _form_of_actions(self, width: int, height: int) -> ActionForm | None:
        if not self.shows_actions or self.veils or self.drawn_layer not in ACTION_LAYERS:
            return None
        grid, kinds, digits = self._map.grid, self._map.action_kinds, self._action_digits
        signs = max(len(sign_text(each, self.look)) for each in self._map.signs)
        size = grid.rows, grid.columns, width, height, digits, signs
        return whole_map_form(kinds, *size, tints=self.look.palette.tints) or part_form(kinds, *size)

    def _what_is_drawn(self, form: CellForm, width: int) -> str:
        actions, arrows = self._action_form, self.policy_shown
        if studies := self.study_headings("V" if actions is None else "Q"):
            return self.fitting(studies, width - self.scale_room) or studies[-1]
        heading = heading_of_actions(actions) if actions else heading_of_values(form, arrows, self.look)
        forms: tuple[str, ...] = (heading,)
        if self.is_numbered and self._longest_name <= self._room_for_names(form):
            forms = numbered(heading, form, arrows, self._longest_name, in_corner=actions is not None)
        return self.fitting(forms, width) or heading

    @property
    def lacks_room(self) -> bool:
        """True if cells are too small for every action."""
        is_wanted = self.shows_actions and self.drawn_layer in ACTION_LAYERS
        return is_wanted and self._form is not None and self._action_form is None

    def has_room_in(self, width: int, height: int) -> bool:
        """Return whether this size shows what is wanted."""
        return not self.shows_actions or self._form_of_actions(width, height) is not None

    def _room_for_names(self, form: CellForm) -> int:
        return form.longest_name if self._action_form is None else name_room(self._action_form)

    @property
    def _own_name(self) -> str:
        return "" if self.snapshot is None else self.world.space.state_names[self.snapshot.counters.state]

    def _name_beside_arrows(self, form: CellForm) -> str:
        has_names = 0 < self._longest_name <= self._room_for_names(form) and not form.has_values
        return self._own_name.rjust(self._longest_name) if has_names and not self._action_form else ""

    def signs(self) -> Iterator[LegendSign]:
        """Yield the signs on this map."""
        palette, glyphs, ink = self.look.palette, self.look.glyphs, self._middle_ink
        form, signs, actions = self._form, self._map.signs, self._action_form
        if self._is_landscape:
            yield self.agent_sign()
            yield from place_signs(self._map, self._kinds - {CellKind.START}, ink, self.look, says_start=True)
            return
        name = self._name_beside_arrows(form) if form else ""
        has_arrows = form is not None and form.width - len(name) >= LEAST_ARROWS
        if form is not None and self.differing:
            yield differing_sign(form.width, name, self.look)
        if form is not None and self._map.rewards:  # the least obvious comes first
            texts = [self._artist_for(form).shown_reward(each) for each in self._map.rewards]
            yield from reward_signs(self._map.rewards, texts, self.look)
        if actions is not None or (form and form.has_values):
            yield from self.valueless_signs()
        if actions is not None:
            yield from action_signs(actions, self.tints.tints(palette)[-1], self.look)
        elif self._has_several and has_arrows and not self.shows_drawing:
            yield LegendSign(SEVERAL, "tie", ink)
        if actions is None and has_arrows:
            yield from letter_signs(self._map, ink)
        yield self.agent_sign()
        if actions is None and self._has_untried and self.tints.is_signed:  # almost as grey as a 0
            yield LegendSign(glyphs.untried, "not tried", palette.unvisited)
        has_edges = actions is None and form is not None and form.width >= LEAST_ARROWS
        yield from ground_signs(self._map, ink, self.look, has_edges=has_edges)
        if self._map.unreached:
            yield LegendSign(glyphs.unreached, "unreached", palette.rule)
        if form is not None and self._longest_name > self._room_for_names(form):
            yield LegendSign("#", "no room", palette.dim)
        if actions is None:
            yield from self.missing_table_signs()
        if self.snapshot is not None and form is not None and not self._is_drawn:
            left = self._traces(self.snapshot)
            yield from trace_signs(left, ink, self.look, has_ways=form.has_blocks and actions is None)
        if actions is None and has_arrows and self._has_greedy and not self.lacks_table:
            greedy = ([each for each in signs if isinstance(each, tuple)] or signs)[-1]
            has_blocks = form is not None and form.has_blocks and glyphs.braille
            is_block = has_blocks and isinstance(greedy, tuple)
            is_paled = palette.has_shades and self._has_pale and not self.shows_drawing
            sign = glyphs.head_up if is_block else sign_text(greedy, self.look)
            if is_paled:
                yield LegendSign(sign, PALE, paled(ink, 0.0))
            else:
                yield LegendSign(sign, self.policy_shown, ink)
        says_start = form is not None and form.says_start and actions is None
        yield from place_signs(self._map, self._kinds, ink, self.look, says_start=says_start)
        if CellKind.WALL in self._kinds and not self._map.grid.legend:  # otherwise a wall looks like the page
            yield LegendSign(glyphs.wall, "wall", palette.wall)
        if form is not None and 0 < self._longest_name <= self._room_for_names(form):
            yield LegendSign(
                self._own_name, "state number" if self._own_name.isdigit() else "state", palette.text
            )

    @property
    def _middle_ink(self) -> Style:
        """The ink of arrows in the middle of the colour scale."""
        (low, high), palette = self.tints.ends, self.look.palette
        ink = self.tints.style((low + high) / 2, palette) if low < high else palette.unvisited
        return ink + Style(bold=True)

    def redraw(self) -> None:
        """Draw again, and report another visible part."""
        super().redraw()
        if self.cells != self._requested and self.is_attached and is_large(self.world):
            self._requested = self.cells
            self.post_message(Scrolled())

    def pan(self, rows: int, columns: int) -> None:
        """Scroll, and stop following the agent."""
        if self._is_whole:
            return
        self._following = False
        self._top, self._left = self._top + rows, self._left + columns

    def follow(self) -> None:
        """Keep the agent visible again."""
        self._following = True

    def _artist_for(self, form: CellForm) -> CellArtist | ActionArtist:
        if self._action_form is not None:
            drawing = self._action_artist
            if drawing is None or drawing.form != self._action_form or drawing.look is not self.look:
                drawing = self._action_artist = ActionArtist(self.look, self._action_form)
            return drawing
        artist = self._artist
        if artist is None or artist.form != form or artist.look is not self.look:
            artist = self._artist = CellArtist(self.look, form)
        artist.veils = self.veils
        return artist

    @property
    def _is_whole(self) -> bool:
        grid, part = self._map.grid, self._part
        return part is None or (part.rows, part.columns) == (grid.rows, grid.columns)

    def _where(self, width: int) -> str:
        legend, axes = self._map.grid.legend, self._map.grid.axes
        if self._is_whole or self._part is None:
            says_all = axes is not None and axes.titles and not any(axes.columns)
            return "" if self._names_bins or says_all else self.fitting(shorter(legend), width)
        is_led = bool(self.subject)
        return self.fitting(where(self._map.grid, self._part, follows=self._following, is_led=is_led), width)
