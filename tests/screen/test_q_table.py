from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from drawn_tables import PALETTE, Drawn, fresh, lake_of
from samples import bandit, big_lake, lake, look, snapshot, student
from snapshots import changed, snapshot_of

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.library import recipe_for
from rl_tui.runs.run import Run
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.panels.q_table.layers import Figures
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.screen.panels.q_table.sheet import COMPUTING, FOLLOW_HINT
from rl_tui.worlds.drawing import Graph
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.mdp.tabular_mdp import Outcome, Transition, tabular_mdp
from rl_tui.worlds.world import World


def test_rows_are_live_states_and_columns_actions() -> None:
    drawn = Drawn(lake())
    assert drawn.rows[0].split() == ["↑", "→", "↓", "←"]
    states = [row.replace("◉", " ").split()[0] for row in drawn.rows[1:12]]
    assert states == ["0", "1", "2", "3", "4", "6", "8", "9", "10", "13", "14"]
    assert not "".join(drawn.rows[12:]).strip()
    assert drawn.table.heading == "Q"
    assert drawn.table.rows_of(lake()) == 11
    assert drawn.row("6").startswith("◉ 6")
    assert drawn.text.count("◉") == 1


def test_every_number_is_printed_where_its_pair_stands() -> None:
    state = lake()
    rows = Drawn(state, 56, 12, Layer.OPTIMAL).rows
    assert state.exact_answer.solution is not None
    for row, live in zip(rows[1:], (0, 1, 2, 3, 4, 6, 8, 9, 10, 13, 14), strict=True):
        numbers = [
            float(word) for word in row.replace("▌", " ").replace("▐", " ").replace("◉", " ").split()[1:]
        ]
        first = int(state.world.space.first_pair[live])
        shown = state.exact_answer.solution.q[first : first + 4][::-1]  # ↑ → ↓ ←
        assert numbers == [round(value, 3) for value in shown]


def test_all_exact_ties_are_framed_and_none_where_nothing_is_known() -> None:
    assert "▌" not in Drawn(lake(0)).text
    drawn = Drawn(lake_of({0: 0.1, 1: 0.5, 2: 0.5, 3: 0.1 + 0.2 + 0.2}))
    assert drawn.row("0").count("▌") == drawn.row("0").count("▐") == 3
    nearly = Drawn(lake_of({0: 0.5, 1: math.nextafter(0.5, 0.0), 2: 0.1, 3: 0.1}))
    assert nearly.row("0").count("▌") == 1
    assert "▌" not in nearly.row("1")


def test_of_equal_values_none_is_framed() -> None:
    assert "▌" not in Drawn(lake_of({0: 0.0})).row("0")


def test_the_frames_of_the_exact_layer_are_the_ties_of_the_solution() -> None:
    drawn = Drawn(lake(), layer=Layer.OPTIMAL)
    assert drawn.row("6").count("▌") == 2  # left and right are equally good there
    assert drawn.table.heading == "Q*, exact"


def test_unvisited_differs_from_zero() -> None:
    drawn = Drawn(lake_of({0: 0.0, 1: 0.7}))
    assert drawn.row("0").split() == ["◉", "0", "·", "·", "▌0.700▐", "0.000"]
    assert drawn.style_of(1, "·") == PALETTE.unvisited
    assert drawn.style_of(1, "0.000") == PALETTE.value(0.0)
    assert drawn.style_of(1, "0.700") == PALETTE.value(1.0)
    hopeful = Drawn(changed(lake(0), q=np.full(44, 2.0)))
    assert hopeful.row("1").split() == ["1", "2.000", "2.000", "2.000", "2.000"]
    assert hopeful.style_of(1, "2.000") == PALETTE.unvisited


def test_the_signed_layer_is_tinted_around_zero() -> None:
    state = lake_of({0: 0.2, 1: 0.9})
    exact = lake().exact_answer.solution
    assert exact is not None
    target = replace(exact, q=np.full(44, 0.5))
    drawn = Drawn(changed(state, solution=target), layer=Layer.ERROR)
    assert drawn.table.heading == "Q − Q*"
    assert drawn.style_of(1, "−.300") == PALETTE.signed_value(-0.3 / 0.4)
    assert drawn.style_of(1, ".400") == PALETTE.signed_value(1.0)
    assert drawn.style_of(1, "−.500") == PALETTE.unvisited


def test_visits_are_tinted_by_their_logarithm() -> None:
    visits = [0, 9, 99, 9_999, *([0] * 40)]
    drawn = Drawn(fresh(lake(0), [0.0] * 44, visits), layer=Layer.VISITS)
    assert drawn.row("0").replace("▌", " ").replace("▐", " ").split() == ["◉", "0", "9,999", "99", "9", "·"]
    assert drawn.style_of(1, "9,999") == PALETTE.visit_count(1.0)
    assert drawn.style_of(1, "   99") == PALETTE.visit_count(0.5)


@pytest.mark.parametrize("layer", [Layer.OPTIMAL, Layer.ERROR])
def test_without_an_exact_answer_the_panel_says_why(layer: Layer) -> None:
    assert COMPUTING in Drawn(lake(solution=None), layer=layer).text
    reason = "state 5 cannot reach an end"
    refused = Drawn(lake(solution=None, refused=reason), 60, 5, layer)
    assert f"No exact values: {reason}" in refused.text
    assert "0." in Drawn(lake(solution=None, refused=reason)).text


def test_the_cell_just_updated_is_marked_while_steps_can_be_followed() -> None:
    state = big_lake()
    assert state.counters.last_step is not None
    assert "▐.21▐" in Drawn(state, 56, 28).text
    drawn = Drawn(lake())
    assert PALETTE.good in [segment.style for segment in drawn.strips[6] if segment.text == "▐"]
    assert "▴" in Drawn(lake(), 56).rows[6]
    for dark in (
        Drawn(lake(), lights=False),
        Drawn(lake(phase=Phase.RUNNING, speed=None)),
        Drawn(lake(phase=Phase.RUNNING, speed=100.0)),
        Drawn(lake(), layer=Layer.OPTIMAL),
    ):
        assert PALETTE.good not in [segment.style for segment in dark.strips[6]]
    assert PALETTE.good in [each.style for each in Drawn(lake(phase=Phase.RUNNING, speed=30.0)).strips[6]]


def test_a_value_beyond_the_scale_of_the_map_has_the_colour_of_its_end() -> None:
    drawn = Drawn(lake_of({0: 1.0, 1: 0.5, 2: -50.0, 4: 0.6}), 56, 17)
    cell = next(segment for segment in drawn.strips[1] if "−50" in segment.text)
    assert cell.style == PALETTE.value(0.0)


def test_a_narrow_table_of_states_and_actions_has_no_gaps() -> None:
    drawn = Drawn(lake(), 26, 11)
    assert drawn.rows[0].split() == ["↑", "→", "↓", "←"]
    states = [row.replace("◉", " ").split()[0] for row in drawn.rows[1:]]
    assert states == ["0", "1", "2", "3", "4", "6", "8", "9", "10", "13"]
    wide = Drawn(lake(), 30, 11)
    assert [row[4:24].split() for row in drawn.rows[1:3]] == [row[4:28].split() for row in wide.rows[1:3]]
    assert Drawn(lake(), 24, 11).rows[0].split()[0].startswith("sta")


def test_a_long_table_says_how_many_of_its_rows_are_in_view() -> None:
    assert Drawn(big_lake(), 44, 17).table.footing.startswith("16 of 53 · v ")


def test_a_long_table_scrolls_and_follows_the_agent() -> None:
    drawn = Drawn(big_lake())
    assert "◉28" in drawn.text
    assert FOLLOW_HINT not in drawn.table.footing
    assert any(row.endswith("█") for row in drawn.rows)
    for state in (0, 62, 33):
        rows = [strip.text for strip in drawn.table.picture(changed(big_lake(), state=state), 36, 17)]
        assert any(row.startswith(f"◉{state:>2}") for row in rows)


def test_the_layout_does_not_change_with_the_first_negative_number() -> None:
    start = big_lake(step=0)
    mdp = start.world.mdp
    costly = replace(start.world, space=replace(mdp, reward=mdp.reward - 1.0))
    before = changed(start, world=costly)
    heads = [Drawn(each, 56, 28).rows[0].split() for each in (start, before)]
    assert heads == [["↑", "→", "↓", "←"] * 2, ["↑", "→", "↓", "←"]]
    after = changed(before, q=start.agent.q - 5.0)
    assert Drawn(after, 56, 28).rows[0] == Drawn(before, 56, 28).rows[0]


def test_two_blocks_stand_side_by_side_where_that_saves_scrolling() -> None:
    drawn = Drawn(big_lake(), 56, 28)
    assert drawn.rows[0].split() == ["↑", "→", "↓", "←"] * 2
    assert "◉28" in drawn.rows[1]
    assert FOLLOW_HINT not in drawn.table.footing
    numbers = [
        word for row in drawn.rows[1:] for word in (row[:3].strip("◉ "), row[28:31].strip("◉ ")) if word
    ]
    assert sorted(map(int, numbers)) == [state for state in range(63) if str(state) in numbers]
    assert len(numbers) == 53


def test_signs_are_worth_more_than_a_second_block() -> None:
    assert "−0.169" in Drawn(big_lake(), 56, 28, Layer.ERROR).text


def test_an_action_that_is_not_legal_leaves_its_cell_empty() -> None:
    def goes(state: int) -> tuple[Outcome, ...]:
        return (Outcome(1.0, state, 1.0, False),)

    mdp = tabular_mdp(
        ("high", "low"),
        ("search", "wait", "recharge"),
        [
            Transition(0, 0, goes(1)),
            Transition(0, 1, goes(0)),
            Transition(1, 0, goes(0)),
            Transition(1, 1, goes(1)),
            Transition(1, 2, goes(0)),
        ],
        {0: 1.0},
    )
    base = student(0)
    world = World(mdp, Graph(((0, 0), (1, 0))))
    state = snapshot(
        world, base.recipe.scenario, Hyperparameters(), q=np.arange(5.0), visits=np.ones(5, dtype=np.int64)
    )
    rows = Drawn(state, 50, 4).rows
    assert rows[0].split() == ["search", "wait", "recharge"]
    assert rows[1].replace("▌", " ").replace("▐", " ").split() == ["◉high", "0.000", "1.000"]
    assert rows[2].replace("▌", " ").replace("▐", " ").split() == ["low", "2.000", "3.000", "4.000"]
    assert rows[1].index("1.000") == rows[2].index("3.000")


def test_numbers_that_left_all_bounds_are_still_drawn() -> None:
    q = [math.nan, math.inf, -1e12, 5.0, *([0.0] * 40)]
    text = Drawn(fresh(lake(0), q, [1] * 44)).row("0")
    assert "nan" in text
    assert "inf" in text


@pytest.mark.parametrize("state", [big_lake(), student(), bandit()])
def test_every_layer_fits_every_size_and_ascii_needs_no_other_characters(state: Snapshot) -> None:
    for layer in Layer:
        for width, height in ((1, 7), (13, 1), (21, 3), (36, 17), (56, 2), (120, 40)):
            Drawn(state, width, height, layer, revealed=True)
        drawn = Drawn(state, 44, 12, layer, revealed=True, ascii_only=True)
        drawn.text.encode("ascii")
        drawn.table.redraw()
        assert drawn.table.foot is not None
        drawn.table.foot.encode("ascii")


def test_only_rows_in_view_are_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: set[int] = set()
    text = Figures.text

    def counted(self: Figures, pair: int, width: int) -> str:
        seen.add(pair)
        return text(self, pair, width)

    monkeypatch.setattr(Figures, "text", counted)
    Drawn(big_lake(), 36, 6)
    assert len(seen) == 5 * 4


def test_the_footing_names_the_layers_and_reverses_the_one_in_force() -> None:
    def reversed_text() -> str:
        pieces = drawn.table.foot_pieces(drawn.table.footing, drawn.table.look)
        assert "".join(each.text for each in pieces) == drawn.table.footing
        return "".join(each.text for each in pieces if each.style and each.style.reverse)

    drawn = Drawn(lake())
    assert drawn.table.footing == "v  Q  Q*  Q−Q*  visits "
    assert reversed_text() == " Q "
    drawn.table.wanted_layer = Layer.OPTIMAL
    drawn.table.picture(lake(), 36, 17)
    assert drawn.table.footing == "v  Q  Q*  Q−Q*  visits "
    assert reversed_text() == " Q* "
    assert Drawn(lake(), 18, 10).table.footing == "v  Q  Q*  Q−Q* "  # the last ones are dropped
    assert Drawn(student(), 14, 10, Layer.VISITS).table.footing == "v  Q  visits "
    assert Drawn(changed(bandit(), phase=Phase.PAUSED), 30, 12).table.footing == "v  Q  visits "


@pytest.mark.parametrize(
    ("scenario", "width", "head"),
    [
        ("cartpole", 60, "ang, vel"),
        ("cartpole", 38, "ang, vel"),
        ("taxi", 38, "r,c p→d"),
        ("blackjack", 44, "sum,card,ace"),
        ("blackjack", 32, "sum,card,ace"),
        ("frozenlake", 60, ""),
    ],
)
def test_the_parts_of_state_names_have_a_heading(scenario: str, width: int, head: str) -> None:
    snapshot = snapshot_of(Run(recipe_for(find(scenario), {}, 0), evaluate=False))
    row = QTable(look()).picture(snapshot, width, 12)[0].text
    assert row[1:].startswith(f"{head} ")


def test_hands_that_never_come_up_have_no_row() -> None:
    snapshot = snapshot_of(Run(recipe_for(find("blackjack"), {}, 0), evaluate=False))
    assert QTable(look()).rows_of(snapshot) == 180 + 100
