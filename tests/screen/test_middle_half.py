"""The band of the middle half."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn_curves import drawn
from lane_samples import lane_views
from samples import answered, bandit, lake, look, student
from snapshots import changed

from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.history import History
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.draw.scale import Scale
from rl_tui.screen.panels.curve.area import band_cells, band_styles, middle_half, pixel_styles
from rl_tui.screen.panels.curve.curve import ReturnCurve
from rl_tui.screen.panels.curve.moving_mean import moving_mean, window_of
from rl_tui.screen.panels.curve.text import MEAN_AND_BAND

SIZE = (90, 9)


def of(returns: np.ndarray) -> Snapshot:
    history = History()
    history.add(returns, np.arange(len(returns)) % 7 + 1)
    mean = float(returns[-100:].mean())
    return student(
        episodes=len(returns),
        curve=history.curve(),
        greedy_return=None,
        expected_return=None,
        return_last_100=mean,
    )


def spread(width: float = 1.0, count: int = 2_000) -> np.ndarray:
    return np.linspace(0.0, 8.0, count) + np.random.default_rng(0).uniform(-width, width, count)


def has_band(snapshot: Snapshot, size: tuple[int, int] = SIZE, **how: bool) -> bool:
    return MEAN_AND_BAND in drawn(snapshot, size, **how)[1].heading


def test_the_band_is_drawn_where_it_says_something() -> None:
    assert has_band(of(spread()))


@pytest.mark.parametrize(
    "returns",
    [
        spread(0.1),  # thinner than 5 % of the axis
        np.random.default_rng(0).uniform(-20.0, 20.0, 2_000),  # above the axis of the means
        np.random.default_rng(0).integers(0, 5, 2_000) * 2.0,  # only five values
        np.where(np.arange(2_000) % 8, spread(1.0), -60.0),  # the mean is outside the band
    ],
    ids=["thin", "high", "few values", "mean outside"],
)
def test_the_band_is_not_drawn_where_it_would_not_help_or_lie(returns: np.ndarray) -> None:
    assert not has_band(of(returns))


def test_a_narrow_heading_names_the_window_rather_than_the_band() -> None:
    _, widget = drawn(of(spread()), (44, 9))
    assert widget.heading == "Return · mean of the last 100"


def test_it_takes_seven_rows_and_shades() -> None:
    shown = of(spread())
    assert has_band(shown, (90, 7))
    assert not has_band(shown, (90, 6))
    assert not has_band(shown, ascii=True)
    for depth, there in (("256", True), ("16", False), ("none", False)):
        widget = ReturnCurve(look(depth=depth))
        widget.picture(answered(shown), *SIZE)
        assert (MEAN_AND_BAND in widget.heading) is there


def test_steps_pulls_and_runs_side_by_side_have_none() -> None:
    curve = of(spread()).results.curve
    lanes = tuple(changed(lane, curve=curve) for lane in lane_views(2))
    assert not has_band(changed(lake(curve=curve, episodes=2_000), lanes=lanes))
    assert not has_band(bandit(curve=replace(curve, episode=curve.episode // 2 + 1)))


def test_in_a_run_it_comes_and_goes_with_an_axis_only() -> None:
    widget, thin = ReturnCurve(look()), of(spread(0.1))
    assert not has_band(thin)
    widget.picture(changed(of(spread()), phase=Phase.RUNNING), *SIZE)
    axis = widget.scale
    widget.picture(changed(thin, phase=Phase.RUNNING), *SIZE)
    assert widget.scale == axis
    assert MEAN_AND_BAND in widget.heading
    widget.picture(thin, *SIZE)
    assert MEAN_AND_BAND not in widget.heading


@pytest.mark.parametrize("count", [40, 900, 5_000, 100_000])
def test_quartiles_are_those_of_the_window_as_far_as_single_returns_are_kept(count: int) -> None:
    returns = np.random.default_rng(1).normal(size=count)
    curve = of(returns).results.curve
    window = window_of([curve], float(count), is_compared=False)
    mean = moving_mean(curve.episode, curve.return_mean, window)
    plot = Plot(0, 20, 9, float(count), Scale(-1.0, 1.0, 1.0))
    found = middle_half(plot, curve, mean)
    every = curve.sample_every
    for column in range(20):
        end = int(np.ceil((column + 1) * count / 20))
        places = [place for place in range(max(0, end - mean.window), end) if place % every == 0]
        inside = np.sort(returns[places])
        last = len(inside) - 1
        assert found.low[column] == inside[round(0.25 * last)]
        assert found.high[column] == inside[round(0.75 * last)]


def test_no_pixel_of_the_page_is_below_mean_or_band() -> None:
    shown = of(spread(3.0, 300))
    curve = shown.results.curve
    window = window_of([curve], 300.0, is_compared=False)
    mean = moving_mean(curve.episode, curve.return_mean, window)
    plot = Plot(0, 50, 9, 300.0, Scale(-1.0, 10.0, 1.0))
    codes, kinds = band_cells(plot, middle_half(plot, curve, mean), mean)
    pixels = np.stack((kinds // 4, kinds % 4), axis=1).reshape(18, 50)
    assert set(np.unique(pixels)) == {0, 1, 2, 3}
    for column in pixels.T:
        begins = np.flatnonzero(column > 0)
        assert (column[begins[0] :] > 0).all() if len(begins) else True
    assert ((codes > 0) == (kinds > 0)).all()


def test_cells_have_the_colours_of_their_pixels() -> None:
    for depth in ("truecolor", "256"):
        palette = look(depth=depth).palette
        colours = [None, *(style.color for style in pixel_styles(palette))]
        styles = band_styles(palette)
        assert len(set(colours)) == 4
        assert (styles[4 * 3 + 2].color, styles[4 * 3 + 2].bgcolor) == (colours[3], colours[2])
        assert (styles[4 * 0 + 1].color, styles[4 * 0 + 1].bgcolor) == (colours[1], None)
