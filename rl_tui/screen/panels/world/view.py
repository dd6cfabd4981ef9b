"""The base of all world pictures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, ClassVar, Final

from rich.cells import cell_len
from rich.style import Style
from textual import events
from textual.binding import BindingType
from textual.strip import Strip

from rl_tui.live.last_step.step_report import story_of
from rl_tui.live.snapshot import Snapshot
from rl_tui.live.viewport import Cells
from rl_tui.screen.draw.action_order import next_states
from rl_tui.screen.draw.canvas import Canvas, Line, Piece, length, shortened, spelled, strips_of
from rl_tui.screen.draw.names import state_name
from rl_tui.screen.draw.number_form import SteadyForms
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.counterparts import are_alike
from rl_tui.screen.kit.layers import WORDS, Layer, as_layer, layer_numbers, veils_exact, world_layer
from rl_tui.screen.kit.panel import AGENT, BORDER_ENDS, BoardPanel, Legend, LegendSign, agent_meaning
from rl_tui.screen.kit.pointing import NOWHERE, Moved, PartPointed, Pointed
from rl_tui.screen.kit.snapshot_facts import BEING_BUILT, is_new_run, passes_too_fast
from rl_tui.screen.kit.value_scale import Ramp, SteadyScale, ValueScale
from rl_tui.screen.panels.last_step.state_backup_text import backup_text
from rl_tui.screen.panels.policies.studied import policy_ink
from rl_tui.screen.panels.status_line import how_far
from rl_tui.screen.panels.world import scale_line as scales
from rl_tui.screen.panels.world.drawn_picture import DrawnPicture
from rl_tui.screen.panels.world.edit_marks import edit_signs, with_signs
from rl_tui.screen.panels.world.shown_policy import TITLE
from rl_tui.screen.theme.glyphs import UNICODE
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.world import World

SCALE_ROOM: Final = 28  # cells, in the line below the picture
_LEAST_RESULTS: Final = 18  # columns
_GAP: Final = 3  # columns


class WorldView(DrawnPicture, can_focus=True):
    """The picture of one world, with a line for scale and texts.

    The cursor, on a cell, state or arm, follows the agent until moved. ``is_manual`` hides it. ``title`` and
    ``prompt`` belong to a mode, ``lane`` and ``results`` to one of two runs, ``note`` to both. Subclasses
    implement :meth:`drawing` and define the places.
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
        binding("escape,full_stop", "back", "world.back", "Follow the agent again, if you moved the cursor"),
    ]

    title: tuple[str, ...] = ()
    prompt: tuple[str, ...] = ()
    lane: tuple[str, ...] = ()
    results: tuple[Line, ...] = ()
    free_columns = 0  # empty columns right of the picture
    note: tuple[str, ...] = ()
    has_note = False
    replaces_header = False  # the line below ends with phase and progress of the run
    is_manual = False  # a person takes the actions
    wanted_layer = Layer.Q  # layer to draw if available: the table shows the same
    drawn_layer = Layer.Q  # layer of the last picture
    veils = False  # dots hide its numbers
    range_of_v = ValueScale()  # scale of V for the lead of actions, in any layer
    is_numbered = False  # map cells show state numbers
    shows_actions = False
    """Whether map cells show every action instead of V."""
    _is_named_beside = False
    _stands_at: tuple[Piece, ...] = ()
    _taken = 0  # cells of the text above
    _said = "", ""  # a mode or run, and its text, in one line

    def __init__(self, world: World, look: Look, **options: Any) -> None:
        super().__init__(look, **options)
        self.steady_scale = SteadyScale()  # colour scale of both runs
        self.enter(world)

    def enter(self, world: World, *, goes_on: bool = False) -> None:
        """Switch to ``world``. The cursor stays if it ``goes_on``."""
        self.world, self.number_forms = world, SteadyForms()
        if not goes_on:
            self.cursor: int | None = None  # set by the user, None while it follows the agent
        self._pointed: int | None = None  # cursor of another panel
        self.subject = NOWHERE
        """The pairs that the open panel is about: one, or all of a state."""

    @property
    def lacks_room(self) -> bool:
        """True if cells are too small for every action."""
        return False

    def has_room_in(self, width: int, height: int) -> bool:
        """Return whether this size shows what is wanted."""
        return True

    def show_mode(self, title: tuple[str, ...], prompt: tuple[str, ...], *, has_keys: bool) -> None:
        """Show the mode, and whether its keys work here."""
        self.set_class(has_keys, "-manual")
        if (title, prompt) != (self.title, self.prompt):
            self.title, self.prompt = title, prompt
            self.redraw()

    def take_over(self, other: WorldView) -> None:
        """Take mode and focus when control changes runs."""
        self.is_manual, other.is_manual = other.is_manual, False
        self.is_drawn_on, other.is_drawn_on = other.is_drawn_on, False
        self.picked, other.picked = other.picked, frozenset()
        self.show_mode(other.title, other.prompt, has_keys=other.has_class("-manual"))
        other.show_mode((), (), has_keys=False)
        if other.has_focus:
            self.focus()

    def show(self, snapshot: Snapshot) -> None:
        """Draw ``snapshot``, possibly of another world."""
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
        """The map's visible cells, or None."""
        return None

    @property
    def is_away(self) -> bool:
        """True if cursor or view left the agent."""
        return self.cursor is not None

    def legend(self, snapshot: Snapshot) -> Legend:
        """Return the world's signs."""
        drawn = () if self.title else edit_signs(snapshot.editor, self.look)
        return *self._subject_signs(), *self.random_signs(), *drawn, *self.signs()

    def _subject_signs(self) -> Iterable[LegendSign]:
        frame, palette = self.look.glyphs.frame[:2], self.look.palette
        if self.subject and self.shown_cursor is not None:
            name = "s" if self.subject_next else self.name_at(self.place_of(self.subject.start))
            yield LegendSign(frame, name, palette.you)
        if self.subject_next:
            yield LegendSign(frame, "possible s′", palette.source_line)

    def signs(self) -> Iterable[LegendSign]:
        """Return the possible signs, most important first."""
        raise NotImplementedError

    def agent_sign(self) -> LegendSign:
        """Return the agent's sign."""
        who = AGENT if self.snapshot is None else agent_meaning(self.snapshot)
        return LegendSign(self.look.glyphs.agent, who, self.look.palette.agent)

    # Places

    def agent_place(self, snapshot: Snapshot) -> int:
        """Return the agent's place."""
        return snapshot.counters.state

    def moved(self, place: int, rows: int, columns: int) -> int:
        """Return the place that far away."""
        raise NotImplementedError

    def state_at(self, place: int) -> int | None:
        """Return the state here, or None."""
        return place

    def name_at(self, place: int) -> str:
        """Name the state here, if any."""
        state = self.state_at(place)
        return "" if state is None else f"state {state_name(self.world, state, self.look.glyphs)}"

    def pairs_at(self, place: int) -> range:
        """Return the pairs here."""
        state = self.state_at(place)
        return NOWHERE if state is None else self.world.space.pairs_of(state)

    def place_of(self, pair: int) -> int:
        """Return the pair's place."""
        return self.world.space.state_of(pair)

    @property
    def page_size(self) -> tuple[int, int]:
        """Rows and columns of a page."""
        return 1, 1

    @property
    def cursor_place(self) -> int | None:
        """The cursor's place, by default the agent's."""
        if self.cursor is not None or self.snapshot is None:
            return self.cursor
        return self.agent_place(self.snapshot)

    @property
    def shown_cursor(self) -> int | None:
        """The place of its own or another panel's cursor."""
        if self.is_manual:
            return None
        return self.cursor_place if self.has_focus else self._pointed

    def put_cursor(self, place: int) -> None:
        """Move the cursor and scroll to it."""
        self.cursor = place
        self.keep_in_view(place)
        self.redraw()
        self._tell(self.pairs_at(place))

    def point_at(self, pairs: range) -> None:
        """Show another panel's cursor."""
        if pairs:
            self._pointed = self.place_of(pairs.start)
            self.keep_in_view(self._pointed)
        elif self._pointed is not None:
            self._pointed = None
            if self.cursor is None:
                self.follow()
        self.redraw()

    @property
    def subject_next(self) -> frozenset[int]:
        """The open panel's next states."""
        return next_states(self.world, self.subject.start) if len(self.subject) == 1 else frozenset()

    def keep_in_view(self, place: int) -> None:
        """Scroll until ``place`` is visible."""

    def align_with(self, twin: BoardPanel) -> None:
        """Take cursor, scale and forms of ``twin``."""
        if isinstance(twin, WorldView):
            self.steady_scale, self.number_forms, at = twin.steady_scale, twin.number_forms, twin.cursor
            place = None if at is None else self.place_in(at, twin.world, self.world)
            if place is not None or self.takes_stance_of(twin):
                self.cursor = place

    def takes_stance_of(self, twin: WorldView) -> bool:
        """Return whether the twin's stance applies here."""
        return self.is_led or are_alike(twin.world, self.world)

    def _tell(self, pairs: range) -> None:
        if self.is_attached:
            self.post_message(Pointed(self, pairs))

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Draw ``snapshot``."""
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
        """Return whether ``layer`` has its own picture."""
        snapshot = self.snapshot
        return snapshot is not None and self._layer_of(snapshot, layer) is layer

    def _layer_of(self, snapshot: Snapshot, layer: Layer) -> Layer:
        if layer is Layer.LANDSCAPE:
            return layer if self.has_landscape else Layer.Q
        return Layer.Q if self.studied is not None else world_layer(snapshot, layer)

    @property
    def has_landscape(self) -> bool:
        """True if a landscape is possible."""
        return False

    def _waiting(self, width: int, height: int) -> list[Strip]:
        canvas = Canvas(width, height, self.look.palette.text)
        text = shortened(BEING_BUILT, width, self.look.glyphs.ellipsis)
        canvas.put((width - len(text)) // 2, (height - 1) // 2, text, self.look.palette.dim)
        return canvas.strips()

    def _say_what_matters(self, snapshot: Snapshot, width: int) -> None:
        if not (self.footing or self.lane or self.is_manual or self.cursor is not None):
            self.footing = self.fitting(self._equation(snapshot), width - self.scale_room)
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
        room = width - self._taken - (4 if self.title else 2)  # blanks around a mode, before its text
        fitting = [pair for pair in pairs if sum(map(cell_len, pair)) <= room]
        if self.title:
            cut_off = f"{self.look.glyphs.ellipsis} "  # whole names first
            fitting.sort(key=lambda pair: pair[1] == footings[-1] or cut_off in f"{pair[1]} ")
        left = SCALE_ROOM if self.studied is not None and self.title else 0
        beside_scale = (pair for pair in fitting if sum(map(cell_len, pair)) <= room - left)
        self._said = next(beside_scale, next(iter(fitting), (self.heading, "")))

    def _explain(self, snapshot: Snapshot) -> None:
        """Do nothing: the line below the picture has the signs."""

    def _line(self, snapshot: Snapshot, width: int) -> Strip:
        palette, glyphs = self.look.palette, self.look.glyphs
        said: list[Piece] = []
        heading, footing = self._said if self.title or self.lane else (self.heading, self.footing)
        says_lane = self.lane and not self._is_named_beside
        if self.title:
            said += [Piece(glyphs.separated(f" {heading} "), palette.focus)]
        elif says_lane or self.studied is not None or self.is_numbered or self.shows_actions:
            ink = policy_ink(self.studied, palette) if self.studied is not None and not says_lane else Style()
            said += [Piece(glyphs.separated(heading), palette.strong + ink)]
        if footing:
            mark = glyphs.differs if footing.startswith(UNICODE.differs) else ""
            said += [Piece("  " if said else "", palette.text), Piece(mark, palette.text)]
            said += [Piece(glyphs.separated(footing[len(mark) :]), palette.dim)]
        # of two runs, one shows scale and legend: below both maps, else the one with fewer words
        tells = not self.lane or self.has_note is self._is_named_beside
        signs = self.legend(snapshot) if self.is_explained and tells else ()
        if self.lane:  # the note of one of two runs explains it
            signs = tuple(sign for sign in signs if sign.sign.strip() != self.look.glyphs.differs)
        scale = self.named_scale if tells else None
        line = scales.scale_line(tuple(said), scale, signs, width - self._taken, self.look)
        if not self._taken:
            return line
        return Strip.join((line, strips_of([self._stands_at], self._taken, 1, self.look)[0]))

    def fitting(self, titles: Iterable[str], width: int) -> str:
        """Return the first title that fits."""
        return super().fitting(titles, width - self._taken)

    @property
    def scale_room(self) -> int:
        """The cells that a fitting text leaves for the scale."""
        return SCALE_ROOM - BORDER_ENDS if self.cell is not None else 0

    @property
    def named_scale(self) -> scales.NamedScale | None:
        """The colour scale and its word."""
        layer = self.drawn_layer
        if self.world.is_bandit or (self.lacks_table and layer not in WORDS):
            return None
        is_known = self.snapshot is not None and len(layer_numbers(self.snapshot, layer)[0]) > 0
        unknown = scales.VEILED if self.veils else scales.ALL_ZERO if is_known else scales.NOTHING_KNOWN
        return scales.NamedScale(WORDS.get(layer, scales.VALUE), self.tints, unknown)

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
        """Return ``height`` strips of ``width`` cells, both ≥ 1."""
        raise NotImplementedError

    def pan(self, rows: int, columns: int) -> None:
        """Scroll down and right."""

    def follow(self) -> None:
        """Undo manual scrolling."""

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Leave escape to the screen while following."""
        if action == "back":
            return self.is_away
        return not (self.is_manual and action in ("move", "page"))

    def action_move(self, rows: int, columns: int) -> None:
        """Move the cursor."""
        place = self.cursor_place
        if place is not None:
            self.put_cursor(self.moved(place, rows, columns))

    def action_page(self, rows: int, columns: int) -> None:
        """Move by pages."""
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
        """Move the cursor here."""
        offset = event.get_content_offset(self)
        if offset is None or self.snapshot is None or self.is_manual or self.is_drawn_on:
            return
        place, before = self.place_at(*offset), self.cursor
        if place is not None:
            self.put_cursor(place)
            if place == before:
                self.post_message(PartPointed(self, self.part_at(*offset)))

    def on_resize(self) -> None:
        """Align the other run's view."""
        if not self.is_led:
            self.post_message(Moved(self))

    def watch_has_focus(self, has_focus: bool) -> None:
        """Show or hide the cursor everywhere."""
        super().watch_has_focus(has_focus)
        shown = self.cursor if has_focus else None
        self._tell(NOWHERE if shown is None else self.pairs_at(shown))

    def turn_wheel(self, rows: int, event: events.MouseEvent) -> None:
        """Scroll, with shift sideways, or report a stroke."""
        event.stop()
        if self.turns(event, rows):
            return
        sideways = event.shift or event.ctrl
        self.pan(0 if sideways else rows, rows if sideways else 0)
        self.redraw()
        self.post_message(Moved(self))
