"""The contents of map cells at one moment."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from enum import Enum, auto
from functools import cached_property
from typing import Any, Final, NamedTuple

import numpy as np

from rl_tui.live.snapshot import Snapshot
from rl_tui.live.viewport import NO_STATE, first_state_of_cells, pairs_of_states
from rl_tui.screen.draw.action_order import order_of
from rl_tui.screen.draw.block_signs import Direction, Sign
from rl_tui.screen.draw.names import is_word
from rl_tui.screen.panels.grid.action_form import ActionKinds, action_kinds
from rl_tui.screen.panels.grid.draft_cells import DraftCell, draft_cells
from rl_tui.screen.panels.grid.marks import CellReward, cell_rewards
from rl_tui.screen.panels.grid.trail import Trace, traces
from rl_tui.screen.panels.world.edit_marks import UNMARKED, EditMarks, marks_of
from rl_tui.screen.panels.world.shown_policy import AT_RANDOM, drawn_actions, is_off_way
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.editing.grid_draft import GridDraft
from rl_tui.worlds.mdp.space import FiniteSpace, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def unreached_cells(space: FiniteSpace, grid: Grid) -> frozenset[int]:
    """Return unreachable cells, except cliffs, which put the agent back at once.

    Empty without a transition table.
    """
    if not isinstance(space, TabularMDP):
        return frozenset()
    # states that cannot be reached have no pairs, so they lead nowhere
    reached = np.diff(space.first_pair) > 0
    reached[space.next_state] = True
    reached[space.start_state] = True
    cells = np.array(grid.cell_of_state, dtype=np.int64)
    missed = set(cells[~reached].tolist())
    if missed:
        missed -= set(cells[reached].tolist())
    return frozenset(cell for cell in missed if grid.kinds[cell] is not CellKind.CLIFF)


# Cells after rows or columns change


def carried_place(place: int, before: Snapshot, now: Snapshot) -> tuple[int, int, int]:
    """Return where ``place`` is now, and its shift down and right. Deleted lines keep their number."""
    was, grid = before.world.drawing, now.world.drawing
    assert isinstance(was, Grid)
    assert isinstance(grid, Grid)
    was_row, was_column = row, column = divmod(place, was.columns)
    old, new = before.editor.base, now.editor.base
    if isinstance(old, GridDraft) and isinstance(new, GridDraft):
        row = _line(row, old.row_ids, new.row_ids)
        column = _line(column, old.column_ids, new.column_ids)
    row, column = min(row, grid.rows - 1), min(column, grid.columns - 1)
    return row * grid.columns + column, row - was_row, column - was_column


def _line(line: int, old: tuple[int, ...], new: tuple[int, ...]) -> int:
    wanted = old[line] if line < len(old) else None
    return new.index(wanted) if wanted in new else line


# The cells


_MOST_WALLS: Final = 0.45  # share of the map: more walls look like its surroundings


class MapPart(NamedTuple):
    """``rows`` × ``columns`` cells from (``top``, ``left``) on."""

    top: int
    left: int
    rows: int
    columns: int


class ActionValue(NamedTuple):
    """Direction or first letter, and Q. ``is_new``: never updated."""

    sign: Sign
    q: float
    is_new: bool
    is_greedy: bool


class Wall(Enum):
    """A slab, one lit from above, or like the page."""

    SLAB = auto()
    LIT = auto()
    PAGE = auto()


class CellExtra(NamedTuple):
    """Rare contents, in one object because every field costs time per frame.

    ``name``: padded to the longest. ``is_off_way``: without a drawn action, and never reached. ``draft``: not
    active. ``way``: the only exit. ``has_turned``: the last step changed its arrows. ``edges``: walls at the
    left and right. ``hatch``: a cliff's row and column, modulo ``HATCH``.
    """

    trace: Trace = Trace()
    is_reached: bool = True
    name: str = ""
    is_off_way: bool = False
    marks: EditMarks = UNMARKED
    draft: DraftCell | None = None
    way: Direction | None = None
    wall: Wall = Wall.SLAB
    has_turned: bool = False
    edges: tuple[bool, bool] = (False, False)
    hatch: tuple[int, int] = (0, 0)


HATCH: Final = 3
"""The columns between the strokes of a cliff, which continue from cell to cell."""
PLAIN: Final = CellExtra()
PUSHES: Final[Mapping[str, Sign]] = {"left": (0, -1), "right": (0, 1)}
"""Arrows for actions on a body."""
_FAR: Final = 3  # cells, more than a step or a strong wind covers
_UNREACHED: Final = CellExtra(is_reached=False)


class CellContent(NamedTuple):
    """One cell.

    ``value``: V(s) = max over a of Q(s, a), or None. ``greedy``: all greedy actions, empty if all are equal
    or unknown. ``lead``: advantage of a single one over the second best. Policy iteration and drawn policies
    replace these by their own. ``reward``: if unusual. ``differs``: the second run has other greedy actions.
    """

    kind: CellKind
    agent: bool
    value: float | None = None
    known: bool = False
    greedy: tuple[Sign, ...] = ()
    lead: float = math.inf
    reward: CellReward | None = None
    stops: bool = False
    cursor: bool = False
    differs: bool = False
    actions: tuple[ActionValue, ...] = ()
    extra: CellExtra | None = None


def with_extra(content: CellContent, **more: Any) -> CellContent:
    """Add rare contents."""
    return content._replace(extra=(content.extra or PLAIN)._replace(**more))


def _walls(grid: Grid) -> dict[int, CellExtra]:
    cells = [cell for cell, kind in enumerate(grid.kinds) if kind is CellKind.WALL]
    if grid.legend or len(cells) > _MOST_WALLS * len(grid.kinds):
        return dict.fromkeys(cells, CellExtra(wall=Wall.PAGE))
    walls, lit = set(cells), CellExtra(wall=Wall.LIT)
    return {cell: lit for cell in cells if cell - grid.columns not in walls}


class GridMap:
    """A map and its states. Reading a part takes equally long on any map.

    ``ends``: names of terminal kinds. ``ways``: signs of single exits.
    """

    def __init__(self, space: FiniteSpace, grid: Grid) -> None:
        self.grid = grid
        self._space = space
        pushes = {} if grid.body is None else PUSHES
        self.signs = tuple(
            pushes.get(name, name[:1] or "?") if step is None else step
            for step, name in zip(grid.directions, space.action_names, strict=True)
        )
        self.action_names = space.action_names
        self._order = order_of(space, grid)
        self._sign_places = {self.signs[action]: place for place, action in enumerate(self._order)}
        self._states = first_state_of_cells(grid)
        self._rewards = cell_rewards(space, grid)
        self.rewards = tuple(sorted(set(self._rewards.values()), reverse=True))
        acting = np.append(np.diff(space.first_pair) > 0, False)  # NO_STATE is the last one
        idle = np.flatnonzero(~acting[self._states.ravel()])
        self.unreached = unreached_cells(space, grid)
        self.ways = dict(grid.one_way)
        self._edges = {
            cell: (cell - 1 in grid.walls, cell in grid.walls)
            for wall in grid.walls
            for cell in (wall, wall + 1)
        }
        self._walls = _walls(grid)
        self._exits = self._exit_kinds()
        self.ends = dict.fromkeys(self._exits.values(), "exit")
        for cell in idle.tolist():
            kind = grid.kinds[cell]
            self.ends[kind] = str(kind) if kind in self.ends else self._end_name(cell)

    def _exit_kinds(self) -> dict[int, CellKind]:
        found = {}
        for cell, reward in self._rewards.items():
            own = self._space.pairs_of(int(self._states[divmod(cell, self.grid.columns)]))
            if len(own) == 1 and isinstance(self.signs[self._space.pair_action[own.start]], str):
                found[cell] = CellKind.GOAL if reward.reward > 0.0 else CellKind.HOLE
        return found

    def _end_name(self, cell: int) -> str:
        state = self._states[divmod(cell, self.grid.columns)]
        name = "" if state == NO_STATE else self._space.state_names[state]
        return name if is_word(name) else str(self.grid.kinds[cell])

    @cached_property
    def actions_beside_exits(self) -> frozenset[int]:
        """The actions of all cells but exits, which have signs of their own."""
        cells = np.asarray(self.grid.cell_of_state)[self._space.pair_state]
        return frozenset(self._space.pair_action[~np.isin(cells, list(self._exits))].tolist())

    @cached_property
    def action_kinds(self) -> ActionKinds:
        """The kinds of actions of all states."""
        return action_kinds(self._space, self.grid)

    def state_at(self, cell: int, snapshot: Snapshot | None) -> int | None:
        """Return the agent's or first state in ``cell``."""
        if snapshot is not None and self.grid.cell_of_state[snapshot.counters.state] == cell:
            return snapshot.counters.state
        state = int(self._states[divmod(cell, self.grid.columns)])
        return None if state == NO_STATE else state

    def cell_to_follow(self, snapshot: Snapshot) -> int:
        """Return the agent's cell, or where it acted last if its end is outside of the map."""
        grid, last = self.grid, snapshot.counters.last_step
        here = int(grid.cell_of_state[snapshot.counters.state])
        if last is None or last.planned or last.next_state != snapshot.counters.state:
            return here
        if self._space.pairs_of(snapshot.counters.state):
            return here
        (row, column), acted = divmod(here, grid.columns), int(grid.cell_of_state[last.state])
        distance = max(abs(acted // grid.columns - row), abs(acted % grid.columns - column))
        return acted if distance > _FAR else here

    def contents(
        self,
        part: MapPart,
        snapshot: Snapshot,
        cursor: int | None = None,
        differing: frozenset[int] = frozenset(),
        *,
        with_actions: bool = False,
        named: bool = False,
        picked: frozenset[int] = frozenset(),
        traced: Mapping[int, Trace] | None = None,
    ) -> list[CellContent]:
        """Return the contents of ``part`` by rows. Of several states the agent's is shown, else the first."""
        kinds, columns = self.grid.kinds, self.grid.columns
        states = self._states_in(part, snapshot)
        owners = states[states != NO_STATE]
        pairs = pairs_of_states(self._space, owners)
        counts = np.zeros(len(states), dtype=np.int64)
        counts[states != NO_STATE] = self._space.first_pair[owners + 1] - self._space.first_pair[owners]
        held = None if snapshot.agent.part is None else snapshot.agent.part.held[pairs].tolist()
        q, visits = snapshot.agent.q[pairs].tolist(), snapshot.agent.visits[pairs].tolist()
        policy = snapshot.agent.policy[pairs].tolist() if len(snapshot.agent.policy) else None
        values = snapshot.agent.values[states].tolist() if policy else []
        actions = self._space.pair_action[pairs].tolist()
        signs = [self.signs[action] for action in actions]
        agent = self._place(part, int(self.grid.cell_of_state[snapshot.counters.state]))
        drawn = drawn_actions(snapshot)
        contents, first = [], 0
        for place, count in enumerate(counts.tolist()):
            row, column = divmod(place, part.columns)
            cell = (part.top + row) * columns + part.left + column
            kind = kinds[cell]
            last = first + count
            if cell in self._exits and not with_actions:
                contents.append(CellContent(self._exits[cell], place == agent, reward=self._rewards[cell]))
            elif count == 0 or (held is not None and not held[first]):
                extra = _UNREACHED if cell in self.unreached else self._walls.get(cell)
                contents.append(CellContent(kind, place == agent, extra=extra))
            else:
                content = self._content(
                    kind, place == agent, q[first:last], visits[first:last], signs[first:last]
                )
                if policy:
                    content = self._kept(content, values[place], policy[first:last], signs[first:last])
                if with_actions:
                    own = q[first:last], visits[first:last], actions[first:last]
                    content = content._replace(actions=self._actions(*own, content.known))
                if drawn is not None:
                    content = self._drawn(content, drawn.get(int(states[place])), signs[first:last])
                    if content.greedy == (AT_RANDOM,) and is_off_way(snapshot, int(states[place])):
                        content = with_extra(content, is_off_way=True)
                if cell in self.ways:
                    content = with_extra(content, way=self.ways[cell])
                if cell in self._edges:
                    content = with_extra(content, edges=self._edges[cell])
                reward = self._rewards.get(cell)
                contents.append(content if reward is None else content._replace(reward=reward))
            if kind is CellKind.CLIFF:
                down, right = divmod(cell, columns)
                contents[-1] = with_extra(contents[-1], hatch=(down % HATCH, right % HATCH))
            first = last
        if named:
            names = [self._space.state_names[each] for each in owners.tolist()]
            width = max(map(len, names), default=0)
            for place, name in zip(np.flatnonzero(states != NO_STATE).tolist(), names, strict=True):
                contents[place] = with_extra(contents[place], name=name.rjust(width))
        for place, state in enumerate(states.tolist() if differing else ()):
            if state in differing:
                contents[place] = contents[place]._replace(differs=True)
        for cell, trace in (traces(snapshot, self.grid) if traced is None else traced).items():
            marked = self._place(part, cell)
            if marked is not None:
                contents[marked] = with_extra(contents[marked], trace=trace)
        editor = snapshot.editor
        for place, state in enumerate(states.tolist() if editor.turned or editor.endless else ()):
            if (marks := marks_of(editor, state)) != UNMARKED:
                contents[place] = with_extra(contents[place], marks=marks)
        for cell, draft in draft_cells(editor, self.grid, part).items():
            drawn_at = self._place(part, cell)
            if drawn_at is not None:
                extra = CellExtra(draft=draft)
                contents[drawn_at] = CellContent(draft.kind, contents[drawn_at].agent, extra=extra)
        self._mark(contents, part, snapshot, picked if cursor is None else picked | {cursor})
        return contents

    def _mark(
        self, contents: list[CellContent], part: MapPart, snapshot: Snapshot, cursors: frozenset[int]
    ) -> None:
        for state in snapshot.playback.breakpoints.states:
            marked = self._place(part, int(self.grid.cell_of_state[state]))
            if marked is not None:
                contents[marked] = contents[marked]._replace(stops=True)
        for cell in cursors:
            marked = self._place(part, cell)
            if marked is not None:
                contents[marked] = contents[marked]._replace(cursor=True)

    def _actions(
        self, q: list[float], visits: list[int], actions: list[int], known: bool
    ) -> tuple[ActionValue, ...]:
        best = max(q) if known else None
        own = {
            action: ActionValue(self.signs[action], each, not taken, each == best)
            for action, each, taken in zip(actions, q, visits, strict=True)
        }
        return tuple(own[action] for action in self._order if action in own)

    def holds(self, part: MapPart, snapshot: Snapshot) -> bool:
        """Return whether ``snapshot`` has all data for ``part``."""
        if snapshot.agent.part is None:
            return True
        states = self._states_in(part, snapshot)
        pairs = pairs_of_states(self._space, states[states != NO_STATE])
        return bool(snapshot.agent.part.held[pairs].all())

    def _states_in(self, part: MapPart, snapshot: Snapshot) -> IntArray:
        top, left, rows, columns = part
        states = self._states[top : top + rows, left : left + columns].flatten()
        agent = self._place(part, int(self.grid.cell_of_state[snapshot.counters.state]))
        if agent is not None:
            states[agent] = snapshot.counters.state
        return states

    def _place(self, part: MapPart, cell: int) -> int | None:
        row, column = divmod(cell, self.grid.columns)
        row, column = row - part.top, column - part.left
        inside = 0 <= row < part.rows and 0 <= column < part.columns
        return row * part.columns + column if inside else None

    def _content(
        self, kind: CellKind, agent: bool, q: list[float], visits: list[int], signs: list[Sign]
    ) -> CellContent:
        value = max(q)
        known = min(q) != value or any(visits)
        if not known:
            return CellContent(kind, agent, value)
        greedy = [sign for sign, each in zip(signs, q, strict=True) if each == value]
        if len(greedy) == len(q) > 1:
            greedy = []
        lead = value - max(each for each in q if each != value) if len(greedy) == 1 < len(q) else math.inf
        return CellContent(kind, agent, value, known, self._in_order(greedy), lead)

    def _kept(
        self, content: CellContent, value: float, policy: list[float], signs: list[Sign]
    ) -> CellContent:
        taken = [sign for sign, chance in zip(signs, policy, strict=True) if chance > 0.0]
        is_told = content.known and len(taken) < max(2, len(signs))
        return content._replace(value=value, greedy=self._in_order(taken) if is_told else ())

    def _drawn(self, content: CellContent, action: int | None, signs: list[Sign]) -> CellContent:
        chosen = self.signs[action] if action is not None else signs[0] if len(signs) == 1 else AT_RANDOM
        actions = tuple(each._replace(is_greedy=each.sign == chosen) for each in content.actions)
        return content._replace(greedy=(chosen,), lead=math.inf, actions=actions)

    def _in_order(self, signs: Iterable[Sign]) -> tuple[Sign, ...]:
        return tuple(sorted(signs, key=self._sign_places.__getitem__))
