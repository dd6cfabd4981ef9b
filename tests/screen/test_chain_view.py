"""Chains of states as boxes in a row."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from drawn_grids import style_at
from sample_worlds import exact_solution
from samples import look
from snapshots import changed, snapshot_of

from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.exact_answers import Answer
from rl_tui.runs.library import recipe_for
from rl_tui.runs.run import Run
from rl_tui.screen.draw.block_signs import block_number
from rl_tui.screen.panels.graph.chain import chain_layout
from rl_tui.screen.panels.graph.graph import GraphView
from rl_tui.worlds.drawing import Graph
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.mdp.tabular_mdp import Outcome, Transition, tabular_mdp
from rl_tui.worlds.world import World


def random_walk(**changes: object) -> Snapshot:
    run = Run(recipe_for(find("random-walk"), {}, 0), evaluate=False)
    assert run.world.mdp is not None
    answer = Answer(exact_solution(run.world.mdp, 1.0), "")
    run.advance(50)
    return changed(snapshot_of(run, exact_answer=answer), is_hidden=False, **changes)


def choices(states: int = 7) -> Snapshot:
    mdp = tabular_mdp(
        [f"s{state}" for state in range(states)],
        ("left", "right"),
        [
            Transition(s, a, (Outcome(1.0, t, (t == states - 1) - float(t == 0), t in (0, states - 1)),))
            for s in range(1, states - 1)
            for a, t in ((0, s - 1), (1, s + 1))
        ],
        {states // 2: 1.0},
    )
    graph = Graph(tuple((0, s) for s in range(states)), tuple(range(states)))
    q = np.where(mdp.pair_action == 1, 0.5, -0.5)
    visits = np.ones(mdp.pairs, dtype=np.int64)
    return changed(
        random_walk(), world=World(mdp, graph), q=q, visits=visits, state=3, last_step=None, solution=None
    )


def rows(snapshot: Snapshot, width: int, height: int, *, plain: bool = False) -> list[str]:
    view = GraphView(snapshot.world, look(plain))
    return [strip.text for strip in view.picture(snapshot, width, height)]


def test_boxes_stand_in_a_row_between_two_ends_with_their_rewards() -> None:
    drawn = rows(random_walk(state=3, last_step=None), 69, 11)
    names = next(row for row in drawn if "Left" in row)
    assert names.split() == ["Left", "A", "B", "C", "D", "E", "Right"]
    ends = next(row for row in drawn if "★" in row)
    assert "● 0" in ends
    assert "★ +1" in ends
    agent = next(row for row in drawn if "◉" in row)
    assert agent.index("◉") == pytest.approx(names.index("C"), abs=1)


def test_exact_values_stand_below_unless_they_are_hidden() -> None:
    drawn = rows(random_walk(), 69, 11)
    exact = next(row for row in drawn if "exact" in row).split()
    assert [float(each) for each in exact[1:]] == pytest.approx(
        [1 / 6, 2 / 6, 3 / 6, 4 / 6, 5 / 6], abs=0.005
    )
    assert "exact" not in "".join(rows(changed(random_walk(), is_hidden=True), 69, 11))


def test_boxes_have_the_tints_of_the_scale() -> None:
    snapshot, palette = random_walk(), look().palette
    strips = GraphView(snapshot.world, look()).picture(snapshot, 69, 11)
    middle = len(strips) // 2
    step = 69 // 7
    grounds = [style_at(strips[middle + 1], 3 + place * step).bgcolor for place in range(7)]
    assert grounds[0] == palette.hole.bgcolor
    assert grounds[6] == palette.goal.bgcolor
    assert set(grounds[1:6]) <= {each.bgcolor for each in palette.values}


def test_a_choice_is_an_arrow_and_a_single_action_is_none() -> None:
    drawn = "".join(rows(choices(), 60, 8))
    assert drawn.count("→") == 5
    assert "←" not in drawn
    assert not {"←", "→"} & set("".join(rows(random_walk(last_step=None), 60, 8)))


def test_wide_boxes_have_arrows_of_blocks() -> None:
    assert "→" not in "".join(rows(choices(), 120, 11))


def test_the_cursor_moves_along_the_row() -> None:
    snapshot = random_walk()
    view = GraphView(snapshot.world, look())
    view.picture(snapshot, 69, 11)
    names = list(snapshot.world.space.state_names)
    a, b = names.index("A"), names.index("B")
    assert view.moved(a, 0, 1) == b
    assert view.moved(b, 0, -1) == a
    assert view.moved(a, 1, 0) == a
    row = next(y for y, text in enumerate(rows(snapshot, 69, 11)) if "Left" in text)
    assert view.place_at(rows(snapshot, 69, 11)[row].index("B"), row) == b


def test_where_boxes_have_no_room_the_actions_are_listed() -> None:
    drawn = rows(random_walk(), 13, 8)
    assert "walk" in "".join(drawn)


@pytest.mark.parametrize("plain", [False, True])
def test_no_label_is_cut_and_every_size_is_filled(plain: bool) -> None:
    sizes = (14, 1), (14, 2), (15, 3), (28, 4), (43, 8), (58, 8), (69, 11), (146, 11), (240, 20)
    for snapshot, (width, height) in product((random_walk(), choices()), sizes):
        view = GraphView(snapshot.world, look(plain, "none" if plain else "truecolor"))
        strips = view.picture(snapshot, width, height)
        assert [strip.cell_length for strip in strips] == [width] * height
        text = " ".join(strip.text for strip in strips)
        assert look(plain).glyphs.ellipsis not in text
        assert text.isascii() or not plain
        words = set(text.replace("◉", " ").split())
        assert not {"Lef", "Le", "Righ", "Rig", "exac"} & words


def test_the_last_step_is_an_arrow_between_its_states_and_its_update_has_a_frame() -> None:
    snapshot = random_walk()
    last = snapshot.counters.last_step
    assert last is not None
    drawn = rows(snapshot, 69, 11)
    layout = chain_layout((0, 1, 2, 3, 4, 5, 6), 69, 11)
    assert layout is not None
    boxes = layout.boxes
    state, after = boxes[last.state], boxes[last.next_state]
    y = state.y + state.height // 2
    gap = drawn[y][min(state.x, after.x) + state.width : max(state.x, after.x)]
    assert gap.strip("━") == ("▶" if after.x > state.x else "◀")
    updated = boxes[snapshot.world.space.state_of(last.updated_pair)]
    assert [x for x, sign in enumerate(drawn[y]) if sign in "▌▐"] == [
        updated.x,
        updated.x + updated.width - 1,
    ]
    assert not {"▌", "▐"} & set("".join(rows(snapshot, 69, 11, plain=True)))


def test_large_boxes_have_their_values_in_blocks_and_the_exact_ones_below() -> None:
    snapshot = random_walk()
    view = GraphView(snapshot.world, look())
    drawn = [strip.text for strip in view.picture(snapshot, 116, 12)]
    value = block_number(f"{snapshot.agent.q[0]:.2f}".removeprefix("0"))
    assert all(any(line in row for row in drawn) for line in value)
    assert any("exact" in row for row in drawn[-3:])
    plain = rows(snapshot, 116, 12, plain=True)
    assert any(f"{snapshot.agent.q[0]:.2f}" in row for row in plain)
