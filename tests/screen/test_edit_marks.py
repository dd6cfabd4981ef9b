"""Marks of an edit without an app."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import pytest
from drawn_curves import drawn as drawn_curve
from drawn_grids import picture, style_at, visited
from samples import answered, lake, look, student

from rl_tui.live.snapshot import Snapshot
from rl_tui.live.world_editor import EditorView
from rl_tui.runs.library import recipe_for
from rl_tui.runs.run import WorldChanged
from rl_tui.screen.draw.canvas import Canvas
from rl_tui.screen.panels.curve.data import curve_data
from rl_tui.screen.panels.curve.text import COST
from rl_tui.screen.panels.graph.graph import GraphView
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.screen.panels.world.edit_marks import EditMarks, put_marks
from rl_tui.worlds.editing.arms_draft import Draft
from rl_tui.worlds.editing.drafts import first_draft
from rl_tui.worlds.editing.edit import read_edits
from rl_tui.worlds.editing.grid_draft import draft_of_lines
from rl_tui.worlds.files.catalogue import find

LAKE = ["S...", ".H.H", "...H", "H..G"]
SIZES = ((9, 4), (16, 4), (24, 4), (24, 8), (40, 12), (72, 20), (90, 28))


def edited(draft: Draft, text: str) -> Draft:
    for edit in read_edits(text):
        draft = draft.edited(edit)
    return draft


def drawing(snapshot: Snapshot, text: str) -> Snapshot:
    base = draft_of_lines(LAKE, {})
    return replace(snapshot, editor=EditorView(draft=edited(base, text), base=base))


def marked(snapshot: Snapshot, turned: set[int] = frozenset(), endless: set[int] = frozenset()) -> Snapshot:  # type: ignore[assignment]
    base = draft_of_lines(LAKE, {})
    editor = EditorView(draft=base, base=base, turned=frozenset(turned), endless=frozenset(endless))
    return replace(snapshot, editor=editor)


def legend_of(view: GridView | GraphView | QTable, snapshot: Snapshot) -> set[str]:
    return {each.sign for each in view.legend(snapshot)}


# The draft on the map


@pytest.mark.parametrize(("ascii_", "hatch", "hole", "goal"), [(False, "╱", "●", "★"), (True, "/", "O", "G")])
def test_what_is_drawn_and_not_in_force_stands_in_place_of_the_world(
    ascii_: bool, hatch: str, hole: str, goal: str
) -> None:
    start = visited(lake(step=0), 0, 1, 2)
    before = picture(start, 40, 12, ascii=ascii_)
    rows = picture(
        drawing(start, "world.cell[0,2]=H;world.cell[1,1]=G;world.cell[0,3]=#"), 40, 12, ascii=ascii_
    )
    cells = [
        [row[10 * column : 10 * column + 10] for row in rows[3 * line : 3 * line + 3]]
        for line in range(4)
        for column in range(4)
    ]
    was = [
        [row[10 * column : 10 * column + 10] for row in before[3 * line : 3 * line + 3]]
        for line in range(4)
        for column in range(4)
    ]
    assert all(hatch in "".join(cells[cell]) for cell in (2, 3, 5))
    assert hole in "".join(cells[2])
    assert goal in "".join(cells[5])
    assert hole not in "".join(cells[5])
    assert [cells[cell] == was[cell] for cell in range(16)].count(False) == 3, (
        "all other cells are as they were"
    )
    assert not ascii_ or "".join(rows).isascii()


def test_every_form_of_cells_shows_the_draft() -> None:
    shown = drawing(lake(step=0), "world.cell[0,0]=.;world.cell[2,0]=>")
    for (width, height), actions in product(SIZES, (False, True)):
        view = GridView(shown.world, look())
        view.shows_actions = actions
        rows = [strip.text for strip in view.picture(shown, width, height)]
        assert [len(row) for row in rows] == [width] * height
        assert "╱" in "".join(rows), (width, height, actions)
        assert "S" not in "".join(rows)
        assert "╱" in legend_of(view, shown)


def test_a_one_way_cell_and_a_reward_are_drawn() -> None:
    rows = picture(drawing(lake(step=0), "world.cell[2,1]=<;world.reward[0,1]=-5"), 40, 12)
    assert "←" in "".join(row[10:20] for row in rows[6:9])
    assert "−5" in "".join(row[10:20] for row in rows[0:3])


def test_only_what_is_in_view_is_looked_at_and_lines_that_are_new_have_no_place() -> None:
    shown = drawing(lake(step=0), "world.rows=+1@0;world.cell[1,0]=#")
    rows = picture(shown, 40, 12)
    assert "█" in "".join(row[:10] for row in rows[:3]), "the first row in force is the second of the draft"
    assert "╱" not in "".join(rows[3:])


def test_the_agent_and_the_cursor_are_seen_on_a_cell_that_is_drawn() -> None:
    shown = drawing(lake(step=0, state=0), "world.cell[0,0]=.")
    view = GridView(shown.world, look())
    assert "◉" in "".join(strip.text for strip in view.picture(shown, 40, 12))
    view.picked = frozenset({0})
    focus = look().palette.focus.bgcolor
    strips = view.picture(shown, 40, 12)
    assert any(segment.style and segment.style.bgcolor == focus for strip in strips for segment in strip)


def test_a_draft_in_force_looks_like_the_world() -> None:
    start = lake(step=0)
    assert picture(marked(start), 40, 12) == picture(start, 40, 12)


# The marks


def test_turned_and_endless_states_have_a_sign_in_every_form_of_cells() -> None:
    start = visited(lake(step=0, state=14), 0, 1, 2)
    for (width, height), actions, ascii_ in product(SIZES, (False, True), (False, True)):
        glyphs = look(ascii_).glyphs
        view = GridView(start.world, look(ascii_))
        view.shows_actions = actions
        shown = marked(start, turned={2}, endless={6})
        text = "".join(strip.text for strip in view.picture(shown, width, height))
        assert text.count(glyphs.endless) == 1, (width, height, actions)
        assert text.count(glyphs.turned) == 1, (width, height, actions)
        assert {glyphs.turned, glyphs.endless} <= legend_of(view, shown)
        assert not {glyphs.turned, glyphs.endless} & legend_of(view, marked(start))


def test_what_never_ends_is_told_first_where_there_is_room_for_one_sign() -> None:
    shown = marked(visited(lake(step=0, state=14), 6), turned={6}, endless={6})
    assert "∞" in "".join(picture(shown, 24, 4))
    assert "∞↻" in "".join(picture(shown, 40, 12))


@pytest.mark.parametrize("taken", ["    ", "abcd", "a  d"])
def test_marks_never_write_over_anything(taken: str) -> None:
    canvas = Canvas(4, 2, look().palette.text)
    for row in range(2):
        canvas.put(0, row, taken, look().palette.text)
    put_marks(canvas, EditMarks(is_endless=True, is_turned=True), (1, 0), look())
    text = "".join(strip.text for strip in canvas.strips())
    assert all(letter in text for letter in taken.replace(" ", ""))
    assert text.count("∞") == (taken != "abcd")


def test_the_table_marks_the_state() -> None:
    shown = marked(visited(answered(lake(step=0)), 2), turned={2})
    table = QTable(look())
    rows = [strip.text for strip in table.picture(shown, 60, 20)]
    assert [row.split()[0] for row in rows if "↻" in row] == ["2↻"]
    assert "↻" in legend_of(table, shown)


def evening(text: str = "", **marks: frozenset[int]) -> Snapshot:
    recipe = recipe_for(find("student"), {}, seed=0)
    base = first_draft(recipe.scenario, 0)
    draft = edited(base, text) if text else base
    shown = student(step=0)
    return replace(shown, world=base.build(), editor=EditorView(draft=draft, base=base, **marks))


@pytest.mark.parametrize("size", [(60, 18), (46, 10)])
@pytest.mark.parametrize("ascii_", [False, True])
def test_a_graph_marks_states_beside_their_name(size: tuple[int, int], ascii_: bool) -> None:
    start = evening(turned=frozenset({0}), endless=frozenset({1}))
    view = GraphView(start.world, look(ascii_))
    rows = [strip.text for strip in view.picture(start, *size)]
    glyphs = look(ascii_).glyphs
    for sign in (glyphs.turned, glyphs.endless):
        assert "".join(rows).count(sign) == 1
        assert sign in legend_of(view, start)
    assert [len(row) for row in rows] == [size[0]] * size[1]


@pytest.mark.parametrize("size", [(60, 18), (46, 10)])
def test_a_graph_is_drawn_from_the_draft(size: tuple[int, int]) -> None:
    shown = evening('world.transition[Class,study]={"to":{"Bar":0.5,"Pass":0.4},"reward":3}')
    view = GraphView(shown.world, look())
    text = " ".join("".join(strip.text for strip in view.picture(shown, *size)).split())
    assert "╱study" in text
    assert "+3" in text
    assert "Bar" in text
    assert text.count("╱") == 1, "all else is in force"
    for place in range(shown.world.space.states):
        for step in product((-1, 0, 1), repeat=2):
            assert view.moved(place, *step) < shown.world.space.states, "a new state has no cursor yet"
    view.picture(evening(), *size)
    assert "╱" not in "".join(strip.text for strip in view.picture(evening(), *size))


# Changes in the world


def with_changes(*changes: WorldChanged) -> Snapshot:
    return replace(lake(episodes=1_000), world_changes=changes)


def test_a_line_goes_up_where_the_world_changed() -> None:
    shown = with_changes(WorldChanged(3_000, 330, given_up=False), WorldChanged(6_000, 700, given_up=True))
    text, _ = drawn_curve(shown, (80, 13))
    columns = {x for line in text.splitlines() for x, character in enumerate(line) if character == "┊"}
    assert len(columns) == 2
    everywhere = [WorldChanged(episode * 10, episode, given_up=False) for episode in range(1_000)]
    assert "┊" not in drawn_curve(with_changes(*everywhere), (80, 13))[0], "lines would hide the curve"


def level_columns(snapshot: Snapshot) -> list[int]:
    _, widget = drawn_curve(snapshot, (80, 13))
    found = []
    for strip in widget.picture(snapshot, 80, 13):
        for x, sign in enumerate(strip.text):
            if sign in "⠉⠒⠤⣀" and style_at(strip, x) == widget.look.palette.dim:
                found.append(x)
    return found


def test_what_is_optimal_is_claimed_of_the_present_world_alone() -> None:
    whole = level_columns(lake(episodes=1_000))
    shown = answered(with_changes(WorldChanged(5_000, 330, given_up=False)))
    part = level_columns(shown)
    text = drawn_curve(shown, (80, 13))[0]
    mark = next(line.index("┊") for line in text.splitlines() if "┊" in line)
    assert min(part) >= mark
    assert 0 < len(part) < len(whole)
    assert curve_data(shown).world_since == 330


def test_a_gap_is_not_laid_to_exploring_while_episodes_are_of_another_world() -> None:
    assert COST in drawn_curve(lake(), (80, 13))[1].heading
    last = lake().counters.episodes
    recent = replace(lake(), world_changes=(WorldChanged(10, last - 50, given_up=False),))
    assert COST not in drawn_curve(recent, (80, 13))[1].heading
