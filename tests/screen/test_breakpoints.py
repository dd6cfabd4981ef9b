"""The look of cursors and breakpoints."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from rich.style import Style
from sample_worlds import bandit_world
from samples import bandit, lake, look, student
from seams import sized
from snapshots import changed
from textual.strip import Strip

from rl_tui.live.pace.until import Breakpoints
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw.names import breakpoint_names
from rl_tui.screen.panels.arms import ArmsView
from rl_tui.screen.panels.graph.graph import GraphView
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.screen.panels.world.view import WorldView
from rl_tui.screen.panels.world_views import make_world_view
from rl_tui.screen.theme.look import Look

LOOK = look()
PALETTE = LOOK.palette


def stopping(snapshot: Snapshot, states: tuple[int, ...] = (), pairs: tuple[int, ...] = ()) -> Snapshot:
    return changed(snapshot, breakpoints=Breakpoints(frozenset(states), frozenset(pairs)))


def pointing(view: WorldView, place: int, snapshot: Snapshot) -> WorldView:
    view.snapshot = snapshot
    view.point_at(view.pairs_at(place))
    return view


def marks(strips: list[Strip], style: Style) -> list[tuple[int, int, str]]:
    found = []
    for row, strip in enumerate(strips):
        column = 0
        for segment in strip:
            if segment.style == style:
                found.append((row, column, segment.text))
            column += segment.cell_length
    return found


@pytest.mark.parametrize(
    ("size", "place"),
    [
        ((40, 8), (2, 28, "!")),  # two rows per cell: its upper right corner. State 6 is in row 1, column 2
        ((60, 12), (3, 40, "!")),
        ((20, 4), (1, 10, "!")),  # one row: in place of the mark
        ((12, 4), (1, 6, "!")),  # only arrows
    ],
)
def test_a_breakpoint_marks_its_cell_in_every_form(
    size: tuple[int, int], place: tuple[int, int, str]
) -> None:
    snapshot = stopping(lake(state=0), states=(6,))
    strips = GridView(snapshot.world, LOOK).picture(snapshot, *size)
    assert marks(strips, PALETTE.breakpoint) == [place]


def test_an_agent_on_a_breakpoint_is_seen_and_so_is_the_breakpoint() -> None:
    snapshot = stopping(lake(state=6), states=(6,))
    small = GridView(snapshot.world, LOOK).picture(snapshot, 20, 4)
    assert marks(small, PALETTE.breakpoint) == [(1, 10, "◉")]
    large = GridView(snapshot.world, LOOK).picture(snapshot, 40, 8)
    assert marks(large, PALETTE.breakpoint) == [(2, 28, "!")]
    assert "◉" in large[2].text


def test_holes_can_be_breakpoints_and_walls_can_have_the_cursor() -> None:
    snapshot = stopping(lake(), states=(5,))
    strips = GridView(snapshot.world, LOOK).picture(snapshot, 40, 8)
    assert marks(strips, PALETTE.breakpoint) == [(2, 18, "!")]
    view = GridView(snapshot.world, LOOK)
    view.put_cursor(15)
    view.has_focus = True
    assert [strip.text[30] + strip.text[39] for strip in view.picture(snapshot, 40, 8)[6:]] == ["▌▐", "▌▐"]


def test_the_cursor_lights_the_row_of_the_value_and_frames_the_cell() -> None:
    snapshot = lake()
    view = pointing(GridView(snapshot.world, LOOK), 10, snapshot)
    strips = view.picture(snapshot, 40, 8)
    ((row, column, text),) = marks(strips, PALETTE.focus)
    assert (row, column, len(text)) == (5, 21, 8)
    assert [strip.text[20] + strip.text[29] for strip in strips[4:6]] == ["▌▐", "▌▐"]
    assert text.strip().startswith(".")
    ((row, column, text),) = marks(view.picture(snapshot, 20, 4), PALETTE.focus)
    assert (row, column + text.index(".42")) == (2, 12)


def test_the_cursor_walks_over_cells_and_stops_at_the_edge() -> None:
    snapshot = lake(state=6)
    view = GridView(snapshot.world, LOOK)
    view.snapshot = snapshot
    view.action_move(0, 1)
    assert view.cursor == 7
    assert view.state_at(7) == 7
    for _ in range(3):
        view.action_move(1, 0)
    assert view.cursor == 15
    assert view.is_away
    view.action_follow()
    assert view.cursor is None
    assert view.cursor_place == 6


def test_a_click_finds_the_cell_the_box_and_the_arm() -> None:
    snapshot = lake()
    view: WorldView = GridView(snapshot.world, LOOK)
    view.picture(snapshot, 44, 9)
    assert [view.place_at(x, y) for x, y in ((0, 0), (9, 0), (10, 1), (39, 7), (40, 0), (3, 8))] == [
        0,
        0,
        1,
        15,
        None,
        None,
    ]
    graph = GraphView(student().world, LOOK)
    strips = graph.picture(student(), 60, 19)
    row = next(y for y, strip in enumerate(strips) if "Sleep" in strip.text)
    column = strips[row].text.index("Sleep")
    assert graph.place_at(column, row) == 3
    assert graph.place_at(0, 0) is None
    arms = ArmsView(bandit().world, LOOK)
    arms.picture(bandit(), 40, 10)
    assert [arms.place_at(5, y) for y in (0, 9)] == [0, 9]
    arms.picture(bandit(), 40, 21)
    assert [arms.place_at(5, y) for y in (0, 1, 2, 20)] == [0, 0, 1, None]


def test_the_cursor_goes_from_node_to_node_by_direction() -> None:
    """Class (0, 1), Phone (0, 0), Pass (1, 1), Sleep (2, 1)."""
    view = GraphView(student().world, LOOK)
    view.picture(student(), 60, 19)
    moves = {"up": (-1, 0), "down": (1, 0), "left": (0, -1), "right": (0, 1)}
    walked = [0]
    for step in ("up", "up", "right", "right", "right", "left", "left", "down"):
        walked.append(view.moved(walked[-1], *moves[step]))
    assert walked == [0, 1, 1, 2, 3, 3, 2, 0, 0]


def test_a_graph_marks_nodes_labels_and_cursor() -> None:
    snapshot = stopping(student(), states=(2, 3), pairs=(3,))
    view = pointing(GraphView(snapshot.world, LOOK), 1, snapshot)
    strips = view.picture(snapshot, 60, 19)
    marked = marks(strips, PALETTE.breakpoint)
    assert [text for *_, text in marked].count("!") == 2
    assert any(text.startswith("quit") for *_, text in marked)
    ((*_, value),) = marks(strips, PALETTE.focus)
    assert value.strip() == "5.71"


def test_a_list_of_edges_marks_them_too() -> None:
    snapshot = stopping(student(), states=(1,), pairs=(0,))
    view = pointing(GraphView(snapshot.world, LOOK), 2, snapshot)
    strips = view.picture(snapshot, 50, 6)
    assert [text for *_, text in marks(strips, PALETTE.breakpoint)] == ["!", "!"]
    assert [text for *_, text in marks(strips, PALETTE.focus)] == ["◉Pass"]
    view.keep_in_view(2)
    narrow = view.picture(snapshot, 50, 2)
    assert "Pass" in "".join(strip.text for strip in narrow)
    assert [view.moved(place, 1, 0) for place in (0, 1, 2)] == [1, 2, 2]


def test_arms_have_cursor_and_breakpoints() -> None:
    snapshot = stopping(bandit(500), pairs=(3,))
    view = pointing(ArmsView(snapshot.world, LOOK), 4, snapshot)
    strips = view.picture(snapshot, 40, 10)
    assert marks(strips, PALETTE.breakpoint) == [(3, 4, "!")]
    assert marks(strips, PALETTE.focus) == [(4, 3, "4")]
    assert view.agent_place(snapshot) == 5


def test_the_cursor_scrolls_the_arms() -> None:
    world = bandit_world(means=tuple(0.1 * arm for arm in range(50)))
    snapshot = changed(bandit(pulls=0), world=world, q=np.zeros(50), visits=np.zeros(50, dtype=np.int64))
    view = ArmsView(world, LOOK)
    view.snapshot = snapshot
    view.picture(snapshot, 40, 10)
    view.action_page(1, 0)
    assert view.cursor == 10
    view.picture(snapshot, 40, 10)
    assert view.footing == "↑↓ 2–11 of 50  −1…+1"
    view.action_page(-9, 0)
    view.picture(snapshot, 40, 10)
    assert (view.cursor, view.footing) == (0, "↑↓ 1–10 of 50  −1…+1")


def table_strips(snapshot: Snapshot, width: int, height: int, of: Look = LOOK) -> list[Strip]:
    table = sized(QTable(of), width, height)
    table.show(snapshot)
    return table.picture(snapshot, width, height)


def test_the_table_marks_pairs_and_states() -> None:
    snapshot = stopping(lake(state=6), states=(6, 9), pairs=(17, 0))
    strips = table_strips(snapshot, 36, 17)
    found = marks(strips, PALETTE.breakpoint)
    assert [(row, text) for row, _, text in found] == [(1, "!"), (5, "!"), (6, "◉"), (8, "!")]
    assert [strip.cell_length for strip in strips] == [36] * 17


@pytest.mark.parametrize("snapshot", [student(), bandit(500)], ids=["student", "bandit"])
def test_a_list_of_pairs_marks_them(snapshot: Snapshot) -> None:
    snapshot = stopping(snapshot, pairs=(1,))
    strips = table_strips(snapshot, 56, 17)
    assert [(row, text) for row, _, text in marks(strips, PALETTE.breakpoint)] == [(2, "!")]


def test_the_table_shows_where_the_cursor_of_the_world_stands() -> None:
    snapshot = lake()
    table = QTable(LOOK)
    table.show(snapshot)
    table.point_at(snapshot.world.space.pairs_of(9))
    strips = table.picture(snapshot, 36, 17)
    assert [text.strip() for *_, text in marks(strips, PALETTE.focus)] == ["9"]
    assert "9" in "".join(strip.text for strip in table.picture(snapshot, 36, 3))
    table.point_at(range(0))
    assert not marks(table.picture(snapshot, 36, 17), PALETTE.focus)


@pytest.mark.parametrize("depth", ["truecolor", "256", "16", "none"])
def test_a_breakpoint_is_seen_in_every_depth(depth: str) -> None:
    for dark, plain, snapshot in product((True, False), (True, False), (lake(), student(), bandit(500))):
        chosen = look(plain, depth, dark)
        style = chosen.palette.breakpoint
        assert style not in (chosen.palette.focus, chosen.palette.agent, chosen.palette.updated)
        stops = stopping(snapshot, states=(0, 2) if snapshot.world.space.states > 1 else (), pairs=(2,))
        view = make_world_view(stops.world, chosen)
        for strips in (view.picture(stops, 60, 19), table_strips(stops, 56, 17, chosen)):
            assert marks(strips, style)
            assert not plain or "".join(strip.text for strip in strips).isascii()


def test_breakpoints_in_words() -> None:
    stops = Breakpoints(frozenset({6, 2}), frozenset({17}))
    assert breakpoint_names(lake().world, stops, LOOK.glyphs) == ["state 2", "state 6", "4,↓"]
    assert breakpoint_names(bandit().world, Breakpoints(pairs=frozenset({3})), LOOK.glyphs) == ["arm 3"]
    assert breakpoint_names(lake().world, Breakpoints(), LOOK.glyphs) == []
