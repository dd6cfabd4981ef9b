"""The layers that world and table share."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from conftest import MakeApp
from drawn_grids import large_lake, style_at
from drawn_tables import PALETTE, Drawn
from lane_samples import side_by_side
from samples import answered, bandit, big_lake, lake, look, student
from seams import on_screen, playground, press, train
from snapshots import changed
from textual.geometry import Size

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.kit.layers import WORDS, Layer, as_layer, world_layer
from rl_tui.screen.kit.value_scale import Ramp, SteadyScale, ValueScale
from rl_tui.screen.panels.graph.graph import GraphView
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.panels.world.scale_line import VEILED

ERRORS_AND_VISITS = (Layer.ERROR, Layer.VISITS)


def drawn(snapshot: Snapshot, layer: Layer, cell: tuple[int, int] = (17, 6)) -> list[str]:
    view = GridView(snapshot.world, look())
    view.cell, view.wanted_layer = Size(*cell), layer
    view.show(snapshot)
    return [strip.text for strip in view.picture(snapshot, 4 * cell[0], 4 * cell[1] + 1)]


def learning() -> Snapshot:
    shown = lake()
    solution = shown.exact_answer.solution
    assert solution is not None
    visits = np.arange(shown.world.space.pairs, dtype=np.int64)
    return changed(shown, q=solution.q * 0.5, visits=visits)


def test_each_layer_of_a_map_has_its_word_and_its_numbers() -> None:
    shown = learning()
    values = as_layer(shown, Layer.OPTIMAL).agent.values
    for layer, number in ((Layer.OPTIMAL, values[0]), (Layer.ERROR, -values[0] / 2.0)):
        rows = drawn(shown, layer)
        assert rows[-1].startswith(f"{WORDS[layer]} ")
        assert f"{number:.2f}".replace("0.", ".").replace("-", "−") in rows[5]
    visits = drawn(shown, Layer.VISITS)
    assert visits[-1].startswith(f"visits 0 {' ' * len(PALETTE.visits)} 166")
    assert " 6 " in visits[5]  # 0 + 1 + 2 + 3, without decimals


def test_actions_are_the_agents_but_for_the_exact_ones() -> None:
    shown = learning()
    solution = shown.exact_answer.solution
    assert solution is not None
    worst = changed(shown, q=-shown.agent.q)
    agents = worst.agent.q == np.repeat(
        np.maximum.reduceat(worst.agent.q, np.arange(0, len(worst.agent.q), 4)), 4
    )
    for layer in ERRORS_AND_VISITS:
        assert np.array_equal(as_layer(worst, layer).agent.policy > 0.0, agents)
    assert np.array_equal(as_layer(worst, Layer.OPTIMAL).agent.policy > 0.0, solution.greedy)


def test_a_hidden_answer_is_dots_without_ends() -> None:
    rows = drawn(changed(learning(), is_hidden=True), Layer.OPTIMAL)
    assert sum("···" in row for row in rows) == 4
    assert rows[-1].startswith(f"{WORDS[Layer.OPTIMAL]}: {VEILED}")


def test_a_world_without_numbers_for_a_layer_stays_at_its_values() -> None:
    computing = changed(learning(), solution=None)
    for layer in (Layer.OPTIMAL, Layer.ERROR, Layer.LANES, Layer.POLICY):
        assert world_layer(computing, layer) is Layer.Q
        assert drawn(computing, layer) == drawn(computing, Layer.Q)
    assert all(world_layer(bandit(400), layer) is Layer.Q for layer in Layer)


@pytest.mark.parametrize("layer", [Layer.OPTIMAL, Layer.ERROR, Layer.VISITS])
def test_map_and_table_have_one_scale(layer: Layer) -> None:
    shown = learning()
    view = GridView(shown.world, look())
    view.cell, view.wanted_layer = Size(17, 6), layer
    view.show(shown)
    picture = view.picture(shown, 68, 25)
    scale = SteadyScale().of(shown, layer)
    assert view.tints == scale
    table = Drawn(shown, 60, 17, layer)
    style, first = style_at(picture[1], 2), float(as_layer(shown, layer).agent.values[0])
    assert style is not None
    assert style.bgcolor == scale.style(first, PALETTE).bgcolor
    pair = 2
    numbers = {
        Layer.OPTIMAL: as_layer(shown, Layer.OPTIMAL).agent.q,
        Layer.ERROR: shown.agent.q - as_layer(shown, Layer.OPTIMAL).agent.q,
        Layer.VISITS: shown.agent.visits,
    }[layer]
    text = next(row for row in table.rows if row.strip(" ◉").startswith("0 "))
    row = table.rows.index(text)
    assert scale.style(float(numbers[pair]), PALETTE) in {each.style for each in table.strips[row]}


def test_errors_are_around_a_grey_zero_and_visits_go_by_their_logarithm() -> None:
    errors = ValueScale(-0.2, 0.5, Ramp.ERRORS)
    assert errors.ends == (-0.5, 0.5)
    assert errors.style(0.0, PALETTE) == PALETTE.signed_value(0.0)
    assert ValueScale(ramp=Ramp.ERRORS).style(0.0, PALETTE) == PALETTE.signed_value(0.0)
    visits = ValueScale(0.0, 10_000.0, Ramp.VISITS)
    assert visits.style(99.0, PALETTE) == PALETTE.visit_count(0.5)


def test_leads_are_compared_with_values_whatever_is_tinted() -> None:
    """An arrow is as pale in the layer of visits, which are thousands, as in the layer of values."""
    shown = learning()
    views = []
    for layer in (Layer.Q, Layer.VISITS):
        view = GridView(shown.world, look())
        view.cell, view.wanted_layer = Size(17, 6), layer
        view.show(shown)
        view.picture(shown, 68, 25)
        views.append(view.range_of_v)
    assert views[0] == views[1]


def test_lanes_have_one_scale_of_every_layer() -> None:
    shown = side_by_side(2)
    more = changed(shown, visits=shown.agent.visits * 1_000 + 7)
    left = SteadyScale().of(replace(shown, beside=more), Layer.VISITS)
    right = SteadyScale().of(replace(more, beside=shown), Layer.VISITS)
    assert left == right
    assert left.high > SteadyScale().of(shown, Layer.VISITS).high


def test_only_what_is_held_of_a_large_world_is_counted() -> None:
    shown = large_lake()
    assert as_layer(shown, Layer.VISITS).agent.values.sum() == 0.0
    assert SteadyScale().of(shown, Layer.VISITS) == ValueScale(ramp=Ramp.VISITS)


def test_a_table_that_is_a_list_shows_q_beside_a_landscape() -> None:
    drawn_list = Drawn(learning(), 30, 12, Layer.LANDSCAPE)
    table = drawn_list.table
    table.cell = Size(7, 3)
    text = "".join(strip.text for strip in table.picture(table.snapshot, 22, 12))
    assert Layer.LANDSCAPE in table.layer_choices
    assert "state" in text
    assert table.shown_layer is Layer.Q


def test_a_graph_turns_too() -> None:
    shown = answered(student(), True)
    view = GraphView(shown.world, look())
    view.cell, view.wanted_layer = Size(0, 0), Layer.VISITS
    view.show(shown)
    rows = [strip.text for strip in view.picture(shown, 60, 14)]
    assert rows[-1].startswith("visits 0 ")
    counts = [int(shown.agent.visits[shown.world.space.pairs_of(state)].sum()) for state in range(3)]
    assert all(any(f" {count:,} " in row for row in rows) for count in counts)


def test_small_cells_have_all_layers() -> None:
    shown = answered(big_lake(), True)
    for layer in (Layer.OPTIMAL, *ERRORS_AND_VISITS):
        view = GridView(shown.world, look())
        view.cell, view.wanted_layer = Size(3, 1), layer
        view.show(shown)
        rows = view.picture(shown, 28, 9)
        assert [row.cell_length for row in rows] == [28] * 9
        assert rows[-1].text.startswith(WORDS[layer])


async def test_v_turns_world_and_table_together_and_comes_back(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-slippery"), (120, 40)) as pilot:
        await train(pilot, 500)
        board = playground(pilot).board
        world, table = board.world, board.table
        assert world is not None
        seen = []
        for _ in table.layer_choices:
            assert world.drawn_layer is board.wanted_layer
            assert table.shown_layer in (board.wanted_layer, Layer.Q)
            seen.append(board.wanted_layer)
            await press(pilot, "v")
        assert seen == list(table.layer_choices)
        assert board.wanted_layer is Layer.Q


async def test_what_is_alone_in_view_turns(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-slippery")) as pilot:
        board = playground(pilot).board
        for panel in ("world", "table"):
            board.zoom(panel)
            await press(pilot, "v")
        assert board.wanted_layer is Layer.ERROR
        board.zoom(None)
        await press(pilot, "s")
        assert board.world is not None
        assert board.world.drawn_layer is board.table.shown_layer is Layer.ERROR


async def test_v_leaves_a_panel_without_layers_as_it_is(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), (120, 40)) as pilot:
        board = playground(pilot).board
        for panel in ("curve", "timeline"):
            board.panel(panel).focus()
            await press(pilot, "f", "v")
            assert (board.zoomed, board.wanted_layer) == (panel, Layer.Q)
            await press(pilot, "f")


def test_the_scale_of_values_gets_wider_whatever_layer_is_shown() -> None:
    steady, wider = SteadyScale(), learning()
    steady.of(wider, Layer.VISITS)
    assert steady.of(changed(wider, q=wider.agent.q * 0.5)) == SteadyScale().of(wider)


async def test_a_map_of_every_action_begins_with_their_values(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-slippery"), (160, 50)) as pilot:
        board = playground(pilot).board
        await press(pilot, "v", "v", "w", "a")
        assert board.wanted_layer is Layer.Q
        assert board.world is not None
        assert board.world.shows_actions
        assert "Q of every action" in board.world.heading
        await press(pilot, "v", "v")
        assert board.wanted_layer is Layer.ERROR
        assert "Q of every action" not in board.world.heading
