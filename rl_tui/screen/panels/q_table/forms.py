"""A Q-table as a matrix, or as a list."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Final

import numpy as np
from rich.cells import cell_len
from rich.segment import Segment

from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.kit.layers import EXACT_LAYERS, Layer
from rl_tui.screen.panels.q_table.layers import LEARNED_NOT
from rl_tui.screen.panels.q_table.world import NO_ROW, Pieces, Scene, aligned_right, boxed, framed, padded

# The matrix, in several blocks if useful


LEAST_FIELD: Final = 3  # .54
FIELD_WITH_SIGN: Final = 4
MOST_FIELD: Final = 9
MOST_DIGITS: Final = 6
_MARKS: Final = 2
_GAP: Final = 1
_AROUND_LABEL: Final = 2  # the agent's mark before it, a blank after it


@dataclass(frozen=True, slots=True)
class MatrixForm:
    """A matrix with ``field`` cells per number, ``label`` per name."""

    scene: Scene
    blocks: int
    field: int
    label: int
    gap: int = _GAP

    @property
    def _column(self) -> int:
        return self.field + _MARKS + self.gap

    @property
    def block_width(self) -> int:
        """The cells of a block."""
        return self.label + _AROUND_LABEL + len(self.scene.world.action_names) * self._column

    @property
    def entries(self) -> int:
        """The number of live states."""
        return len(self.scene.world.live)

    def heads(self) -> list[Pieces]:
        """Return the action names, maybe in two rows."""
        names = [self.scene.world.action_names[action] for action in self.scene.world.shown_actions]
        if not any(" " in name and cell_len(name) > self.field + _MARKS for name in names):
            return [self._heads(names)]
        parts = [name.rpartition(" ") for name in names]
        above = self._heads([first for first, _, _ in parts])
        return [above, self._heads([last for _, _, last in parts], names_states=False)]

    def _heads(self, names: Sequence[str], *, names_states: bool = True) -> Pieces:
        width, ellipsis = self.field + _MARKS, self.scene.look.glyphs.ellipsis
        text = " " * (self.label + _AROUND_LABEL)
        for name, following in zip(names, (*names[1:], ""), strict=True):
            # a head may extend into the gap if no other name starts right after it
            reach = self._column if cell_len(following) < width - 1 else width
            head = shortened(name, reach, ellipsis)
            text += padded(" " * ((width - cell_len(head)) // 2) + head, self._column)
        room = len(text) - len(text.lstrip()) - _AROUND_LABEL - 1
        name_head = self.scene.world.name_head(room) if names_states else ""
        text = f" {name_head}{text[1 + len(name_head) :]}"
        return [Segment(text, self.scene.look.palette.dim)]

    def entry(self, entry: int, is_first: bool) -> Pieces:
        """Return a state's row."""
        scene, world, shown = self.scene, self.scene.world, self.scene.shown
        palette = scene.look.palette
        state = int(world.live[entry])
        pairs = world.space.pairs_of(state)
        here = state == scene.snapshot.counters.state
        name = aligned_right(world.state_name(state, self.label), self.label)
        style = palette.strong if here else palette.dim
        pieces = [
            scene.state_mark(state),
            Segment(name, palette.focus if scene.is_pointed(pairs) else style),
            scene.mark_behind(state) or Segment(" ", style),
        ]
        greedy = shown.framed(pairs)
        digits = min(self.field, MOST_DIGITS)
        blank, gap = Segment(" " * self._column, palette.text), Segment(" " * self.gap, palette.text)
        pair_of = world.pair_of_action(state)
        for action in world.shown_actions:
            pair = pair_of.get(action)
            if pair is None:
                pieces.append(blank)
                continue
            pieces += boxed(scene, shown, pair, self.field, digits, pair in greedy)
            pieces += [gap] * self.gap
        return pieces

    def pairs_in(self, entry: int) -> range:
        """Return the state's pairs."""
        return self.scene.world.space.pairs_of(int(self.scene.world.live[entry]))

    def entry_of(self, state: int) -> int:
        """Return the row of ``state``."""
        return self.scene.world.row_of(state)

    def entry_of_pair(self, pair: int) -> int:
        """Return the pair's row."""
        return self.scene.world.row_of(self.scene.world.space.state_of(pair))

    def moved(self, pair: int, rows: int, columns: int) -> int:
        """Return the nearest pair that far away."""
        world, state = self.scene.world, self.scene.world.space.state_of(pair)
        if rows:
            row = max(0, min(self.entries - 1, world.row_of(state) + rows))
            return world.pair_near(int(world.live[row]), world.action_of(pair))
        pairs = world.pairs_shown(state)
        return pairs[max(0, min(len(pairs) - 1, pairs.index(pair) + columns))]

    def pair_at(self, entry: int, x: int) -> int | None:
        """Return the pair here, or None."""
        column = (x - self.label - _AROUND_LABEL) // self._column
        if not 0 <= column < len(self.scene.world.shown_actions):
            return None
        pair_of = self.scene.world.pair_of_action(int(self.scene.world.live[entry]))
        return pair_of.get(self.scene.world.shown_actions[column])


def matrix_form(scene: Scene, width: int, lines: int) -> MatrixForm | None:
    """Return the form if it fits. Several blocks are used only to avoid scrolling."""
    needed = -(-len(scene.world.live) // max(1, lines))
    if needed > 1:
        least = LEAST_FIELD if _fits_narrow(scene) else FIELD_WITH_SIGN
        if (form := _form(scene, needed, width, least, scene.world.state_width)) is not None:
            return form
        width -= 2  # the scroll bar, apart from the marks of the last column
    least = LEAST_FIELD if min(scene.shown.low, scene.world.least_reward) > -99.5 else FIELD_WITH_SIGN
    labels = scene.world.state_width, scene.world.brief_width
    forms = (_form(scene, 1, width, least, label, gap) for gap in (_GAP, 0) for label in labels)
    return next(filter(None, forms), None)


def _form(
    scene: Scene, blocks: int, width: int, least: int, label: int, gap: int = _GAP
) -> MatrixForm | None:
    actions = len(scene.world.action_names)
    field = (width // blocks - label - _AROUND_LABEL) // actions - _MARKS - gap
    return MatrixForm(scene, blocks, min(MOST_FIELD, field), label, gap) if field >= least else None


def _fits_narrow(scene: Scene) -> bool:
    figures = scene.shown
    if figures.layer not in (Layer.Q, *LEARNED_NOT) or scene.world.least_reward < 0.0:
        return False
    return figures.low >= 0.0 and len(numbers.fixed(figures.high, 1)) <= LEAST_FIELD


# The list


DIGITS: Final = 6
BOX: Final = DIGITS + 2
COUNT: Final = 8
LEAST_BAR: Final = 6
MOST_BAR: Final = 20
NOT_TRIED: Final = "not tried"
_LEAST_NAME: Final = 3
_STATE_GAP: Final = 2
_LEAST_GAP: Final = 1
_ARM_HEADS: Final = {Layer.OPTIMAL: "q*", Layer.ERROR: "Q−q*"}

Draw = Callable[[int, bool], Pieces]


@dataclass(frozen=True, slots=True)
class Column:
    """A column. High ``rank`` is dropped first. ``draw`` takes the pair, and whether to name its state."""

    head: str
    width: int
    rank: int
    draw: Draw
    align: Callable[[str, int], str] = padded


@dataclass(frozen=True, slots=True)
class ListForm:
    """A list with one row per pair."""

    scene: Scene
    columns: tuple[Column, ...]
    blocks: ClassVar[int] = 1  # blocks side by side

    @property
    def block_width(self) -> int:
        """The columns' total width."""
        return sum(column.width for column in self.columns)

    @property
    def entries(self) -> int:
        """The number of pairs."""
        return self.scene.world.space.pairs

    def heads(self) -> list[Pieces]:
        """Return the headings above their columns."""
        glyphs = self.scene.look.glyphs
        texts = [column.align(glyphs.spelled(column.head), column.width) for column in self.columns]
        return [[Segment("".join(texts), self.scene.look.palette.dim)]]

    def entry(self, entry: int, is_first: bool) -> Pieces:
        """Return a pair's row."""
        world, pair = self.scene.world, self._pair_of(entry)
        is_new = is_first or entry == world.siblings(pair).start
        return [segment for column in self.columns for segment in column.draw(pair, is_new)]

    def pairs_in(self, entry: int) -> range:
        """Return all pairs of the row's state."""
        return self.scene.world.siblings(entry)

    def entry_of(self, state: int) -> int:
        """Return the row of the first pair."""
        first, end = self.scene.world.space.first_pair[state : state + 2].tolist()
        return first if first < end else NO_ROW

    def entry_of_pair(self, pair: int) -> int:
        """Return the pair's row."""
        world = self.scene.world
        return world.siblings(pair).start + world.pairs_shown(world.space.state_of(pair)).index(pair)

    def moved(self, pair: int, rows: int, columns: int) -> int:
        """Return the pair ``rows`` below."""
        return self._pair_of(max(0, min(self.entries - 1, self.entry_of_pair(pair) + rows)))

    def pair_at(self, entry: int, x: int) -> int | None:
        """Return the row's pair."""
        return self._pair_of(entry)

    def _pair_of(self, entry: int) -> int:
        world = self.scene.world
        state = world.space.state_of(entry)  # a state has equally many rows and pairs, in the same place
        return world.pairs_shown(state)[entry - world.siblings(entry).start]


def list_form(scene: Scene, width: int) -> ListForm:
    """Return the form with the current layer."""
    columns = _arm_columns(scene, width) if scene.snapshot.world.is_bandit else _pair_columns(scene, width)
    while columns and sum(column.width for column in columns) > width:
        columns.remove(max(columns, key=lambda column: column.rank))
    return ListForm(scene, tuple(columns))


def greedy_line(scene: Scene) -> str:
    """Write all greedy actions, ties joined by ``=``."""
    world = scene.world
    states = []
    for state in world.live.tolist():
        greedy = scene.shown.greedy(world.space.pairs_of(state))
        shown = [pair for pair in world.pairs_shown(state) if pair in greedy]
        states.append("=".join(world.action_names[world.action_of(pair)] for pair in shown) or NOT_TRIED)
    known = any(state != NOT_TRIED for state in states)
    what = "likeliest" if scene.shown.layer is Layer.POLICY else "greedy"
    return f"{what}: {' · '.join(states)}" if known else ""


def _pair_columns(scene: Scene, width: int) -> list[Column]:
    world, look = scene.world, scene.look
    around = 1 + _STATE_GAP + 1 + COUNT
    natural = world.state_width + world.action_width
    values = _beside(scene.shown.layer)
    if width < around + natural + BOX * len(values):
        values = [Layer.Q if scene.shown.layer is Layer.VISITS else scene.shown.layer]
    room = width - around - BOX * len(values)
    gap = _STATE_GAP
    if room < natural:  # names matter more than the first column to drop
        room += BOX if scene.shown.layer is Layer.VISITS else COUNT
    if room < natural:
        gap, room = _LEAST_GAP, room + _STATE_GAP - _LEAST_GAP
    end = 1
    if room < world.brief_width + world.action_width:  # the frame of a value separates it too
        end, room = 0, room + 1
    state, action = _shared(world.state_width, world.action_width, room)
    # heads may extend over gaps, and columns grow to fit them if there is space
    state += _widening(len("state") - gap + 1 - state, room - state - action)
    action += _widening(len("action") - action, room - state - action)

    def mark(pair: int, is_new: bool) -> Pieces:
        return [scene.state_mark(world.space.state_of(pair)) if is_new else Segment(" ", look.palette.text)]

    def state_name(pair: int, is_new: bool) -> Pieces:
        name = world.state_name(world.space.state_of(pair), state) if is_new else ""
        pointed = bool(name) and scene.is_pointed(world.siblings(pair))
        style = look.palette.focus if pointed else look.palette.strong
        blank = padded("", state + gap - cell_len(name))
        differs = scene.mark_behind(world.space.state_of(pair)) if name else None
        if differs is None:
            return [Segment(name, style), Segment(blank, look.palette.text)]
        return [Segment(name, style), differs, Segment(blank[1:], look.palette.text)]

    def action_name(pair: int, _: bool) -> Pieces:
        name = shortened(world.action_names[world.action_of(pair)], action, look.glyphs.ellipsis)
        return [Segment(padded(name, action + end), look.palette.text)]

    action_head = next((head for head in ("action", "act") if len(head) <= action + end), "a")
    return [
        Column("", 1, 1, mark),
        Column(
            world.name_head(state + gap - 1) or shortened("state", state + gap - 1, ""),
            *(state + gap, 2, state_name),
        ),
        Column(action_head, action + end, 1, action_name),
        *_value_columns(scene, values),
        _count_column(scene),
    ]


def _arm_columns(scene: Scene, width: int) -> list[Column]:
    world, look = scene.world, scene.look
    label = max(len("arm"), world.action_width)
    exact = _compared(scene)
    if width < label + 2 + 3 * BOX + COUNT + LEAST_BAR:
        in_force = scene.shown.layer if scene.shown.layer in (Layer.ERROR, Layer.LANES) else Layer.OPTIMAL
        exact = [layer for layer in exact if layer is in_force]

    pulled = scene.snapshot.counters.last_step

    def last(pair: int, _: bool) -> Pieces:
        is_last = pulled is not None and pair == pulled.pair
        return [
            Segment(look.glyphs.agent, look.palette.agent) if is_last else Segment(" ", look.palette.text)
        ]

    def arm(pair: int, _: bool) -> Pieces:
        name = aligned_right(world.action_names[world.action_of(pair)], label)
        style = look.palette.focus if pair in scene.pointed else look.palette.text
        return [Segment(name, style), Segment(" ", look.palette.text)]

    columns = [
        Column("", 1, 1, last),
        Column("arm", label + 1, 1, arm, _right),
        *_value_columns(scene, [Layer.Q, *exact]),
        _count_column(scene),
    ]
    room = width - sum(column.width for column in columns)
    return [*columns, _share_column(scene, room)] if room >= LEAST_BAR else columns


def _compared(scene: Scene) -> list[Layer]:
    compared = (*EXACT_LAYERS, Layer.LANES) if scene.shown.layer is Layer.LANES else EXACT_LAYERS
    return [layer for layer in compared if layer in scene.figures]


def _beside(layer: Layer) -> list[Layer]:
    if layer is Layer.ERROR:
        return [Layer.Q, Layer.OPTIMAL, layer]
    return [Layer.Q, layer] if layer in (Layer.OPTIMAL, Layer.LANES, Layer.POLICY) else [Layer.Q]


def _shared(first: int, second: int, room: int) -> tuple[int, int]:
    while first + second > room and max(first, second) > _LEAST_NAME:
        if first > second:
            first -= 1
        else:
            second -= 1
    return first, second


def _widening(wanted: int, room: int) -> int:
    return wanted if 0 < wanted <= room else 0


def _value_columns(scene: Scene, layers: Sequence[Layer]) -> list[Column]:
    _share_form(scene, layers)
    in_force = scene.shown.layer
    main = in_force if in_force in LEARNED_NOT and in_force in layers else layers[0]
    counts = in_force is Layer.VISITS
    shown = replace(scene, cursor=None) if counts else scene
    columns = []
    for layer in layers:
        head = _ARM_HEADS.get(layer, layer) if scene.snapshot.world.is_bandit else layer
        is_main = layer is main
        rank = (3 if counts else 0) if is_main else 2
        columns.append(Column(head, BOX, rank, _value(shown, layer, is_main, has_frames=not counts), _right))
    return columns


def _share_form(scene: Scene, layers: Sequence[Layer]) -> None:
    compared = [scene.figures[layer] for layer in layers]
    numbers = np.concatenate([each.numbers for each in compared])
    form = scene.forms.form((*layers, DIGITS), numbers, DIGITS)
    for each in compared:
        each.share_form(DIGITS, form)


def _value(scene: Scene, layer: Layer, is_main: bool, has_frames: bool) -> Draw:
    figures, world = scene.figures[layer], scene.world

    def draw(pair: int, _: bool) -> Pieces:
        if is_main or layer is scene.shown.layer:
            is_framed = is_main and has_frames and pair in figures.framed(world.siblings(pair))
            return boxed(scene, figures, pair, DIGITS, DIGITS, is_framed)
        return [Segment(_right(figures.text(pair, DIGITS), BOX), figures.style(pair, is_tinted=False))]

    return draw


def _count_column(scene: Scene) -> Column:
    figures, world, text = scene.figures[Layer.VISITS], scene.world, scene.look.palette.text
    is_shown = scene.shown.layer is Layer.VISITS

    def draw(pair: int, _: bool) -> Pieces:
        number = figures.text(pair, COUNT - 2).rjust(COUNT - 2)
        if is_shown:
            return framed(scene, figures, pair, number, pair in figures.framed(world.siblings(pair)))
        return [Segment(" ", text), Segment(number, figures.style(pair, is_tinted=False)), Segment(" ", text)]

    return Column("N", COUNT, 0 if is_shown else 3, draw, _right)


def _share_column(scene: Scene, width: int) -> Column:
    bar, figures, look = min(MOST_BAR, width - 2), scene.figures[Layer.VISITS], scene.look

    def draw(pair: int, _: bool) -> Pieces:
        text = " " + look.glyphs.bar * round(bar * figures.share(pair))
        return [Segment(padded(text, width), look.palette.dim)]

    return Column(" share", width, 4, draw)


def _right(text: str, width: int) -> str:
    return f"{aligned_right(text, width - 1)} "
