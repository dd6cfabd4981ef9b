from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from lane_samples import lane_views, side_by_side, without_episodes
from rich.style import Style
from samples import answered, bandit, curve, lake, look, marks, planning
from snapshots import changed

from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.results import Curve
from rl_tui.runs.timeline.branches import Branch, Timeline
from rl_tui.screen.draw.braille import Steps
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.draw.scale import Scale
from rl_tui.screen.panels.curve import text as words
from rl_tui.screen.panels.curve.curve import ReturnCurve
from rl_tui.screen.panels.curve.data import curve_data
from rl_tui.screen.panels.curve.seed_band import SeedBand, seed_cells
from rl_tui.screen.theme.look import Look

NARROW, WIDE, BROAD = (40, 7), (64, 14), (110, 14)


def drawn(
    snapshot: Snapshot, size: tuple[int, int] = WIDE, shown_with: Look | None = None
) -> tuple[list[str], ReturnCurve]:
    widget = ReturnCurve(shown_with or look())
    widget.snapshot = snapshot
    rows = widget.picture(snapshot, *size)
    assert [row.cell_length for row in rows] == [size[0]] * size[1]
    return [row.text for row in rows], widget


def styles(snapshot: Snapshot, text: str, shown_with: Look | None = None) -> set[Style | None]:
    _, widget = drawn(snapshot, WIDE, shown_with)
    pieces = [piece for row in widget.picture(snapshot, *WIDE) for piece in row]
    return {piece.style for piece in pieces if text in piece.text}


def dotted(snapshot: Snapshot) -> set[Style | None]:
    _, widget = drawn(snapshot)
    return {
        piece.style
        for row in widget.picture(snapshot, *WIDE)
        for piece in row
        if any(0x2800 < ord(character) <= 0x28FF for character in piece.text)
    }


def test_every_run_has_a_label_with_its_mean() -> None:
    lines, widget = drawn(side_by_side(4, 1), BROAD)
    text = "\n".join(lines)
    for said in ("α 0.1: .50", "α 0.5: .32", "SARSA: .44", "softmax, τ 0.3: .62"):
        assert said in text
    assert any(line.split()[-2:] == [words.GREEDY, ".60"] for line in lines)
    assert any(line.split()[-2:] == [words.OPTIMAL, ".54"] for line in lines)
    assert widget.heading.startswith("Return · 4 runs, ▸2 α 0.5 · mean of the last 100 of one seed")
    lanes = tuple(replace(lane, episodes=1) for lane in lane_views(2))
    _, widget = drawn(changed(side_by_side(2), lanes=lanes, episodes=1), BROAD)
    assert "mean of the last 1 of one seed" in widget.heading


@pytest.mark.parametrize("every", [1, 250])
def test_a_line_ends_at_its_label_which_is_the_mean_of_the_heading(every: int) -> None:
    ends = np.arange(1, 301) * every
    returns = np.where(np.arange(300) < 260, 0.0, 0.9)
    long = Curve(ends, returns, returns, returns, returns)
    last = returns[-1] if every > 100 else returns[-100:].mean()
    lanes = tuple(
        changed(lane, curve=long, episodes=300 * every, return_last_100=float(last)) for lane in lane_views(2)
    )
    snapshot = changed(side_by_side(2), lanes=lanes, curve=long, episodes=300 * every)
    for lane in curve_data(answered(snapshot)).lanes:
        assert lane.value == pytest.approx(last)
        assert lane.line.high[-1] == pytest.approx(last)
    said = f"mean of the last {max(100, every)} of one seed"
    assert said in drawn(snapshot, (140, 14))[1].heading


def test_where_there_is_room_the_others_tell_their_greedy_return_too() -> None:
    text = "\n".join(drawn(side_by_side(3), BROAD)[0])
    assert "α 0.5: .32, greedy .60" in text
    assert "SARSA: .44, greedy .70" in text
    assert "α 0.1: .50 " in text  # the visible run has its own label


def test_a_narrow_panel_says_which_run_is_shown() -> None:
    lines, widget = drawn(side_by_side(2, 1), NARROW)
    assert "α 0.1: .50" in "\n".join(lines)
    assert widget.heading.startswith("Return · 2 runs, ▸2 α 0.5")
    assert drawn(side_by_side(4, 3), (24, 7))[1].heading == "Return · 4 runs, ▸4"


@pytest.mark.parametrize(
    ("episodes", "said"), [((27, 27), "last 27 of"), ((27, 35), "27–35 of"), ((60, 14_000), "60–100 of")]
)
def test_means_of_fewer_than_100_episodes_are_named_by_their_number(
    episodes: tuple[int, int], said: str
) -> None:
    lanes = tuple(replace(lane, episodes=n) for lane, n in zip(lane_views(2), episodes, strict=True))
    _, widget = drawn(changed(side_by_side(2, 1), lanes=lanes, episodes=episodes[1]), BROAD)
    assert said in widget.heading


def test_runs_with_other_numbers_of_episodes_are_said_to_have_equal_steps() -> None:
    assert words.EQUAL_STEPS[0] in drawn(side_by_side(2), (140, 14))[1].heading
    lanes = tuple(replace(lane, episodes=12_500) for lane in lane_views(2))
    assert words.EQUAL_STEPS[1] not in drawn(changed(side_by_side(2), lanes=lanes), (140, 14))[1].heading


def test_long_names_give_way_to_the_lines_and_then_carry_their_numbers() -> None:
    lines, _ = drawn(side_by_side(4), (34, 8))
    text = "\n".join(lines)
    assert "4) softmax…" in text
    assert "1) α 0.1" in text
    assert min(line.index(") ") for line in lines if ") " in line) > 34 / 2


def test_each_lane_has_a_colour_and_the_shown_one_is_bold() -> None:
    snapshot, palette = side_by_side(3, 2), look().palette
    assert styles(snapshot, "α 0.1:") == {palette.lanes[0]}
    assert styles(snapshot, "α 0.5:") == {palette.lanes[1]}
    assert styles(snapshot, "SARSA:") == {palette.lanes[2] + Style(bold=True)}
    assert {palette.lanes[0], palette.lanes[1], palette.lanes[2], palette.greedy_line} <= dotted(snapshot)


def test_the_first_lane_keeps_the_colour_it_had_alone() -> None:
    assert look().palette.lanes[0] == look().palette.episodes


@pytest.mark.parametrize("depth", ["none", "16"])
def test_where_colours_do_not_tell_enough_lines_carry_numbers(depth: str) -> None:
    lines, _ = drawn(side_by_side(4), WIDE, look(depth=depth))
    plot = "\n".join(line[5:26] for line in lines)
    assert all(number in plot for number in "1234")
    assert "3) SARSA: .44" in "\n".join(lines)
    alone, _ = drawn(lake(), WIDE, look(depth=depth))
    assert "1" not in "\n".join(line[5:26] for line in alone)


def test_ascii_lines_are_drawn_with_their_numbers() -> None:
    lines, _ = drawn(side_by_side(3), WIDE, look(ascii=True))
    text = "\n".join(lines)
    assert text.isascii()
    assert "222222" in text
    assert "ooo" in text
    assert "1) alpha 0.1: .50" in text


def test_the_axis_reaches_as_far_as_the_longest_lane() -> None:
    short, long = lane_views(2)
    many = changed(long, episodes=100_000, curve=curve(40, 0.0, 0.3, 2_500))
    snapshot = changed(side_by_side(2), lanes=(short, many))
    data = curve_data(answered(snapshot))
    assert (data.finished, data.furthest) == (12_500, 100_000)
    assert data.axis.right >= 100_000


def test_the_vertical_axis_holds_every_lane() -> None:
    first, second = lane_views(2)
    low = changed(second, curve=curve(40, -8.0, -5.0, 300), return_last_100=-5.0)
    data = curve_data(answered(changed(side_by_side(2), lanes=(first, low))))
    assert -8.0 <= data.range[0] < -6.0
    assert data.range[1] == pytest.approx(0.73)


def test_lanes_that_run_alike_are_both_seen() -> None:
    first, second = lane_views(2)
    same = changed(side_by_side(2), lanes=(first, replace(first, name=second.name)))
    palette = look().palette
    assert {palette.lanes[0], palette.lanes[1]} <= dotted(same)


def test_arrows_of_runs_below_the_axis_stand_side_by_side() -> None:
    falls = replace(curve(40, 0.0, 0.7, 12_500), return_mean=np.array([-90.0] * 2 + [0.5] * 38))
    runs = tuple(changed(each, curve=falls) for each in lane_views(2))
    _, widget = drawn(changed(side_by_side(2), lanes=runs))
    lowest = widget.picture(widget.snapshot, *WIDE)[-1]
    arrows = [piece.style for piece in lowest for character in piece.text if character == "▾"]
    assert arrows[:2] == [*look().palette.lanes[:2]]


def test_bands_of_runs_that_overlap_are_both_seen() -> None:
    steps = Steps(np.zeros(1), np.full(1, 40.0), np.zeros(1), np.ones(1))
    bands = [SeedBand(number, 8, "", "", steps, None) for number in (1, 2)]
    codes, whose = seed_cells(Plot(0, 8, 2, 40.0, Scale(0.0, 1.0, 0.1)), bands, look())
    assert (codes > 0).all()
    assert whose.tolist() == [[1, 1, 2, 2, 1, 1, 2, 2]] * 2


def test_a_greedy_line_that_goes_up_and_down_covers_no_lane() -> None:
    wild = marks(400, 0.0, 0.7, 12_500)
    wild.expected_return[::2] = 0.0
    lines, _ = drawn(changed(side_by_side(2), marks=wild), WIDE, look(ascii=True))
    calm, _ = drawn(side_by_side(2), WIDE, look(ascii=True))
    assert sum(line.count("1") for line in lines) >= sum(line.count("1") for line in calm)
    assert sum(line.count("o") for line in lines) > sum(line.count("o") for line in calm)


def test_no_two_names_share_a_row() -> None:
    level = [changed(lane, return_last_100=0.5) for lane in lane_views(4)]
    snapshot = side_by_side(4, greedy_return=0.5)
    lines, _ = drawn(changed(snapshot, lanes=tuple(level)))
    for name in ("α 0.1:", "α 0.5:", "SARSA:", "softmax, τ 0.3:"):
        assert sum(name in line for line in lines) == 1
    assert all(sum(line.count(sign) for sign in (": .50",)) <= 1 for line in lines)


def test_a_lane_that_has_only_begun_has_no_line_and_no_name_at_its_end() -> None:
    first, second = lane_views(2)
    lines, widget = drawn(changed(side_by_side(2), lanes=(first, without_episodes(second))))
    assert "α 0.5" not in "\n".join(lines)
    assert widget.heading.startswith("Return · 2 runs, ▸1 α 0.1")
    nothing = tuple(without_episodes(lane) for lane in (first, second))
    empty = Curve(nothing[0].results.curve.episode, *(np.array([]),) * 4)
    start = changed(side_by_side(2), lanes=nothing, episodes=0, curve=empty, return_last_100=None)
    assert words.NOTHING_YET["episode"][0] in "\n".join(drawn(start)[0])


def test_the_lane_of_a_planner_is_what_its_greedy_policy_is_worth() -> None:
    first, second = lane_views(2)
    planner = replace(
        without_episodes(second), name="Value iteration", algorithm="value-iteration", episodes=12
    )
    planner = changed(planner, marks=marks(5, 0.0, 0.74, 12), greedy_return=0.74)
    beside = changed(side_by_side(2), lanes=(first, planner))
    assert "Value iteration: .74" in "\n".join(drawn(beside)[0])
    assert "mean of the last 100, or exact" in drawn(beside, BROAD)[1].heading
    shown = changed(planning(), lanes=(first, planner), shown=1)
    text = "\n".join(drawn(shown)[0])
    assert "Value iteration: .73" in text or "Value iteration: .74" in text
    assert words.GREEDY not in text  # the run's own line


def test_a_hidden_bandit_gives_nothing_away_in_other_lanes() -> None:
    secret = bandit(400)
    lanes = tuple(changed(lane, greedy_return=1.5, return_last_100=1.2) for lane in lane_views(2))
    hidden = curve_data(changed(secret, lanes=lanes))
    assert all(lane.greedy_now is None for lane in hidden.lanes)
    planner = changed(without_episodes(lanes[1]), algorithm="value-iteration", greedy_return=1.5)
    also = curve_data(changed(secret, lanes=(lanes[0], planner)))
    assert also.lanes[1].value is None
    assert not len(also.lanes[1].line.low)
    assert not any("best" in line for line in drawn(changed(secret, lanes=lanes))[0])


def test_the_axis_stays_while_one_goes_back_in_time() -> None:
    widget = ReturnCurve(look())
    now = side_by_side(2)
    widget.snapshot = now
    widget.picture(now, *WIDE)
    scale = widget.scale
    past = changed(
        now,
        step=now.counters.step - 10,
        timeline=Timeline((Branch("1", end=now.counters.step, here=now.counters.step - 10),)),
    )
    widget.show(past)
    assert widget.scale is scale
    widget.show(changed(now, recipe=replace(now.recipe, seed=now.recipe.seed + 1)))  # another run
    assert widget.scale is None
