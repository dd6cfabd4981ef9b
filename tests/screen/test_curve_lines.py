"""The axes, area and lines of the curve."""

from __future__ import annotations

import numpy as np
import pytest
from colour_vision import luminance
from drawn_curves import NO_MARKS, WIDE, drawn, flat, steps
from samples import answered, lake, look, marks, planning, student
from snapshots import changed

from rl_tui.live.snapshot import Phase
from rl_tui.runs.results import Curve
from rl_tui.runs.timeline.branches import Branch, Timeline
from rl_tui.screen.draw import braille
from rl_tui.screen.draw.axes import apart, draw_value_axis
from rl_tui.screen.draw.braille import Steps
from rl_tui.screen.draw.canvas import Canvas
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.draw.scale import (
    Scale,
    round_range,
    round_scale,
    settled,
    tick_label,
    tick_step,
    tight_scale,
)
from rl_tui.screen.panels.curve.area import area_of, area_styles
from rl_tui.screen.panels.curve.curve import ReturnCurve
from rl_tui.screen.panels.curve.data import curve_data
from rl_tui.screen.panels.curve.moving_mean import MovingMean, moving_mean, window_of
from rl_tui.screen.panels.curve.text import GREEDY, OPTIMAL

# Axes


@pytest.mark.parametrize(
    ("low", "high", "scale"),
    [
        (0.0, 1.0, Scale(0.0, 1.0, 0.5)),
        (0.0, 0.0, Scale(0.0, 1.0, 1.0)),
        (-4.0, 7.5, Scale(-5.0, 10.0, 5.0)),
        (-100.0, -13.0, Scale(-100.0, 0.0, 50.0)),
        (3.0, 5.0, Scale(0.0, 6.0, 2.0)),
        (0.0, 0.0021, Scale(0.0, 0.0025, 0.001)),
        (-600.0, 8.0, Scale(-600.0, 100.0, 200.0)),
        (-10_000.0, 8.0, Scale(-10_000.0, 2_500.0, 5_000.0)),
    ],
)
def test_vertical_axes_are_round_and_hold_zero(low: float, high: float, scale: Scale) -> None:
    found = round_scale(low, high)
    assert (found.low, found.high, found.step) == pytest.approx((scale.low, scale.high, scale.step))
    assert 2 <= len(found.ticks) <= 4


@pytest.mark.parametrize("best", [0.0, 0.7, 8.0, 90.0, 1_000.0])
def test_no_end_of_a_vertical_axis_is_empty_and_it_grows_in_few_steps(best: float) -> None:
    lows, scale, changes = np.geomspace(1e-3, 1e5, 4_000), None, 0
    for low in -lows:
        before, scale = scale, settled(scale, low, best)
        changes += scale is not before
        assert scale.low <= low + 1e-9
        assert best <= scale.high + 1e-9
        closest = round_scale(low, best)
        assert max(low - closest.low, closest.high - best) <= 0.28 * (closest.high - closest.low) + 1e-9
        assert 2 <= len(closest.ticks) <= 4
    assert changes <= 8 * 19


@pytest.mark.parametrize(
    ("low", "high", "ends"),
    [
        (0.0, 0.74, (0.0, 0.8)),
        (-96.0, -13.0, (-100.0, -10.0)),
        (-3.5, 11.2, (-4.0, 12.0)),
        (6.9, 7.8, (6.9, 7.8)),
        (5.0, 5.0, (0.0, 5.0)),
        (-5.0, -5.0, (-5.0, 0.0)),
        (0.0, 0.0, (0.0, 1.0)),
    ],
)
def test_a_tight_axis_has_round_ends_and_0_only_where_it_must(
    low: float, high: float, ends: tuple[float, float]
) -> None:
    found = tight_scale(low, high)
    assert (found.low, found.high) == pytest.approx(ends)


def test_of_two_labels_in_one_row_the_end_of_the_axis_is_kept() -> None:
    scale = Scale(-1_000.0, 500.0, 500.0)
    plot = Plot(6, 10, 3, 20.0, scale)
    assert plot.row(-500.0) == plot.row(-1_000.0)
    canvas = Canvas(16, 3, look().palette.text)
    draw_value_axis(canvas, plot, look())
    assert [strip.text.rstrip() for strip in canvas.strips()] == ["  500┤", "     │", "−1000┤"]


def test_the_vertical_axis_stays_until_the_data_leave_it_or_get_lost_in_it() -> None:
    first = settled(None, 0.0, 0.8)
    assert settled(first, 0.0, 0.5) is first
    assert settled(first, 0.0, 1.2).high > first.high
    lost = settled(Scale(-100.0, 20.0, 10.0), -2.0, 8.0)
    assert -4.0 <= lost.low <= -2.0
    assert 8.0 <= lost.high <= 10.0


def test_an_axis_that_has_shrunk_does_not_grow_again_at_once() -> None:
    wide = Scale(-2.0, 4.0, 1.0)
    assert settled(wide, -0.95, 1.9) is wide
    narrow = settled(wide, -0.6, 1.2)
    assert narrow.high - narrow.low < 4.0
    assert settled(narrow, -0.9, 1.4) is narrow


@pytest.mark.parametrize(
    ("wide", "low", "high", "ends"),
    [
        (Scale(0.0, 1.0, 0.1), 0.84, 1.0, (0.84, 1.0)),
        (Scale(-2_000.0, 0.0, 200.0), -390.0, -13.0, (-400.0, 0.0)),
    ],
)
def test_a_shrunk_axis_ends_at_the_ticks_next_to_the_data(
    wide: Scale, low: float, high: float, ends: tuple[float, float]
) -> None:
    found = settled(wide, low, high)
    assert (found.low, found.high) == pytest.approx(ends)


def test_the_horizontal_axis_changes_rarely() -> None:
    many = range(8, 100_000, 7)
    ends = [round_range(episodes) for episodes in many]
    assert ends == sorted(ends)
    assert len(set(ends)) <= 13 * 5  # thirteen to a power of ten
    assert all(episodes <= end + 1e-9 for episodes, end in zip(many, ends, strict=True))
    assert round_range(1) == 10.0


@pytest.mark.parametrize(
    ("x", "step", "text"),
    [
        (0.0, 0.5, "0"),
        (1.0, 0.5, "1.0"),
        (-200.0, 100.0, "−200"),
        (20_000.0, 10_000.0, "20k"),
        (2_500_000.0, 500_000.0, "2.5M"),
        (1e-4, 1e-4, "0.0001"),
        (1e-5, 1e-5, "1e-5"),
    ],
)
def test_tick_labels(x: float, step: float, text: str) -> None:
    assert tick_label(x, step, look().glyphs) == text


def test_episode_ticks_are_round_and_few() -> None:
    assert tick_step(12_345.0, 3) == 5_000.0
    assert tick_step(3.0, 5) == 1.0


def test_names_never_share_a_row() -> None:
    assert apart([3, 3, 3], 5) == [2, 3, 4]
    assert apart([0, 2, 4], 5) == [0, 2, 4]
    assert apart([1, 1, 2], 5) == [0, 1, 2]
    for wanted in ([0, 0, 0], [4, 4, 4], [1, 1, 4], [0, 4, 4]):
        rows = apart(wanted, 5)
        assert rows == sorted(set(rows))
        assert rows[0] >= 0
        assert rows[-1] <= 4


def test_of_equal_lines_the_optimum_is_named_above() -> None:
    lines = drawn(lake(greedy_return=lake().exact_answer.expected_return))[0].splitlines()
    optimum = next(y for y, line in enumerate(lines) if OPTIMAL in line)
    assert optimum < next(y for y, line in enumerate(lines) if GREEDY in line)


def test_three_numbers_stand_at_the_left_of_a_high_plot_and_two_at_a_low_one() -> None:
    for size, count in (((60, 9), 3), ((60, 5), 2)):
        numbered = [line[:5].strip() for line in drawn(lake(), size)[0].splitlines()]
        assert sum(map(bool, numbered)) == count
        assert numbered[-1] == "0"


@pytest.mark.parametrize(
    ("values", "greedy", "optimum", "ends"),
    [
        ([*[-1_379.0] * 4, *[-40.0] * 96], -13.0, -13.0, (-40.0, -13.0)),
        ([7.0] * 50 + [7.5] * 50, 7.5, 7.5, (7.0, 7.5)),
        ([1.0] * 50 + [7.5] * 50, 7.5, 7.5, (0.0, 7.5)),
        ([-40.0] * 50 + [-30.0] * 50, -500.0, None, (-40.0, -30.0)),
        ([-40.0] * 50 + [-30.0] * 50, -45.0, None, (-45.0, -30.0)),
    ],
)
def test_the_vertical_axis_is_that_of_the_later_means_the_best_and_the_greedy_policy(
    values: list[float], greedy: float | None, optimum: float | None, ends: tuple[float, float]
) -> None:
    width = 100
    mean = np.repeat(values, width)
    episode = np.arange(1, len(mean) + 1)
    curve = Curve(episode, mean, mean - 1.0, mean, mean)
    shown = lake(
        episodes=len(mean), curve=curve, marks=NO_MARKS, greedy_return=greedy, expected_return=optimum
    )
    assert curve_data(answered(shown)).range == pytest.approx(ends)


# The area


def moving(values: list[float], window: int) -> MovingMean:
    total = np.concatenate(([0.0], np.cumsum(values)))
    return MovingMean(np.arange(len(values) + 1.0), total, window)


def test_a_moving_mean_is_that_of_the_last_episodes_or_of_as_many_as_there_are() -> None:
    values = np.random.default_rng(0).normal(size=50)
    found = moving(values.tolist(), 10).at(np.arange(1.0, 51.0))
    assert found == pytest.approx([values[max(0, end - 10) : end].mean() for end in range(1, 51)])


def test_bins_hide_the_episodes_in_them_and_a_window_holds_a_bin_at_least() -> None:
    ends, mean = np.arange(1, 101) * 200, np.arange(100.0)
    curve = Curve(ends, mean, mean, mean, mean)
    found = moving_mean(ends, mean, window_of([curve], 20_000.0, is_compared=False))
    assert found.window == 200
    assert found.at(np.array([400.0])) == pytest.approx([1.0])
    assert found.at(np.array([500.0])) == pytest.approx([1.5])


def test_an_area_goes_from_the_floor_to_the_mean_of_each_column() -> None:
    plot = Plot(0, 4, 2, 8.0, Scale(0.0, 1.0, 0.5))
    area = area_of(plot, moving([0.0, 0.0, 1.0, 1.0, 3.0, -1.0], 1))
    full = area.eighths.sum(axis=0)
    assert full[0] == 0
    assert 8 < full[1] < 16  # the highest value is below the upper edge
    assert area.below.tolist() == [False, False, True, False]
    assert area.above.tolist() == [False] * 4
    assert full[3] == 0, "no episode is there yet"
    assert area_of(plot, moving([0.0, 3.0], 1)).above.tolist() == [True, False, False, False]


def test_the_area_is_darker_below_where_there_are_shades() -> None:
    for depth in ("truecolor", "256"):
        rows = area_styles(look(depth=depth).palette, 8)
        light = [luminance(each.color) for each in rows]
        assert light == sorted(light, reverse=True)
        assert light[0] > light[-1]
    for depth in ("16", "none"):
        palette = look(depth=depth).palette
        assert set(area_styles(palette, 8)) == {palette.episodes}


# Dots


def test_decimation_keeps_every_extreme() -> None:
    values = np.sin(np.arange(2_000) * 1.7)
    ends = np.arange(1.0, 2_001.0)
    low, high = braille.decimated(Steps(ends - 1.0, ends, values, values), 2_000.0, 100)
    assert low.min() == values.min()
    assert high.max() == values.max()
    inside = values[25:35]
    at = braille.decimated(Steps(ends - 1.0, ends, values, values), 2_000.0, 200)
    assert at[0][3] <= inside[5:].min()
    assert at[1][3] >= inside[5:].max()


def test_a_level_has_the_height_of_a_line_with_its_value() -> None:
    plot = Plot(0, 6, 4, 10.0, Scale(-13.0, 7.0, 5.0))
    for value in np.linspace(-13.0, 7.0, 41).tolist():
        row = plot.braille_line(steps([0.0], [10.0], [value]))[plot.row(value)]
        assert set(row.tolist()) == {plot.level_code(value)}


def test_few_values_are_steps() -> None:
    low, high = braille.decimated(steps([0.0, 1.0], [1.0, 2.0], [5.0, 7.0]), 4.0, 8)
    assert high.tolist() == [5.0, 5.0, 7.0, 7.0, 7.0, -np.inf, -np.inf, -np.inf]
    assert low.tolist() == [5.0, 5.0, 5.0, 7.0, 7.0, np.inf, np.inf, np.inf]


def test_an_undefined_value_is_a_gap() -> None:
    low, high = braille.decimated(steps([0.0, 2.0, 4.0], [2.0, 4.0, 6.0], [1.0, np.nan, 3.0]), 6.0, 6)
    assert low[3] == np.inf
    assert high[3] == -np.inf
    assert low[5] == high[5] == 3.0


def test_lines_hang_together() -> None:
    line = braille.joined(braille.Span(np.array([5, 0, 9]), np.array([5, 0, 9])))
    assert line.top.tolist() == [5, 0, 1]
    assert line.bottom.tolist() == [5, 4, 9]


def test_dots_become_braille() -> None:
    dots = np.zeros((4, 4), dtype=bool)
    dots[0, 0] = dots[3, 1] = True
    dots[:, 2:] = True
    assert "".join(map(chr, braille.braille_codes(dots)[0])) == "⢁⣿"


def test_the_greedy_line_lies_over_the_area() -> None:
    same = lake(
        curve=flat(0.5),
        marks=marks(30, 0.2, 0.2, 1_234),
        episodes=1_234,
        greedy_return=0.2,
        expected_return=None,
    )
    _, widget = drawn(same)
    ink = widget.look.palette.greedy_line.color
    pieces = [piece for row in widget.picture(same, *WIDE) for piece in row]
    dotted = [piece.style for piece in pieces if any(0x2800 < ord(each) <= 0x28FF for each in piece.text)]
    assert {style.color for style in dotted} == {ink}
    assert any(style.bgcolor is not None for style in dotted)


def test_ascii_has_its_own_area_lines_and_no_other_characters() -> None:
    text, _ = drawn(lake(), ascii=True)
    assert text.isascii()
    assert {".", ":", "|", "#", "o"} <= set(text)
    assert "- - -" in text


def test_one_row_has_a_small_area_and_the_newest_numbers() -> None:
    text, _ = drawn(lake(), (40, 1))
    assert text.rstrip().endswith(".41  greedy .73")
    assert len({"▁", "▂", "▃", "▄", "▅", "▆"} & set(text)) > 2


def test_the_axis_of_a_still_picture_does_not_tell_how_one_came_there() -> None:
    widget, wide = ReturnCurve(look()), lake(greedy_return=0.9)
    widget.picture(wide, *WIDE)
    running = changed(lake(), phase=Phase.RUNNING)
    widget.picture(running, *WIDE)
    assert widget.scale.high >= 0.9
    widget.picture(lake(), *WIDE)
    assert widget.scale == drawn(lake())[1].scale


def test_a_new_run_has_a_new_axis() -> None:
    widget = ReturnCurve(look())
    widget.show(student(curve=flat(-90.0)))
    widget.picture(student(curve=flat(-90.0)), *WIDE)
    assert widget.scale.low <= -90.0
    widget.show(student(0))
    assert widget.scale is None


def test_the_past_of_a_run_keeps_the_axis_of_its_present() -> None:
    present = student(curve=flat(-90.0), timeline=Timeline((Branch("branch 1", end=2_433, here=2_433),)))
    then = changed(
        present,
        step=40,
        curve=flat(-1.0),
        return_last_100=-1.0,
        timeline=Timeline((Branch("branch 1", end=2_433, here=40),)),
    )
    widget = ReturnCurve(look())
    widget.show(present)
    widget.picture(present, *WIDE)
    axis = widget.scale
    widget.show(then)
    widget.picture(then, *WIDE)
    assert widget.scale == axis
    fork = changed(
        then,
        timeline=Timeline((Branch("branch 1", end=2_433, here=40), Branch("branch 2", (), 0, 40, 40, 40)), 1),
    )
    widget.show(fork)
    widget.picture(fork, *WIDE)
    assert widget.scale.low > axis.low


def test_a_greedy_policy_that_walks_into_walls_does_not_blow_up_the_axis() -> None:
    early = marks(30, 0.0, 0.73, 12_500)
    early.expected_return[3:6] = -100_000.0
    assert curve_data(answered(lake(marks=early))).range[0] >= -1.0
    assert curve_data(answered(planning(marks=early))).range[0] >= -1.0
    alone = planning(marks=early, expected_return=None, greedy_return=None)
    assert curve_data(answered(alone)).range[0] == -100_000.0
