from __future__ import annotations

import math
from typing import Any

import pytest
from result_samples import EPSILONS, STEP_SIZES, grid, runs, sweep

from rl_tui.common.errors import UserError
from rl_tui.studies.pictures.layout import laid_out
from rl_tui.studies.pictures.picture import AtlasChart, Chart, Picture, kept_range
from rl_tui.studies.pictures.reading import results_of
from rl_tui.studies.pictures.results import picture_of
from rl_tui.studies.pictures.shapes import Text
from rl_tui.studies.pictures.tables import CurveTable

CURVE = {
    "episode": [1.0, 2.0, 3.0],
    "return_mean": [1.0, 2.0, 3.0],
    "return_stderr": [0.5, 0.25, 0.125],
    "length_mean": [9.0, 8.0, 7.0],
}


def drawn(*documents: dict[str, Any], **wanted: str) -> Picture:
    return picture_of([results_of(each, "results.json") for each in documents], **wanted)


def chart_of(picture: Picture) -> Chart:
    (chart,) = picture.panels
    assert isinstance(chart, Chart)
    return chart


def atlas_of(picture: Picture) -> AtlasChart:
    (atlas,) = picture.panels
    assert isinstance(atlas, AtlasChart)
    return atlas


def test_a_curve_has_the_interval_of_its_mean_around_it() -> None:
    picture = drawn(runs(CURVE, count=3))
    (curve,) = chart_of(picture).curves
    assert curve.y == (1.0, 2.0, 3.0)
    # Student's t with two degrees of freedom reaches 4.303 standard errors
    assert curve.high == pytest.approx((1 + 4.3027 / 2, 2 + 4.3027 / 4, 3 + 4.3027 / 8), abs=1e-4)
    assert curve.low == pytest.approx((1 - 4.3027 / 2, 2 - 4.3027 / 4, 3 - 4.3027 / 8), abs=1e-4)
    assert picture.title == "cliff, sarsa"
    assert picture.band


def test_where_the_number_of_runs_is_not_known_it_is_the_normal_one() -> None:
    (curve,) = chart_of(picture_of([CurveTable("mine", CURVE, None)])).curves
    assert curve.high[0] == pytest.approx(1 + 1.96 / 2)


def test_one_run_has_no_band() -> None:
    picture = drawn(runs({**CURVE, "return_stderr": [None] * 3}, count=1))
    assert set(chart_of(picture).curves[0].low) == {None}
    assert picture.band == ""


def test_several_curves_stand_in_one_chart_by_different_names() -> None:
    picture = drawn(runs(CURVE), runs(CURVE), runs(CURVE, algorithm="q-learning"), measure="length_mean")
    chart = chart_of(picture)
    assert [curve.name for curve in chart.curves] == [
        "cliff, sarsa (1)",
        "cliff, sarsa (2)",
        "cliff, q-learning",
    ]
    assert len({curve.colour for curve in chart.curves}) == 3
    assert chart.curves[0].y == (9.0, 8.0, 7.0)
    assert chart.curves[0].low == (None, None, None)  # these have no standard errors


def test_the_first_episodes_do_not_spoil_the_axis_and_that_is_said() -> None:
    returns = [-900.0, -100.0, *[-30.0, -28.0, -26.0] * 20]
    columns = {"episode": [float(x + 1) for x in range(len(returns))], "return_mean": returns}
    picture = drawn(runs(columns))
    assert chart_of(picture).y.low > -100
    assert any("down to −900" in note for note in picture.notes)


def test_one_number_is_a_curve_with_a_line_for_each_word() -> None:
    cells = [{"alpha": alpha, "algorithm": name} for name in ("sarsa", "q-learning") for alpha in STEP_SIZES]
    chart = chart_of(drawn(sweep(*cells)))
    assert [curve.name for curve in chart.curves] == ["sarsa", "q-learning"]
    assert chart.curves[0].x == STEP_SIZES
    assert chart.curves[0].y == pytest.approx((0.51, 0.6, 1.5))
    assert chart.curves[1].y == pytest.approx((0.26, 0.35, 1.25))
    assert chart.curves[0].high == pytest.approx((1.51, 1.6, 2.5))
    assert chart.x.logarithmic
    assert chart.x.label == "α (alpha)"


def test_two_numbers_are_an_atlas() -> None:
    picture = drawn(sweep(*grid()))
    atlas = atlas_of(picture)
    assert atlas.columns == ("0.01", "0.1", "1")
    assert atlas.rows == ("0", "0.1")
    for row, epsilon in enumerate(EPSILONS):
        assert atlas.values[row] == pytest.approx([alpha + epsilon for alpha in STEP_SIZES])
    assert atlas.best == (0, 0)
    assert atlas.marked == {(1, 0)}
    assert all(
        0.0 <= atlas.scale.share(value) <= 1.0 for row in atlas.values for value in row if value is not None
    )


def test_a_third_setting_has_a_panel_for_each_value_on_one_scale() -> None:
    picture = drawn(sweep(*grid("sarsa", "q-learning")))
    assert [panel.title for panel in picture.panels] == ["sarsa", "q-learning"]
    first, second = picture.panels
    assert isinstance(first, AtlasChart)
    assert isinstance(second, AtlasChart)
    assert first.scale == second.scale
    assert (first.best, second.best) == ((0, 0), None)
    assert second.marked == {(0, 0)}


def test_axes_and_measure_can_be_chosen() -> None:
    document = sweep(*grid("sarsa", "q-learning"))
    by_epsilon = chart_of(drawn(document, x="epsilon"))
    assert [curve.name for curve in by_epsilon.curves][:2] == ["α = 0.01, sarsa", "α = 0.01, q-learning"]
    turned = drawn(document, x="epsilon", y="alpha")
    assert [panel.title for panel in turned.panels] == ["sarsa", "q-learning"]
    words = drawn(document, x="alpha", y="algorithm")
    assert [panel.title for panel in words.panels] == ["ε = 0", "ε = 0.1"]
    arrival = drawn(document, measure="arrival").panels[0]
    assert isinstance(arrival, AtlasChart)
    assert {value for row in arrival.values for value in row} == {7.0}
    # another metric compares the cells, and so nothing is marked
    assert (arrival.best, arrival.marked) == (None, set())
    assert any("not arrived" in note for note in drawn(document, measure="arrival").notes)


def test_each_world_has_a_best_cell_of_its_own() -> None:
    cells = [{"scenario": name, **cell} for name in ("cliff", "maze") for cell in grid()]
    document = sweep(*cells, best=None, bests=[cells[1], cells[-1]])
    picture = drawn(document)
    assert picture.title == "return per episode"
    first, second = picture.panels
    assert isinstance(first, AtlasChart)
    assert isinstance(second, AtlasChart)
    assert (first.title, second.title) == ("cliff", "maze")
    assert (first.best, second.best) == ((1, 0), (1, 2))


def test_words_alone_are_points_with_intervals() -> None:
    chart = chart_of(drawn(sweep({"algorithm": "sarsa"}, {"algorithm": "q-learning"})))
    assert not chart.connected
    assert chart.x.labels == ("sarsa", "q-learning")
    assert chart.curves[0].y == (0.5, 0.25)


def test_a_cell_that_is_missing_stays_empty() -> None:
    atlas = atlas_of(drawn(sweep(*grid()[:-1])))
    assert atlas.values[1][2] is None


def test_means_of_some_runs_alone_are_told() -> None:
    document = sweep(*grid())
    assert drawn(document).notes == ()
    document["cells"][2]["area"]["count"] = 17
    assert any("leave out runs" in note for note in drawn(document).notes)


@pytest.mark.parametrize(
    ("wanted", "said"),
    [
        ({"measure": "regret"}, "--measure regret is not in these results: choose area or arrival"),
        ({"x": "gamma"}, "--x gamma is not in these results"),
        ({"y": "gamma"}, "--y gamma is not in these results"),
        ({"x": "alpha", "y": "alpha"}, "choose two settings"),
    ],
)
def test_names_that_are_not_there(wanted: dict[str, str], said: str) -> None:
    with pytest.raises(UserError, match=said):
        drawn(sweep(*grid()), **wanted)


def test_too_much_for_one_picture() -> None:
    many = [{"alpha": alpha, "n": float(n)} for n in range(15) for alpha in STEP_SIZES]
    with pytest.raises(UserError, match=r"15 lines are too many .* --y n"):
        drawn(sweep(*many), x="alpha")
    more = [{**cell, "epsilon": epsilon} for cell in many for epsilon in EPSILONS]
    with pytest.raises(UserError, match="15 maps are too many"):
        drawn(sweep(*more), x="alpha", y="epsilon")


def test_too_many_files() -> None:
    with pytest.raises(UserError, match="15 curves are too many"):
        drawn(*[runs(CURVE)] * 15)


def test_a_measure_that_no_cell_has() -> None:
    document = sweep(*grid())
    for cell in document["cells"]:
        cell["area"] = dict.fromkeys(cell["area"])
    with pytest.raises(UserError, match="no cell has a value of area"):
        drawn(document)


def test_what_does_not_go_together() -> None:
    with pytest.raises(UserError, match="cannot share a chart"):
        drawn(sweep(*grid()), runs(CURVE))
    with pytest.raises(UserError, match="for sweeps"):
        drawn(runs(CURVE), x="alpha")
    with pytest.raises(UserError, match="has no optimal_action_rate"):
        drawn(runs(CURVE), measure="optimal_action_rate")
    with pytest.raises(UserError, match="choose --measure return_mean or"):
        drawn(runs(CURVE), measure="return_stderr")


def test_what_lies_far_off_does_not_count() -> None:
    assert kept_range([1.0, 2.0, 3.0, 4.0, 1000.0]) == (1.0, 4.0)
    assert kept_range([1.0, 2.0, 3.0, 4.0, 9.0]) == (1.0, 9.0)
    assert kept_range([5.0, 5.0, 5.0, 6.0]) == (5.0, 6.0)
    assert math.isclose(sum(kept_range([2.0])), 4.0)


@pytest.mark.parametrize("measure", ["area", "V" * 100_000], ids=["short", "long"])
def test_words_of_100_000_letters_are_cut(measure: str) -> None:
    word = "W" * 100_000
    cells = [
        {word: word + end, "alpha": each, measure: {"mean": each}} for end in "ab" for each in (0.1, 0.2)
    ]
    document = {"scenario": word, "measures": [measure], "cells": cells}
    for x in ("alpha", word):
        for y in (None, word if x == "alpha" else "alpha"):
            page = laid_out(picture_of([results_of(document, "a.json")], x=x, y=y))
            texts = [each.text for each in page.shapes if isinstance(each, Text)]
            assert sum(text.count("W") + text.count("w") for text in texts) > 20
            assert max(map(len, texts)) < 250


def test_numbers_closer_than_their_logarithms_have_an_axis() -> None:
    cells = [{"alpha": 1e16 + each, "area": {"mean": each}} for each in (0.0, 2.0, 4.0)]
    table = results_of({"measures": ["area"], "cells": cells}, "a.json")
    assert laid_out(picture_of([table])).height > 0
