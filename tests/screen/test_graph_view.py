from __future__ import annotations

import numpy as np
import pytest
from drawn_grids import style_at
from sample_worlds import student_world
from samples import look, student
from snapshots import changed

from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import begin
from rl_tui.screen.draw.block_signs import block_number, block_numbers
from rl_tui.screen.panels.graph.graph import BOLD, THIN, GraphView, StrokeArms, joint
from rl_tui.screen.panels.graph.layout import GraphLayout, graph_layout
from rl_tui.screen.panels.graph.routing import RIGHT, Box, Port, RoutingSheet, route
from rl_tui.screen.panels.graph.shape import GraphShape, graph_shape, probability_text, reward_text
from rl_tui.screen.theme.glyphs import ASCII, UNICODE, Glyphs
from rl_tui.worlds.drawing import Graph
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp
from rl_tui.worlds.world import World

CLASS, PHONE, PASS, SLEEP = range(4)


def recycling_robot() -> TabularMDP:
    """Sutton & Barto, example 3.3, with α = .7 and β = .6."""
    return tabular_mdp(
        ("high", "low"),
        ("search", "wait", "recharge"),
        (
            Transition(0, 0, (Outcome(0.7, 0, 3, False), Outcome(0.3, 1, 3, False))),
            Transition(0, 1, (Outcome(1.0, 0, 1, False),)),
            Transition(1, 0, (Outcome(0.6, 1, 3, False), Outcome(0.4, 0, -3, False))),
            Transition(1, 1, (Outcome(1.0, 1, 1, False),)),
            Transition(1, 2, (Outcome(1.0, 0, 0, False),)),
        ),
        {0: 1.0},
        time_limit=100,
    )


def random_walk() -> TabularMDP:
    """Sutton & Barto, example 6.2, with two actions."""
    return tabular_mdp(
        tuple("LABCDER"),
        ("left", "right"),
        [
            Transition(s, a, (Outcome(1.0, s + 2 * a - 1, float(s == 5 and a == 1), False),))
            for s in range(1, 6)
            for a in (0, 1)
        ],
        {3: 1.0},
    )


def ring(nodes: int) -> TabularMDP:
    return tabular_mdp(
        [f"state {state}" for state in range(nodes)],
        [f"to {state}" for state in range(nodes)],
        [
            Transition(s, a, (Outcome(1.0, a, 1.0, False),))
            for s in range(nodes)
            for a in range(nodes)
            if s != a
        ],
        {0: 1.0},
        time_limit=10,
    )


def shape_of(
    mdp: TabularMDP | None, places: tuple[tuple[int, int], ...], glyphs: Glyphs = UNICODE
) -> GraphShape:
    assert mdp is not None
    return graph_shape(World(mdp, Graph(places)), Graph(places), glyphs)


def as_view(
    mdp: TabularMDP, places: tuple[tuple[int, int], ...], *, plain: bool = False
) -> tuple[GraphView, Snapshot]:
    world = World(mdp, Graph(places))
    nothing = np.zeros(mdp.pairs, dtype=np.int64)
    snapshot = changed(
        student(step=0), world=world, q=np.zeros(mdp.pairs), visits=nothing, state=int(mdp.start_state[0])
    )
    return GraphView(world, look(plain)), snapshot


def picture(snapshot: Snapshot, width: int, height: int, *, ascii: bool = False) -> list[str]:  # noqa: A002
    view = GraphView(snapshot.world, look(ascii))
    return [strip.text for strip in view.picture(snapshot, width, height)]


STUDENT_40 = """\

        Phone ─╮ scroll −1
        5.71  ◀╯

  check ▲  ┃ quit 0
phone 0 │  ▼  study −2     sleep
                .8          +10 ╔══════╗
        Class ━●━━▶ ◉Pass  ────▶║ Sleep║
        6.37  ◀┛.2  10.00       ║ end  ║
                                ╚══════╝"""


def test_the_student_evening_at_80_by_24() -> None:
    assert "\n".join(row.rstrip() for row in picture(student(), 40, 10)) == STUDENT_40


def test_the_student_evening_at_120_by_40_has_every_label_in_whole() -> None:
    text = "\n".join(picture(student(), 75, 24))
    for label in ("study −2", "quit 0", "scroll −1", "sleep +10", ".8", ".2", "end"):
        assert label in text
    assert "◉" in text


def test_only_what_changes_with_values_is_drawn_again() -> None:
    snapshot = student()
    phone_first = changed(snapshot, q=np.array([4.0, 6.0, 4.14, 5.71, 10.0]), state=PHONE)
    rows = picture(phone_first, 40, 10)
    assert rows[1].startswith("       ◉Phone ─╮ scroll −1")
    assert rows[4].startswith("  check ▲  ┃ quit 0")
    assert rows[7].startswith("        Class ─●──▶  Pass  ────▶║")


def test_before_anything_is_learned_no_action_is_bold() -> None:
    text = "\n".join(picture(student(step=0), 40, 10))
    assert not set("━┃┝┰") & set(text)
    assert "0.00" in text


def test_greedy_ties_are_all_bold() -> None:
    snapshot = changed(student(), q=np.array([5.0, 5.0, 1.0, 2.0, 3.0]))
    rows = picture(snapshot, 40, 10)
    assert " ━●━━▶" in rows[7]
    assert "phone 0 ┃" in rows[5]


def test_boxes_are_tinted_by_value_and_terminal_ones_are_not() -> None:
    palette = look().palette
    strips = GraphView(student_world(), look()).picture(student(), 40, 10)
    assert style_at(strips[8], 20) == palette.value(1.0)  # 10.00 of Pass
    assert style_at(strips[8], 34) == palette.text
    unknown = GraphView(student_world(), look()).picture(student(step=0), 40, 10)
    assert style_at(unknown[8], 20) == palette.unvisited


def test_actions_that_differ_only_by_name_are_one_edge_with_their_number() -> None:
    run = begin(recipe_for(find("max-bias"), {}, 0))
    assert isinstance(run.world.drawing, Graph)
    shape = graph_shape(run.world, run.world.drawing, UNICODE)
    bundled = shape.bundled()
    assert [each.label for each in bundled.actions] == ["left 0", "right 0", "10 actions −0.1"]
    bundle = bundled.actions[-1]
    assert len(bundle.pairs) == 10
    assert bundled.marked({bundle.pairs[3]}) == {bundle.pair}
    assert bundled.marked(set()) == frozenset()
    evening = shape_of(student().world.mdp, ((0, 1), (0, 0), (1, 1), (2, 1)))
    assert evening.bundled() == evening


def test_ascii() -> None:
    rows = picture(student(), 40, 10, ascii=True)
    assert "".join(rows).isascii()
    assert rows[7] == "        Class =o==> @Pass  ---->| Sleep|"


def test_a_box_has_a_tint_or_a_frame() -> None:
    palette = look().palette
    strips = GraphView(student_world(), look()).picture(student(), 40, 10)
    assert style_at(strips[0], 6).bgcolor == style_at(strips[2], 13).bgcolor == palette.value(0.65).bgcolor
    colourless = GraphView(student_world(), look(False, "none")).picture(student(), 40, 10)
    assert colourless[0].text[6:14] == "╭──────╮"
    assert colourless[7].text.startswith("      │ Class┝━●━━▶│◉Pass ├────▶║ Sleep║")


def test_name_and_value_have_one_centre() -> None:
    rows = picture(student(), 75, 24)
    y = next(y for y, row in enumerate(rows) if "Sleep" in row)
    assert rows[y + 1].index("end") == rows[y].index("Sleep") + 1


def test_a_graph_without_room_becomes_a_list_of_its_actions() -> None:
    rows = [row.rstrip() for row in picture(student(), 50, 6)]
    assert rows == [
        " Class   6.37 ━study −2━▶ Pass .8 / Class .2",
        "              ─check phone 0─▶ Phone",
        " Phone   5.71 ─scroll −1─▶ Phone",
        "              ━quit 0━▶ Class",
        "◉Pass   10.00 ─sleep +10─▶ Sleep",
        " Sleep    end",
    ]


def test_a_line_of_the_list_is_written_tight_before_it_is_split() -> None:
    assert picture(student(), 40, 6)[0].rstrip() == " Class   6.37 ━study −2▶Pass .8/Class .2"


def test_a_narrow_list_has_values_below_names_and_a_line_for_each_outcome() -> None:
    view = GraphView(student_world(), look())
    strips = view.picture(student(), 29, 8)
    assert [strip.text.rstrip() for strip in strips] == [
        " Class  ━study −2━▶ Pass .8",
        " 6.37            ━▶ Class .2",
        "        ─check phone 0▶Phone",
        " Phone  ─scroll −1─▶ Phone",
        " 5.71   ━quit 0━▶ Class",
        "◉Pass   ─sleep +10─▶ Sleep",
        " 10.00",
        " Sleep    end",
    ]
    assert {style_at(strips[y], 5).bgcolor for y in (5, 6)} == {look().palette.value(1.0).bgcolor}


def test_the_list_scrolls() -> None:
    view = GraphView(student_world(), look())
    assert view.picture(student(), 28, 2)[0].text.startswith(" Class")
    assert view.footing == "↑↓ 1–2 of 8"
    view.pan(3, 0)
    rows = [strip.text.rstrip() for strip in view.picture(student(), 28, 2)]
    assert rows == [" Phone  ─scroll −1─▶ Phone", " 5.71   ━quit 0━▶ Class"]
    view.pan(9, 0)
    assert view.picture(student(), 28, 2)[1].text.startswith(" Sleep")
    assert view.footing == "↑↓ 7–8 of 8"


@pytest.mark.exhaustive("draws each graph", but=["robot small", "walk", "three"])
@pytest.mark.parametrize(
    ("mdp", "places", "size"),
    [
        (recycling_robot(), ((0, 0), (1, 0)), (40, 10)),
        (recycling_robot(), ((0, 0), (1, 0)), (60, 19)),
        (recycling_robot(), ((0, 0), (0, 1)), (60, 19)),
        (random_walk(), tuple((column, 0) for column in range(7)), (116, 34)),
        (ring(3), ((0, 0), (2, 0), (1, 1)), (60, 19)),
        (ring(4), ((0, 0), (1, 0), (0, 1), (1, 1)), (80, 34)),
    ],
    ids=["robot small", "robot", "robot upright", "walk", "three", "four"],
)
def test_other_graphs_are_drawn_whole(
    mdp: TabularMDP, places: tuple[tuple[int, int], ...], size: tuple[int, int]
) -> None:
    shape = shape_of(mdp, places)
    layout = graph_layout(shape, *size)
    assert layout is not None
    check_layout(shape, layout, *size)


def check_layout(shape: GraphShape, layout: GraphLayout, width: int, height: int) -> None:
    boxes = [set(box.cells()) for box in layout.boxes]
    assert sum(map(len, boxes)) == len(set().union(*boxes))
    text = [(label.x + i, label.y) for label in layout.labels for i in range(len(label.text))]
    taken = set().union(*boxes)
    assert len(text) == len(set(text))
    assert not taken & set(text)
    assert all(0 <= x < width and 0 <= y < height for x, y in taken | set(text))
    assert len(layout.heads) == sum(len(action.branches) for action in shape.actions)
    assert len(layout.forks) == sum(len(action.branches) > 1 for action in shape.actions)
    for action in shape.actions:
        words = " ".join(label.text for label in layout.labels if label.pair == action.pair).split()
        wanted = [action.label, *(branch.label for branch in action.branches)]
        assert sorted(words) == sorted(" ".join(wanted).split())
    lines: dict[tuple[int, int], list[tuple[int, ...]]] = {}
    for stroke in layout.strokes:
        lines.setdefault((stroke.x, stroke.y), []).append(tuple(sorted(stroke.arms)))
    forks = {(fork.x, fork.y) for fork in layout.forks}
    for cell, arms in lines.items():
        # lines share a cell only where they cross at right angles
        assert len(arms) == 1 or cell in forks or sorted(arms) == [(0, 2), (1, 3)]


def test_two_states_in_one_place_are_listed() -> None:
    view, snapshot = as_view(recycling_robot(), ((0, 0), (0, 0)))
    assert "─search +3─▶ high .7 / low .3" in view.picture(snapshot, 80, 24)[0].text


def test_more_edges_than_anybody_can_follow_are_listed() -> None:
    view, snapshot = as_view(ring(6), tuple((index % 3, index // 3) for index in range(6)))
    text = "".join(strip.text for strip in view.picture(snapshot, 60, 40))
    assert all(text.count(f"─to {state} +1─▶ state {state} ") == 5 for state in range(6))


def test_actions_are_labelled_with_probability_and_reward() -> None:
    shape = shape_of(student_world().mdp, ((0, 1), (0, 0), (1, 1), (2, 1)))
    study = shape.actions[0]
    assert study.label == "study −2"
    assert [(branch.target, branch.label) for branch in study.branches] == [(PASS, ".8"), (CLASS, ".2")]
    assert shape.nodes[SLEEP].terminal
    search = shape_of(recycling_robot(), ((0, 0), (1, 0)), ASCII).actions[2]
    assert (search.label, [branch.label for branch in search.branches]) == ("search", [".6 +3", ".4 -3"])


def test_outcomes_into_one_state_share_an_edge_with_their_expected_reward() -> None:
    mdp = tabular_mdp(
        ("a", "b"),
        ("go",),
        (
            Transition(
                0, 0, (Outcome(0.3, 1, 1.0, True), Outcome(0.1, 1, 5.0, True), Outcome(0.6, 0, 0.0, False))
            ),
        ),
        {0: 1.0},
    )
    action = shape_of(mdp, ((0, 0), (1, 0))).actions[0]
    assert [branch.label for branch in action.branches] == [".6 0", ".4 +2"]


@pytest.mark.parametrize(
    ("probability", "text"),
    [
        (0.8, ".8"),
        (1 / 3, ".33"),
        (2 / 3, ".67"),
        (0.05, ".05"),
        (0.005, ".005"),
        (0.999, ".999"),
        (0.25, ".25"),
    ],
)
def test_probabilities(probability: float, text: str) -> None:
    assert probability_text(probability) == text


@pytest.mark.parametrize(
    ("reward", "text"),
    [(10.0, "+10"), (-2.0, "−2"), (0.0, "0"), (0.5, "+0.5"), (-100.0, "−100"), (1 / 3, "+0.333")],
)
def test_rewards(reward: float, text: str) -> None:
    assert reward_text(reward, UNICODE) == text


@pytest.mark.parametrize(
    ("arms", "unicode", "plain"),
    [
        (StrokeArms(right=THIN, left=THIN), "─", "-"),
        (StrokeArms(up=BOLD, down=BOLD), "┃", "#"),
        (StrokeArms(up=THIN, right=THIN), "╰", "+"),
        (StrokeArms(down=BOLD, left=BOLD), "┓", "+"),
        (StrokeArms(THIN, BOLD, THIN, 0), "┝", "+"),
        (StrokeArms(THIN, BOLD, THIN, BOLD), "┿", "+"),
        (StrokeArms(), " ", " "),
    ],
)
def test_lines_join(arms: StrokeArms, unicode: str, plain: str) -> None:
    assert joint(arms, UNICODE) == unicode
    assert joint(arms, ASCII) == plain


def test_a_route_goes_around_boxes_and_ends_on_a_straight_cell() -> None:
    wall = Box(5, 0, 3, 4)
    target = Box(12, 0, 4, 3)
    sheet = RoutingSheet(20, 6, {*wall.cells(), *target.cells()})
    found = route(sheet, {Port((0, 1), RIGHT): 0.0}, {Port((12, 1), RIGHT): 0.0})
    assert not set(found.cells) & set(wall.cells())
    assert found.cells[-2:] == ((10, 1), (11, 1))
    closed = RoutingSheet(20, 6, {*Box(5, 0, 3, 6).cells(), *target.cells()})
    assert route(closed, {Port((0, 1), RIGHT): 0.0}, {Port((12, 1), RIGHT): 0.0}) is None


def test_what_depends_on_how_one_came_there_has_a_question_mark() -> None:
    world = begin(recipe_for(find("egg"), {}, 0)).world
    assert isinstance(world.drawing, Graph)
    shape = graph_shape(world, world.drawing, UNICODE)
    names = [node.name for node in shape.nodes]
    by_pair = {(names[each.source], each.name): each for each in shape.actions}
    assert by_pair["Clock 3", "eat"].label == "eat +10"
    wait, eat = by_pair["Pot", "wait"], by_pair["Pot", "eat"]
    assert {(names[each.target], each.label) for each in wait.branches} == {
        ("Pot", "chance ? −1"),
        ("Plate", "chance ? −10"),
    }
    assert (eat.label, [names[each.target] for each in eat.branches]) == ("eat −10 or +10", ["Plate"])
    layout = graph_layout(shape, 60, 20)
    assert layout is not None
    check_layout(shape, layout, 60, 20)


@pytest.mark.parametrize(("size", "box"), [((60, 19), (13, 6)), ((75, 24), (16, 8)), ((150, 40), (25, 11))])
def test_boxes_grow_with_the_room(size: tuple[int, int], box: tuple[int, int]) -> None:
    shape = shape_of(student_world().mdp, ((0, 1), (0, 0), (1, 1), (2, 1)))
    layout = graph_layout(shape, *size)
    assert layout is not None
    assert layout.boxes[0][2:] == box
    check_layout(shape, layout, *size)


def test_numbers_are_in_blocks_in_large_boxes_and_exact_ones_below_them() -> None:
    shown = changed(student(), is_hidden=False)
    small, medium, large = (picture(shown, *size) for size in ((60, 19), (75, 24), (150, 40)))
    for text, short in (("6.37", "6.4"), ("5.71", "5.7"), ("10.00", "10")):
        assert any(text in row and "exact" not in row for row in small)
        for rows, number in ((medium, short), (large, text)):
            assert all(any(line in row for row in rows) for line in block_number(number))
    assert any("exact 10.00" in row for row in large)
    assert not any("exact" in row for row in small)
    assert block_numbers(["6.37", "10.00"], 16) == {}
