"""The World panel of an MDP."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence, Set
from dataclasses import replace
from typing import Any, Final, NamedTuple

from rich.style import Style
from textual.strip import Strip

from rl_tui.live.snapshot import Snapshot
from rl_tui.live.world_editor import EditorView
from rl_tui.screen.draw.block_signs import block_number
from rl_tui.screen.draw.canvas import Canvas, centred, shortened
from rl_tui.screen.draw.names import DEPENDS, DEPENDS_IN_FULL
from rl_tui.screen.kit.panel import BoardPanel, Legend, LegendSign
from rl_tui.screen.kit.scrolling import scrolled_to
from rl_tui.screen.kit.snapshot_facts import followed_step, keeps_back
from rl_tui.screen.panels.graph.chain import ChainPicture, chain_layout, end_rewards, exact_v
from rl_tui.screen.panels.graph.layout import GraphLayout, graph_layout
from rl_tui.screen.panels.graph.routing import Box
from rl_tui.screen.panels.graph.shape import (
    END,
    EdgeList,
    GraphAction,
    GraphScene,
    GraphShape,
    Node,
    Signs,
    graph_action,
    graph_shape,
    on_grid,
)
from rl_tui.screen.panels.world.edit_marks import marks_of
from rl_tui.screen.panels.world.shown_policy import TITLE, state_values
from rl_tui.screen.panels.world.view import WorldView
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Graph
from rl_tui.worlds.editing.graph_draft import GraphDraft, chances_of
from rl_tui.worlds.world import Prospect, World


def draft_shape(editor: EditorView, world: World, graph: Graph, glyphs: Glyphs) -> GraphShape | None:
    """Return the draft's shape if it visibly differs. States of ``world`` keep their numbers."""
    draft, base = editor.draft, editor.base
    if draft is base or not isinstance(draft, GraphDraft) or not isinstance(base, GraphDraft):
        return None
    space = world.space
    names = [*space.state_names, *(each for each in draft.states if each not in space.state_names)]
    places = [
        _place(draft, name) or (graph.places[state] if state < space.states else None)
        for state, name in enumerate(names)
    ]
    known = [place for place in places if place is not None]
    if len(known) < len(names):
        return None
    number_of = {name: number for number, name in enumerate(names)}
    acting = {str(each.get("state")) for each in draft.transitions}
    nodes = tuple(
        Node(glyphs.spelled(name), *place, name not in acting)
        for name, place in zip(names, on_grid(known), strict=True)
    )
    actions = [
        _action(entry, -1 - number, base, number_of, world, glyphs)
        for number, entry in enumerate(draft.transitions)
    ]
    return GraphShape(nodes, tuple(sorted(actions, key=lambda action: action.source)))


def _place(draft: GraphDraft, name: str) -> tuple[int, int] | None:
    places = draft.rules.get("place")
    at: Sequence[int] = places.get(name, ()) if isinstance(places, Mapping) else ()
    return (int(at[0]), int(at[1])) if len(at) == 2 else None


def _action(
    entry: Mapping[str, Any],
    missing: int,
    base: GraphDraft,
    number_of: Mapping[str, int],
    world: World,
    glyphs: Glyphs,
) -> GraphAction:
    state, name, space = str(entry.get("state")), str(entry.get("action")), world.space
    source = number_of[state]
    pair = None
    if source < space.states and name in space.action_names:
        pair = space.pair_of(source, space.action_names.index(name))
    is_new = base.entry(state, name) != entry
    prospects = [
        Prospect(number_of[target], chance, (_reward(entry, target),))
        for target, chance in chances_of(entry).items()
    ]
    shown = f"{glyphs.drafted if is_new else ''}{glyphs.spelled(name)}"
    return graph_action(shown, source, missing if pair is None else pair, prospects, glyphs)


def _reward(entry: Mapping[str, Any], target: str) -> float:
    to = entry.get("to")
    outcome = to.get(target) if isinstance(to, Mapping) else None
    own = outcome.get("reward") if isinstance(outcome, Mapping) else None
    reward = entry.get("reward") if own is None else own
    return float(reward) if isinstance(reward, int | float) else 0.0


# The panel


VALUE_WIDTH: Final = 6
_LEAST_BLOCK: Final = (13, 6)  # columns inside and rows of a box with a block number of four characters
HEADING: Final = f"{TITLE} · bold ="
THIN: Final = 1
BOLD: Final = 2

# index: up + 3·right + 9·down + 27·left, each 0 (nothing), 1 (thin) or 2 (bold)
_JOINTS: Final = " ╵╹╶└┖╺┕┗╷│╿┌├┞┍┝┡╻╽┃┎┟┠┏┢┣╴┘┚─┴┸╼┶┺┐┤┦┬┼╀┮┾╄┒┧┨┰╁╂┲╆╊╸┙┛╾┵┹━┷┻┑┥┩┭┽╃┯┿╇┓┪┫┱╅╉┳╈╋"
_ROUNDED: Final = {"┌": "╭", "┐": "╮", "└": "╰", "┘": "╯"}


class GraphView(WorldView):
    """A graph, or else a list of edges."""

    _top = 0
    _layout: GraphLayout | None = None
    _height = 1
    _is_draft = False

    def enter(self, world: World, *, goes_on: bool = False) -> None:
        """Switch to ``world``. Raises TypeError if it is not a graph, or its outcomes are unknown."""
        if not isinstance(world.drawing, Graph) or (world.mdp is None and not world.prospects):
            raise TypeError("a GraphView needs a world with known outcomes and a Graph as its drawing")
        super().enter(world, goes_on=goes_on)
        self._graph, chain = world.drawing, world.drawing.chain
        if chain:
            place_of = {state: place for place, state in enumerate(chain)}
            self._graph = replace(self._graph, places=tuple((place_of[s], 0) for s in range(len(chain))))
        self._ends = {} if world.mdp is None else end_rewards(world.mdp)
        self._take_shape(is_kept=False)

    def show(self, snapshot: Snapshot) -> None:
        """Draw ``snapshot`` in the run's number formats."""
        if self.begins_anew(snapshot):
            self.number_forms.clear()
        super().show(snapshot)

    def drawing(self, snapshot: Snapshot, width: int, height: int) -> list[Strip]:
        """Draw the graph or the list."""
        is_kept = keeps_back(snapshot, "model")
        editor = snapshot.editor
        assert isinstance(self.world.drawing, Graph)
        drawn = draft_shape(editor, self.world, self.world.drawing, self.look.glyphs)
        if drawn is not None:
            self._shape, self._is_draft = drawn, True
        elif self._is_draft or self._shape_of != (self.look.glyphs, is_kept):
            self._take_shape(is_kept=is_kept)
        heading = f"{HEADING} {self.policy_shown}"
        if studies := self.study_headings("V"):
            self.heading = self.fitting(studies, width - self.scale_room) or studies[-1]
        else:
            self.heading = self.fitting(self.captioned(TITLE), width) or heading
        values = state_values(self.world.space, snapshot, self.tints)
        # drafted states have no value if terminal, else an unknown one
        new = (None if each.terminal else math.nan for each in self._shape.nodes[len(values.value) :])
        values = replace(values, value=(*values.value, *new))
        chain = () if self._is_draft else self._graph.chain
        bundled = self._shape.bundled()
        layout = chain_layout(chain, width, height) if chain else None
        self._layout, self.footing = layout or graph_layout(bundled, width, height), ""
        if layout is not None:
            room = layout.boxes[0].width
        else:
            room = _block_room(self._layout, self.look) if self._layout is not None else 0
        form = values.number_form(min(VALUE_WIDTH, room or VALUE_WIDTH), self.number_forms)
        stops = snapshot.playback.breakpoints
        about = self.subject, self.subject_next
        signs = Signs(snapshot.counters.state, self.shown_cursor, stops, self.differing, editor, *about)
        scene, canvas = GraphScene(values, form, signs), Canvas(width, height, self.look.palette.text)
        exact = exact_v(self.world.space, snapshot)
        if layout is not None:
            last = followed_step(snapshot)
            ChainPicture(canvas, self._shape, layout.boxes, scene, self.look, self._ends, exact, last).draw()
        elif self._layout is not None:
            _draw_graph(canvas, bundled, self._layout, scene, exact, self.look)
        else:
            self._list = EdgeList(self._shape, width)
            rows = len(self._list.lines)
            self._height, self._top = height, max(0, min(self._top, rows - height))
            self.footing = f"↑↓ {self._top + 1}–{self._top + height} of {rows}" if rows > height else ""
            self._list.draw(canvas, scene, self.look, self._top)
        return canvas.strips()

    def _take_shape(self, *, is_kept: bool) -> None:
        self._shape_of, self._is_draft = (self.look.glyphs, is_kept), False
        self._shape = graph_shape(self.world, self._graph, self.look.glyphs, is_kept=is_kept)
        self._list = EdgeList(self._shape, 0)

    def signs(self) -> Legend:
        """List the signs of states and edges."""
        palette, greedy = self.look.palette, self.policy_shown
        if self._is_draft or not self._graph.chain:
            policy: Legend = (LegendSign("bold", greedy, palette.best),)
        else:
            has_choice = len(self.world.space.action_names) > 1
            policy = (LegendSign(self.look.glyphs.right, greedy, palette.strong),) if has_choice else ()
        unknown = "depends" if self.world.prospects else "hidden" if self._shape_of[1] else ""
        in_full = DEPENDS_IN_FULL if self.world.prospects else ""
        return (
            *self.valueless_signs(),
            *([LegendSign(DEPENDS, unknown, palette.text, in_full)] if unknown else ()),
            *policy,
            *self.missing_table_signs(),
            self.agent_sign(),
        )

    def moved(self, place: int, rows: int, columns: int) -> int:
        """Return the nearest state that way."""
        if self._layout is None:
            listed = sorted(
                {action.source for action in self._shape.actions if self._has(action.source)} | {place}
            )
            return listed[max(0, min(listed.index(place) + rows + columns, len(listed) - 1))]
        here, there = self._shape.nodes[place], {}
        for state, node in enumerate(self._shape.nodes):
            right, down = node.column - here.column, node.row - here.row
            ahead, aside = rows * down + columns * right, abs(rows * right) + abs(columns * down)
            if ahead > 0 and self._has(state):
                there[state] = ahead + 2 * aside
        return min(there, key=there.__getitem__, default=place)

    def place_at(self, x: int, y: int) -> int | None:
        """Return the state whose box or edge is here."""
        if self._layout is not None:
            boxes = enumerate(self._layout.boxes)
            places = (state for state, box in boxes if (x, y) in set(box.cells()))
        else:
            places = (line.state for line in self._list.lines[self._top + y :][:1])
        return next(filter(self._has, places), None)

    def _has(self, place: int) -> bool:
        return place < self.world.space.states

    def keep_in_view(self, place: int) -> None:
        """Scroll to the edges of a state."""
        lines = [number for number, line in enumerate(self._list.lines) if line.state == place]
        if lines:
            self._top = scrolled_to(scrolled_to(self._top, lines[-1], self._height), lines[0], self._height)

    @property
    def stance(self) -> object:
        """The cursor and the first visible edge."""
        return self.cursor, self._top

    def align_with(self, twin: BoardPanel) -> None:
        """Take the stance of ``twin``."""
        super().align_with(twin)
        if isinstance(twin, GraphView):
            self._top = twin._top if self.takes_stance_of(twin) else self._top

    def pan(self, rows: int, columns: int) -> None:
        """Scroll the list."""
        self._top += rows

    def follow(self) -> None:
        """Scroll to the first edge."""
        self._top = 0


def _block_room(layout: GraphLayout, look: Look) -> int:
    width, height = min(box.width for box in layout.boxes) - 2, layout.boxes[0].height
    has_blocks = width >= _LEAST_BLOCK[0] and height >= _LEAST_BLOCK[1] and look.glyphs.braille
    return (width + 3) // 4 if has_blocks else 0


def _draw_graph(
    canvas: Canvas,
    shape: GraphShape,
    layout: GraphLayout,
    scene: GraphScene,
    exact: Sequence[float] | None,
    look: Look,
) -> None:
    (values, form, signs), palette, glyphs = scene, look.palette, look.glyphs
    texts = [values.text(state, form, look) for state in range(len(shape.nodes))]
    has_blocks = _block_room(layout, look) > 0
    for state, (node, box) in enumerate(zip(shape.nodes, layout.boxes, strict=True)):
        below = ""
        has_exact = has_blocks and box.height > _LEAST_BLOCK[1] and not node.terminal
        if has_exact and exact is not None and state < len(exact):
            below = f"exact {form.text(exact[state], look.glyphs)}"
        number = _digits(texts[state], box.width - 2) if has_blocks else ()
        value = (*(number or (texts[state] or END,)), *filter(None, [below]))
        _draw_box(canvas, box, node, value, state, scene, look)
    greedy, stops = shape.marked(values.greedy), shape.marked(signs.breakpoints.pairs)
    about = shape.marked(set(signs.subject))
    _draw_lines(canvas, layout, greedy, scene, look)
    for fork in layout.forks:
        canvas.put(fork.x, fork.y, glyphs.estimate, _edge_style(fork.pair in greedy, look))
    heads = (glyphs.head_up, glyphs.head_right, glyphs.head_down, glyphs.head_left)
    for head in layout.heads:
        canvas.put(head.x, head.y, heads[head.direction], _edge_style(head.pair in greedy, look))
    for label in layout.labels:
        style = palette.best if label.pair in greedy else palette.text
        if label.pair in stops:
            style = palette.breakpoint
        if label.pair in about:
            style = palette.you
        canvas.put(label.x, label.y, label.text, style)
    for state, box in enumerate(layout.boxes):
        if state in signs.breakpoints.states:
            canvas.put(box.x + box.width - 1, box.y, glyphs.breakpoint, palette.breakpoint)
        edits = marks_of(signs.editor, state).signs(look)
        for y, mark in zip((box.y, box.y + box.height - 1), edits, strict=False):
            canvas.put(box.x, y, *mark)


def _digits(text: str, width: int) -> tuple[str, ...]:
    forms = ((text, width - 2), (text.removesuffix(".0"), width - 2), (text, width))
    drawn = ((block_number(form), room) for form, room in forms)
    return next((rows for rows, room in drawn if rows and len(rows[0]) <= room), ())


def _draw_box(
    canvas: Canvas, box: Box, node: Node, value: Sequence[str], state: int, scene: GraphScene, look: Look
) -> None:
    values, _, signs = scene
    glyphs, palette, agent = look.glyphs, look.palette, state == signs.agent
    background, inner, last = values.style(state, look), box.width - 2, box.y + box.height - 1
    if not _is_framed(state, scene, look):
        for y in range(box.y, last + 1):
            canvas.put(box.x, y, " " * box.width, background)
    else:
        if node.terminal:
            horizontal, vertical, *corners = tuple(glyphs.double_box)
        else:
            horizontal, vertical, *corners = glyphs.thin, glyphs.thin_vertical, *glyphs.round_corners
        border = _border_style(state, signs, look)
        canvas.put(box.x, box.y, corners[0] + horizontal * inner + corners[1], border)
        canvas.put(box.x, last, corners[2] + horizontal * inner + corners[3], border)
        for y in range(box.y + 1, last):
            canvas.put(box.x, y, vertical, border)
            canvas.put(box.x + 1, y, " " * inner, background)
            canvas.put(box.x + box.width - 1, y, vertical, border)
    first, text = box.y + 1 + (box.height - 3 - len(value)) // 2, value[0]
    name = shortened(node.name, inner - 1, glyphs.ellipsis)
    flag, is_full = values.flag(state, signs.differing, look), len(name) == inner - 1
    # the blank before a name that fills the box is for the agent, or else for the flag
    start = 0 if flag and is_full and not agent else max(1, (inner - len(name)) // 2)
    canvas.put(box.x + 1 + start, first, name, background + Style(bold=True))
    if agent:
        canvas.put(
            box.x + 1 + start - (2 if start > 1 else 1), first, glyphs.agent, background + palette.agent
        )
    style = palette.focus if state == signs.cursor else background
    flag_style = values.flag_style(state, background, look)
    if not (flag and is_full and agent):
        for y, line in enumerate(value, start=first + 1):
            canvas.put(box.x + 1, y, centred(line, inner), style)
        canvas.put(box.x + 1 + start + len(name), first, flag, flag_style)
    elif len(text) <= inner - 2:
        canvas.put(box.x + 1, first + 1, centred(text, inner - 2) + "  ", style)
        canvas.put(box.x + inner, first + 1, flag, flag_style)
    else:
        canvas.put(box.x + 1, first + 1, centred(text, inner), style)
        canvas.put(box.x, box.y, flag, background)


def _is_framed(state: int, scene: GraphScene, look: Look) -> bool:
    """Return whether a box needs a frame: it has no colour of its own, or an estimate comes from it."""
    return scene.values.style(state, look).bgcolor is None or state in scene.signs.next_states


def _border_style(state: int, signs: Signs, look: Look) -> Style:
    if state in signs.next_states:
        return look.palette.source_line
    return look.palette.strong if state == signs.agent else look.palette.text


def _edge_style(greedy: bool, look: Look) -> Style:
    return look.palette.best if greedy else look.palette.dim


def _draw_lines(canvas: Canvas, layout: GraphLayout, greedy: Set[int], scene: GraphScene, look: Look) -> None:
    arms: dict[tuple[int, int], StrokeArms] = {}
    styles: dict[tuple[int, int], Style] = {}
    for stroke in sorted(layout.strokes, key=lambda each: each.pair in greedy):
        cell, is_bold = (stroke.x, stroke.y), stroke.pair in greedy
        mine = StrokeArms(*((BOLD if is_bold else THIN) * (side in stroke.arms) for side in range(4)))
        arms[cell] = arms.get(cell, StrokeArms()).joined(mine)
        styles[cell] = _edge_style(is_bold, look)
    for state, box in enumerate(layout.boxes):
        is_framed = _is_framed(state, scene, look)
        for cell in arms.keys() & set(box.cells()):
            if not is_framed:
                del arms[cell]
                continue
            # a line starts in a border, which continues in its own style
            on_side = cell[0] in (box.x, box.x + box.width - 1)
            border = StrokeArms(up=THIN, down=THIN) if on_side else StrokeArms(right=THIN, left=THIN)
            arms[cell] = arms[cell].joined(border)
            styles[cell] = _border_style(state, scene.signs, look)
    for (x, y), each in arms.items():
        canvas.put(x, y, joint(each, look.glyphs), styles[x, y])


class StrokeArms(NamedTuple):
    """Weights of the lines from a cell: 0, THIN or BOLD."""

    up: int = 0
    right: int = 0
    down: int = 0
    left: int = 0

    def joined(self, other: StrokeArms) -> StrokeArms:
        """Combine two lines in one cell."""
        return StrokeArms(*(max(mine, its) for mine, its in zip(self, other, strict=True)))


def joint(arms: StrokeArms, glyphs: Glyphs) -> str:
    """Return the character for ``arms``."""
    if glyphs.name == "ascii":
        return _ascii(arms, glyphs)
    character = _JOINTS[arms.up + 3 * arms.right + 9 * arms.down + 27 * arms.left]
    return _ROUNDED.get(character, character)


def _ascii(arms: StrokeArms, glyphs: Glyphs) -> str:
    if not any(arms):
        return " "
    vertical, horizontal = max(arms.up, arms.down), max(arms.left, arms.right)
    if not horizontal:
        return glyphs.bold_vertical if vertical == BOLD else glyphs.thin_vertical
    if not vertical:
        return glyphs.bold if horizontal == BOLD else glyphs.thin
    return "+"
