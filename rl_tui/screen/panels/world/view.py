"""The base of all pictures of a world: its cursor, its places (cells, states or arms), and drawing in it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, ClassVar, Final

from rich.cells import cell_len
from textual import events
from textual.binding import BindingType
from textual.strip import Strip

from rl_tui.live.last_step.step_report import story_of
from rl_tui.live.snapshot import Snapshot
from rl_tui.live.viewport import Cells
from rl_tui.screen.draw.canvas import Canvas, Line, Piece, length, shortened, spelled, strips_of
from rl_tui.screen.draw.names import state_name
from rl_tui.screen.draw.number_form import SteadyForms
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.counterparts import are_alike
from rl_tui.screen.kit.layers import WORDS, Layer, as_layer, scale_numbers, veils_exact, world_layer
from rl_tui.screen.kit.panel import AGENT, BoardPanel, Legend, LegendSign, agent_meaning
from rl_tui.screen.kit.pointing import NOWHERE, Moved, PartPointed, Pointed
from rl_tui.screen.kit.snapshot_facts import is_new_run, passes_too_fast
from rl_tui.screen.kit.value_scale import Ramp, SteadyScale, ValueScale
from rl_tui.screen.panels.last_step.state_backup_text import backup_text
from rl_tui.screen.panels.status_line import how_far
from rl_tui.screen.panels.world.drawn_picture import DrawnPicture
from rl_tui.screen.panels.world.edit_marks import edit_signs, with_signs
from rl_tui.screen.panels.world.scale_line import (
    ALL_ZERO,
    NOTHING_KNOWN,
    VALUE,
    VEILED,
    NamedScale,
    scale_line,
)
from rl_tui.screen.panels.world.shown_policy import TITLE
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.world import World

WAITING: Final = "the world is being built"
SCALE_ROOM: Final = 28
"""The cells that the scale needs behind what is said first in the line below the picture."""
_LEAST_RESULTS: Final = 18  # columns
_GAP: Final = 3  # columns


class WorldView(DrawnPicture, can_focus=True):
    """A panel with the picture of one world, and below it a line with the scale and what is to be said.

    In focus it has a cursor on a cell, a state or an arm, which follows the agent until it is moved.
    ``is_manual`` hides it. ``title`` and ``prompt`` are those of a mode, ``lane`` and ``results`` those of
    one of two runs, ``note`` is about both. Subclasses implement :meth:`drawing` and say what the places are.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        binding("up", "move(-1, 0)", "world.up", "Move the cursor up"),
        binding("down", "move(1, 0)", "world.down", "Move the cursor down"),
        binding("left", "move(0, -1)", "world.left", "Move the cursor left"),
        binding("right", "move(0, 1)", "world.right", "Move the cursor right"),
        binding("pageup", "page(-1, 0)", "world.page_up", "Move the cursor a page up"),
        binding("pagedown", "page(1, 0)", "world.page_down", "Move the cursor a page down"),
        binding("shift+left", "page(0, -1)", "world.page_left", "Move the cursor a page to the left"),
        binding("shift+right", "page(0, 1)", "world.page_right", "Move the cursor a page to the right"),
        binding("home", "follow", "world.follow", "Follow the agent again"),
        binding("escape,full_stop", "back", "world.back", "Follow the agent again, where a cursor was put"),
    ]

    title: tuple[str, ...] = ()
    prompt: tuple[str, ...] = ()
    lane: tuple[str, ...] = ()
    results: tuple[Line, ...] = ()
    free_columns = 0  # the empty columns right of the picture
    note: tuple[str, ...] = ()
    has_note = False
    replaces_header = False  # whether the line below ends with what the run does and how far it has come
    is_manual = False  # whether a person takes the actions
    wanted_layer = Layer.Q  # the layer to draw, if this world has it; the table shows the same
    drawn_layer = Layer.Q  # the layer that was drawn last
    veils = False  # whether dots hide its numbers
    range_of_v = ValueScale()  # the scale of V, by which actions lead, whatever is tinted
    is_numbered = False  # whether the cells of a map have the numbers of their states
    shows_actions = False
    """Whether the cells of a map show Q of every action, where they have room, in place of V."""
    _is_named_beside = False
    _stands_at: tuple[Piece, ...] = ()
    _taken = 0  # cells that these take
    _said = "", ""  # a mode or a lane, and what is said with it, in one line

    def __init__(self, world: World, look: Look, **options: Any) -> None:
        super().__init__(look, **options)
        self.steady_scale = SteadyScale()  # the scale of all tints, shared by both runs
        self.enter(world)

    def enter(self, world: World, *, goes_on: bool = False) -> None:
        """Take ``world`` for the one that is drawn; where it ``goes_on``, the cursor stays."""
        self.world, self.number_forms = world, SteadyForms()
        if not goes_on:
            self.cursor: int | None = None  # where the user put it; None while it stays with the agent
        self._pointed: int | None = None  # where the cursor of another panel stands

    @property
    def lacks_room(self) -> bool:
        """Whether cells are too small for Q of every action, though they are to show it."""
        return False

    def has_room_in(self, width: int, height: int) -> bool:
        """Return whether cells have room for what they are to show in a panel of that size."""
        return True

    def show_mode(self, title: tuple[str, ...], prompt: tuple[str, ...], *, has_keys: bool) -> None:
        """Say what mode is on, and whether its keys count here; without a title none is."""
        self.set_class(has_keys, "-manual")
        if (title, prompt) != (self.title, self.prompt):
            self.title, self.prompt = title, prompt
            self.redraw()

    def take_over(self, other: WorldView) -> None:
        """Take from the view ``other`` what a mode has made of it, and the focus: this one is led now."""
        self.is_manual, other.is_manual = other.is_manual, False
        self.is_drawn_on, other.is_drawn_on = other.is_drawn_on, False
        self.picked, other.picked = other.picked, frozenset()
        self.show_mode(other.title, other.prompt, has_keys=other.has_class("-manual"))
        other.show_mode((), (), has_keys=False)
        if other.has_focus:
            self.focus()

    def show(self, snapshot: Snapshot) -> None:
        """Draw ``snapshot``; another seed may have made another world of the same kind, or an edit."""
        if is_new_run(self.snapshot, snapshot):
            self.steady_scale.clear()
        if snapshot.world is not self.world:
            goes_on = not self.begins_anew(snapshot)
            if goes_on and self.cursor is not None and self.snapshot is not None:
                self.cursor = self.carried(self.cursor, self.snapshot, snapshot)
            self.enter(snapshot.world, goes_on=goes_on)
        super().show(snapshot)

    @property
    def cells(self) -> Cells | None:
        """The cells of the map in view, None where all of it is or there is no map."""
        return None

    @property
    def is_away(self) -> bool:
        """Whether cursor or view were moved away from the agent, and not back."""
        return self.cursor is not None

    def legend(self, snapshot: Snapshot) -> Legend:
        """Return the signs of the world; those of what is drawn and not in force may be in the title."""
        drawn = () if self.title else edit_signs(snapshot.editor, self.look)
        return *self.random_signs(), *drawn, *self.signs()

    def signs(self) -> Iterable[LegendSign]:
        """Return the signs that pictures of this world may have, those that matter most first."""
        raise NotImplementedError

    def agent_sign(self) -> LegendSign:
        """Return the sign of where the agent is."""
        who = AGENT if self.snapshot is None else agent_meaning(self.snapshot)
        return LegendSign(self.look.glyphs.agent, who, self.look.palette.agent)

    # Places

    def agent_place(self, snapshot: Snapshot) -> int:
        """Return where the agent is."""
        return snapshot.counters.state

    def moved(self, place: int, rows: int, columns: int) -> int:
        """Return the place ``rows`` below and ``columns`` to the right, or the last one on the way."""
        raise NotImplementedError

    def state_at(self, place: int) -> int | None:
        """Return the state at ``place``, None where there is none."""
        return place

    def name_at(self, place: int) -> str:
        """Return what stands at ``place``, empty where nothing does that has a name."""
        state = self.state_at(place)
        return "" if state is None else f"state {state_name(self.world, state, self.look.glyphs)}"

    def pairs_at(self, place: int) -> range:
        """Return the pairs that ``place`` is about."""
        state = self.state_at(place)
        return NOWHERE if state is None else self.world.space.pairs_of(state)

    def place_of(self, pair: int) -> int:
        """Return the place that ``pair`` is about."""
        return self.world.space.state_of(pair)

    @property
    def page_size(self) -> tuple[int, int]:
        """How many rows and columns a page key moves the cursor."""
        return 1, 1

    @property
    def cursor_place(self) -> int | None:
        """Where the cursor stands: with the agent until it is moved; None before the first snapshot."""
        if self.cursor is not None or self.snapshot is None:
            return self.cursor
        return self.agent_place(self.snapshot)

    @property
    def shown_cursor(self) -> int | None:
        """The place at which a cursor is drawn: its own while in focus, else that of another panel."""
        if self.is_manual:
            return None
        return self.cursor_place if self.has_focus else self._pointed

    def put_cursor(self, place: int) -> None:
        """Put the cursor on ``place``, and scroll so far that it is seen."""
        self.cursor = place
        self.keep_in_view(place)
        self.redraw()
        self._tell(self.pairs_at(place))

    def point_at(self, pairs: range) -> None:
        """Show where the cursor of another panel stands; no pairs: it has none."""
        if pairs:
            self._pointed = self.place_of(pairs.start)
            self.keep_in_view(self._pointed)
        elif self._pointed is not None:
            self._pointed = None
            if self.cursor is None:
                self.follow()
        self.redraw()

    def keep_in_view(self, place: int) -> None:
        """Scroll so far that ``place`` is seen."""

    def align_with(self, twin: BoardPanel) -> None:
        """Take cursor, scale and forms of the view ``twin``; subclasses take the rest of its stance."""
        if isinstance(twin, WorldView):
            self.steady_scale, self.number_forms, at = twin.steady_scale, twin.number_forms, twin.cursor
            place = None if at is None else self.place_in(at, twin.world, self.world)
            if place is not None or self.takes_stance_of(twin):
                self.cursor = place

    def takes_stance_of(self, twin: WorldView) -> bool:
        """Return whether all that ``twin`` shows holds here: in another world only where this one is led."""
        return self.is_led or are_alike(twin.world, self.world)

    def _tell(self, pairs: range) -> None:
        if self.is_attached:
            self.post_message(Pointed(self, pairs))

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the drawing of ``snapshot``, a moment of a run in this view's world."""
        if snapshot is None:
            return self._waiting(width, height)
        has_line = self.cell is not None and height > 1
        if self.replaces_header:
            self._stands_at = how_far(snapshot, self.look, width, is_manual=self.is_manual)
        else:
            self._stands_at = ()
        self._taken = length(spelled(self._stands_at, self.look))
        rows = height - has_line
        self.drawn_layer = layer = self._layer_of(snapshot, self.wanted_layer)
        self.veils = layer is Layer.OPTIMAL and veils_exact(snapshot)
        self.tints = ValueScale() if self.veils else self.steady_scale.of(snapshot, layer)
        self.range_of_v = self.tints if self.tints.ramp is Ramp.VALUES else self.steady_scale.of_v
        strips = self.drawing(as_layer(snapshot, layer), width, rows)
        strips = self._with_results(strips, width)
        self._say_what_matters(snapshot, width)
        return [*strips, self._line(snapshot, width)] if has_line else strips

    def _with_results(self, strips: list[Strip], width: int) -> list[Strip]:
        room, palette = self.free_columns - _GAP, self.look.palette
        name, *settings = (self.lane or ("",))[0].split(" · ")
        said = [[Piece(name, palette.strong)], *([Piece(f"  {each}", palette.dim)] for each in settings)]
        self._is_named_beside = bool(self.results) and room >= max(_LEAST_RESULTS, *map(length, said))
        if not self._is_named_beside:
            return strips
        left, lines = width - room, strips_of([*said, [], *self.results], room, len(strips), self.look)
        return [Strip.join((one.crop(0, left), other)) for one, other in zip(strips, lines, strict=True)]

    def has_layer(self, layer: Layer) -> bool:
        """Return whether it is drawn otherwise in ``layer`` than in others; V is drawn where it is not."""
        snapshot = self.snapshot
        return snapshot is not None and self._layer_of(snapshot, layer) is layer

    def _layer_of(self, snapshot: Snapshot, layer: Layer) -> Layer:
        if layer is Layer.LANDSCAPE:
            return layer if self.has_landscape else Layer.Q
        return Layer.Q if self.studied is not None else world_layer(snapshot, layer)

    @property
    def has_landscape(self) -> bool:
        """Whether it can be drawn as a landscape."""
        return False

    def _waiting(self, width: int, height: int) -> list[Strip]:
        canvas = Canvas(width, height, self.look.palette.text)
        text = shortened(WAITING, width, self.look.glyphs.ellipsis)
        canvas.put((width - len(text)) // 2, (height - 1) // 2, text, self.look.palette.dim)
        return canvas.strips()

    def _say_what_matters(self, snapshot: Snapshot, width: int) -> None:
        if not (self.footing or self.lane or self.is_manual or self.cursor is not None):
            self.footing = self.fitting(self._equation(snapshot), width)
        if not self.footing and self.has_focus:
            self.footing = self.fitting(self._about_cursor(), width)
        if self.lane:
            self._name_lane(width)
        if self.title:
            titles = with_signs(self.title, snapshot.editor, self.look) if self.is_explained else self.title
            self._say(titles, self.prompt, width)

    def _say(self, headings: Sequence[str], footings: Sequence[str], width: int) -> None:
        self.heading, self.footing = self.fitting(headings, width), self.fitting(footings, width)
        pairs = ((heading, footing) for heading in headings for footing in footings)
        room = width - self._taken - (4 if self.title else 2)  # blanks around a mode, before what it says
        fitting = (pair for pair in pairs if sum(map(cell_len, pair)) <= room)
        self._said = next(fitting, (self.heading, ""))

    def _explain(self, snapshot: Snapshot) -> None:
        """Do nothing: the line below the picture has the signs."""

    def _line(self, snapshot: Snapshot, width: int) -> Strip:
        palette = self.look.palette
        said: list[Piece] = []
        heading, footing = self._said if self.title or self.lane else (self.heading, self.footing)
        says_lane = self.lane and not self._is_named_beside
        if self.title:
            said += [Piece(f" {heading} ", palette.focus)]
        elif says_lane or self.studied is not None or self.is_numbered or self.shows_actions:
            said += [Piece(heading, palette.strong)]
        if footing:
            said += [Piece("  " if said else "", palette.text), Piece(footing, palette.dim)]
        # of two runs one has scale and legend: below both maps, else the one with fewer words
        tells = not self.lane or self.has_note is self._is_named_beside
        signs = self.legend(snapshot) if self.is_explained and tells else ()
        if self.note:
            signs = tuple(sign for sign in signs if sign.sign.strip() != self.look.glyphs.differs)
        scale = self.named_scale if tells else None
        line = scale_line(tuple(said), scale, signs, width - self._taken, self.look)
        if not self._taken:
            return line
        return Strip.join((line, strips_of([self._stands_at], self._taken, 1, self.look)[0]))

    def fitting(self, titles: Iterable[str], width: int) -> str:
        """Return the first of ``titles`` that fits into the line below a picture of ``width`` cells."""
        return super().fitting(titles, width - self._taken)

    @property
    def named_scale(self) -> NamedScale | None:
        """The scale of the tints and the word for it; None where nothing is tinted."""
        layer = self.drawn_layer
        if isinstance(self.world.drawing, Arms) or (self.lacks_table and layer not in WORDS):
            return None
        is_known = self.snapshot is not None and len(scale_numbers(self.snapshot, layer)) > 0
        unknown = VEILED if self.veils else ALL_ZERO if is_known else NOTHING_KNOWN
        return NamedScale(WORDS.get(layer, VALUE), self.tints, unknown)

    def _name_lane(self, width: int) -> None:
        shows = self.heading.removeprefix(f"{TITLE} · ")
        footings = (self.footing, *self._about_cursor())
        if not self.has_focus:
            footings = self.note or (self.footing, "" if self.is_explained else shows)
            if self.studied is not None:
                footings = (shows, shows.partition(" · ")[0], *footings)
        self._say(self.lane, tuple(filter(None, footings)), width)

    def _equation(self, snapshot: Snapshot) -> Sequence[str]:
        last = snapshot.counters.last_step
        if last is None or not last.planned or self.studied is not None or passes_too_fast(snapshot):
            return ()
        story = story_of(snapshot)
        if story is None or story.state_backup is None:
            return ()
        glyphs = self.look.glyphs
        return backup_text(snapshot.world, story.state_backup, glyphs).lines(glyphs.arrow_update)

    def _about_cursor(self) -> tuple[str, ...]:
        if self.cursor is None:
            usual = "arrows: cursor · t b: breakpoint"
            return f"{usual} · ?: words", usual, "arrows: cursor"
        name = self.name_at(self.cursor)
        if not name:
            return "esc: back to the agent", "esc: back"
        return f"{name} · t b: breakpoint · esc: back", f"{name} · esc: back", name

    def drawing(self, snapshot: Snapshot, width: int, height: int) -> list[Strip]:
        """Return ``height`` strips of ``width`` cells (both at least 1)."""
        raise NotImplementedError

    def pan(self, rows: int, columns: int) -> None:
        """Scroll by hand, so many steps down and to the right, where there is more than fits."""

    def follow(self) -> None:
        """Undo all scrolling by hand."""

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Leave escape to the screen while there is nothing to go back from; an unseen cursor stays."""
        if action == "back":
            return self.is_away
        return not (self.is_manual and action in ("move", "page"))

    def action_move(self, rows: int, columns: int) -> None:
        """Move the cursor; the first move starts where the agent is."""
        place = self.cursor_place
        if place is not None:
            self.put_cursor(self.moved(place, rows, columns))

    def action_page(self, rows: int, columns: int) -> None:
        """Move the cursor by pages."""
        down, across = self.page_size
        self.action_move(rows * down, columns * across)

    def action_back(self) -> None:
        """Follow the agent again."""
        self.action_follow()

    def action_follow(self) -> None:
        """Follow the agent again."""
        self.cursor = None
        self.follow()
        self.redraw()
        self._tell(NOWHERE)

    def on_click(self, event: events.Click) -> None:
        """Put the cursor where the pointer is."""
        offset = event.get_content_offset(self)
        if offset is None or self.snapshot is None or self.is_manual or self.is_drawn_on:
            return
        place, before = self.place_at(*offset), self.cursor
        if place is not None:
            self.put_cursor(place)
            if place == before:
                self.post_message(PartPointed(self, self.part_at(*offset)))

    def on_resize(self) -> None:
        """Bring the part that is in view now into view in the lane beside."""
        if not self.is_led:
            self.post_message(Moved(self))

    def watch_has_focus(self, has_focus: bool) -> None:
        """Show or hide the cursor, here and in other panels."""
        super().watch_has_focus(has_focus)
        self.redraw()
        shown = self.cursor if has_focus else None
        self._tell(NOWHERE if shown is None else self.pairs_at(shown))

    def turn_wheel(self, rows: int, event: events.MouseEvent) -> None:
        """Scroll by so many rows, with shift or ctrl by columns; where it is drawn on, tell of the turn."""
        event.stop()
        if self.turns(event, rows):
            return
        sideways = event.shift or event.ctrl
        self.pan(0 if sideways else rows, rows if sideways else 0)
        self.redraw()
        self.post_message(Moved(self))
