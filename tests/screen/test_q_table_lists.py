"""Q-tables of few pairs."""

from __future__ import annotations

import pytest
from drawn_tables import Drawn, fresh
from samples import bandit, student
from snapshots import changed

from rl_tui.live.snapshot import Phase
from rl_tui.screen.kit.layers import Layer


def test_few_pairs_are_listed_a_row_each() -> None:
    drawn = Drawn(student())
    assert drawn.table.heading == "Q"
    assert drawn.table.rows_of(student()) == 7
    assert drawn.rows[0].split() == ["state", "action", "Q", "N"]
    assert drawn.rows[1].split() == ["Class", "study", "▐", "6.370▐", "1,204"]
    assert drawn.rows[2].split() == ["check", "phone", "5.137", "133"]
    assert drawn.rows[5].split() == ["◉Pass", "sleep", "10.000", "963"]
    assert "greedy: study · quit · sleep" in drawn.rows[7]


def test_a_wide_list_shows_beside_q_what_the_layer_in_force_is_about() -> None:
    for layer, shown in (
        (Layer.Q, ["Q"]),
        (Layer.OPTIMAL, ["Q", "Q*"]),
        (Layer.ERROR, ["Q", "Q*", "Q−Q*"]),
        (Layer.VISITS, ["Q"]),
    ):
        assert Drawn(student(), 56, 10, layer).rows[0].split() == ["state", "action", *shown, "N"]
    drawn = Drawn(student(), 56, 10, Layer.ERROR)
    assert drawn.rows[1].split() == ["Class", "study", "▐", "6.370▐", "6.341", "▐", "0.029", "1,204"]


@pytest.mark.parametrize("layer", [Layer.Q, Layer.VISITS])
def test_a_list_does_not_give_the_answer_away_before_it_is_asked_for(layer: Layer) -> None:
    drawn = Drawn(student(), 56, 10, layer)
    assert drawn.rows[0].split() == ["state", "action", "Q", "N"]
    assert "6.341" not in drawn.text
    assert "0.029" not in drawn.text


def test_a_very_narrow_list_keeps_the_number_of_the_layer_in_force() -> None:
    assert "6.370" in Drawn(student(), 16, 10).text
    assert "1,204" not in Drawn(student(), 16, 10).text
    drawn = Drawn(student(), 16, 10, Layer.VISITS)
    assert drawn.rows[0].split()[-1] == "N"
    assert "1,204" in drawn.text
    assert "6.370" not in drawn.text


def test_a_narrow_list_shows_the_layer_in_force() -> None:
    drawn = Drawn(student(), layer=Layer.OPTIMAL)
    assert drawn.rows[0].split() == ["state", "action", "Q*", "N"]
    assert "▌ 6.341▐" in drawn.rows[1]


def test_ties_are_joined_in_the_greedy_line() -> None:
    tied = fresh(student(), [1.0, 1.0, 0.0, 2.0, 0.0], [1, 1, 1, 1, 0])
    assert "greedy: study=check phone · quit · not tried" in Drawn(tied, 56, 10).text


def test_a_bandit_keeps_its_means_until_they_are_revealed() -> None:
    hidden = Drawn(changed(bandit(), phase=Phase.PAUSED), 36, 13)
    assert hidden.rows[0].split() == ["arm", "Q", "N", "share"]
    assert "1.500" not in hidden.text
    assert hidden.table.layer_choices == (Layer.Q, Layer.VISITS)
    assert "show the true means" in hidden.rows[12]
    assert hidden.row("5").split()[:3] == ["◉", "5", "▐"]
    shown = Drawn(bandit(), 36, 13, revealed=True)
    assert "1.500" in shown.rows[6]
    assert "···" not in shown.text
    assert shown.table.layer_choices == (Layer.Q, Layer.OPTIMAL, Layer.ERROR, Layer.VISITS)


def test_visits_of_arms_have_the_frames_while_they_are_shown() -> None:
    for layer, marked in ((Layer.Q, "Q"), (Layer.VISITS, "N")):
        drawn = Drawn(bandit(), 36, 13, layer)
        row, end = drawn.row("5"), drawn.rows[0].index(marked) + 2
        assert row[end - 9 : end].strip()[0] == "▐", (layer, row)
        assert row.count("▐") + row.count("▌") in (2, 3)  # Q was updated as well


def test_a_hidden_layer_falls_back_to_q() -> None:
    drawn = Drawn(bandit(400), layer=Layer.ERROR, revealed=True)
    assert drawn.table.heading.startswith("Q − Q*")
    drawn.table.show(bandit(400))
    assert drawn.table.shown_layer is Layer.Q


def test_the_bar_of_an_arm_is_its_share_of_the_pulls() -> None:
    rows = Drawn(changed(bandit(), phase=Phase.PAUSED), 56, 13).rows
    lengths = [row.count("█") for row in rows[1:11]]
    assert lengths[5] == max(lengths)
    assert lengths[5] / 20 == pytest.approx(0.842, abs=0.05)


def test_names_are_worth_more_than_visits() -> None:
    narrow = Drawn(student(), 27, 10)
    assert narrow.rows[0].split() == ["state", "action", "Q"]
    assert "check ph" in narrow.text
    assert "1,204" in Drawn(student(), 27, 10, Layer.VISITS).text
