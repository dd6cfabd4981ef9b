from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from lane_samples import lane_views, paired, side_by_side
from samples import bandit, lake, look, student
from seams import sized
from snapshots import changed

from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.timeline.lane_view import LaneView
from rl_tui.screen.draw.number_form import SteadyForms
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.kit.value_scale import ValueScale
from rl_tui.screen.panels.q_table.layers import Figures
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.worlds.mdp.space import FloatArray


def table_of(
    snapshot: Snapshot, width: int = 44, layer: Layer = Layer.LANES, *, ascii_only: bool = False
) -> tuple[str, QTable]:
    table = sized(QTable(look(ascii_only)), width, 14)
    table.show(snapshot)
    table.wanted_layer = layer
    rows = table.picture(snapshot, width, 14)
    assert [row.cell_length for row in rows] == [width] * 14
    return "\n".join(row.text for row in rows), table


def with_tables(snapshot: Snapshot, own: FloatArray, other: FloatArray) -> Snapshot:
    first, second = lane_views(2)
    lanes: tuple[LaneView, ...] = (replace(first, q=other), replace(second, q=own))
    return paired(changed(snapshot, q=own, lanes=lanes, shown=1))


def test_the_layer_is_there_only_beside_another_run() -> None:
    _, alone = table_of(lake())
    assert Layer.LANES not in alone.layer_choices
    assert alone.shown_layer is Layer.Q
    _, table = table_of(side_by_side(2))
    assert table.layer_choices == (Layer.Q, Layer.OPTIMAL, Layer.ERROR, Layer.LANES, Layer.VISITS)
    assert table.shown_layer is Layer.LANES


def test_of_a_large_world_there_is_no_other_table() -> None:
    lanes = tuple(replace(lane, q=np.empty(0)) for lane in lane_views(2))
    assert Layer.LANES not in table_of(changed(side_by_side(2), lanes=lanes))[1].layer_choices


def test_it_shows_the_difference_with_colours_for_both_directions() -> None:
    own, other = np.zeros(44), np.zeros(44)
    own[0], other[1] = 0.5, 0.25
    snapshot = with_tables(lake(0), own, other)
    text, _ = table_of(snapshot)
    assert "0.500" in text
    assert "−0.250" in text
    figures = Figures(snapshot, Layer.LANES, look(), None, SteadyForms(), ValueScale())
    palette = look().palette
    assert figures.style(0) == palette.signed_value(1.0)
    assert figures.style(1) == palette.signed_value(-0.5)
    assert figures.style(2) == palette.unvisited  # neither has visited it
    assert figures.text(2, 6) == "·"


def test_the_title_says_whose_tables_they_are() -> None:
    assert table_of(side_by_side(2, 1), 60)[1].heading == "▸2 · Q of α 0.5 − Q of α 0.1"
    assert table_of(side_by_side(2, 0), 27)[1].heading == "▸1 · Q − Q of α 0.5"
    assert table_of(side_by_side(4, 3), 24)[1].heading == "▸4 · Q − Q of α 0.1"
    assert table_of(side_by_side(2), 44, Layer.Q)[1].heading == "▸1 · Q"


def test_in_a_list_the_difference_has_a_column() -> None:
    snapshot = student()
    beside = with_tables(snapshot, snapshot.agent.q, snapshot.agent.q - 1.0)
    text, _ = table_of(beside, 70)
    assert "Q−other" in text
    assert text.count("1.000") == 5
    narrow, _ = table_of(beside, 28)
    assert "Q−other" in narrow
    assert "Q−other" not in table_of(beside, 70, Layer.Q)[0]
    plain, _ = table_of(beside, 70, ascii_only=True)
    assert plain.isascii()


@pytest.mark.parametrize("width", [24, 34, 44, 60, 90])
def test_arms_have_the_column_too_and_keep_their_secrets(width: int) -> None:
    snapshot = bandit(400)
    text, _ = table_of(with_tables(snapshot, snapshot.agent.q, snapshot.agent.q - 1.0), width)
    assert "Q−other" in text
    assert "1.50" not in text
