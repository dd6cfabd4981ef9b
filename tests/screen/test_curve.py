"""The words and numbers of the curve."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest
from conftest import MakeApp
from drawn_curves import NARROW, NO_MARKS, drawn, flat
from lane_samples import lane_views
from samples import answered, bandit, curve, lake, look, planning, stepped_lake, student
from seams import on_screen, playground, screen_text, train
from snapshots import changed

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.live.program_view import ProgramView
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.library import recipe_for
from rl_tui.runs.results import Curve
from rl_tui.screen.draw.braille import Steps
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.draw.scale import Scale
from rl_tui.screen.panels.curve import text as words
from rl_tui.screen.panels.curve.curve import ReturnCurve
from rl_tui.screen.panels.curve.data import curve_data
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.mdp.space import all_pairs
from rl_tui.worlds.world import World

BLOCKS = "▁▂▃▄▅▆▇█"


def has_area(text: str) -> bool:
    return any(block in text for block in BLOCKS)


def label(text: str, name: str) -> str | None:
    ends = [line.split() for line in text.splitlines()]
    return next((each[-1] for each in ends if name in each[-3:-1]), None)


# Labels and heading


@pytest.mark.parametrize("size", [(60, 13), NARROW])
def test_labels_have_columns_of_their_own(size: tuple[int, int]) -> None:
    text, widget = drawn(lake(), size)
    assert label(text, words.GREEDY) == ".73"
    assert label(text, words.AGENT) == ".41"
    assert label(text, words.OPTIMAL) == ".54"
    columns = {
        line.index(name) for line in text.splitlines() for name in (words.GREEDY, words.AGENT) if name in line
    }
    assert len(columns) == 1
    assert widget.heading.startswith("Return · ")


def test_without_room_for_labels_the_numbers_stand_in_the_heading() -> None:
    text, widget = drawn(lake(), (34, 7))
    assert words.AGENT not in text
    assert widget.heading == "Return · agent .41  greedy .73"


@pytest.mark.parametrize(
    ("episodes", "window"), [(30, 10), (399, 20), (1_000, 50), (12_500, 100), (40_000, 128), (400_000, 1_024)]
)
def test_the_heading_names_the_window(episodes: int, window: int) -> None:
    width = 1
    while episodes > 512 * width:
        width *= 2
    ends = np.arange(width, episodes + 1, width)
    rising = np.linspace(0.0, 1.0, len(ends))
    shown = lake(episodes=episodes, curve=Curve(ends, rising, rising, rising, rising))
    _, widget = drawn(shown, (70, 9))
    said = int(widget.heading.split("last ")[1].split()[0])
    assert window <= said <= 1.05 * window
    assert said == curve_data(shown).mean.window


def test_a_bandit_counts_pulls() -> None:
    text, widget = drawn(bandit())
    assert label(text, words.AGENT) == "1.18"
    assert widget.heading.startswith("Reward · ")


def test_the_cost_of_exploring_stands_in_the_heading() -> None:
    wide = (80, 9)
    assert drawn(lake(behaviour_return=0.4), (60, 9))[1].heading.endswith("cost of exploring: .33")
    assert "cost of exploring: −.01" in drawn(lake(behaviour_return=0.74), wide)[1].heading
    assert f"cost of exploring: about .32 · {words.EXACT_COST_BY_KEY}" in drawn(lake(), wide)[1].heading


@pytest.mark.parametrize(
    "changes",
    [
        {"greedy_return": None},
        {"greedy_return": 0.3},
        {"episodes": 99},
        {"greedy_return": 0.392},
        {"greedy_return": 0.35, "return_last_100": 0.1},  # too far below .54: not learned yet
        {"expected_return": None},
        {"q": np.zeros(44)},
    ],
)
def test_no_cost_is_claimed_that_is_not_seen(changes: dict[str, Any]) -> None:
    assert words.COST not in drawn(lake(**changes), (100, 9))[1].heading


def test_without_exploring_no_gap_is_blamed_on_it() -> None:
    snapshot = lake()
    still = changed(snapshot, hyperparameters=snapshot.agent.hyperparameters.changed("epsilon", 0.0))
    assert words.COST not in drawn(still, (100, 9))[1].heading


def test_before_the_first_episode_it_says_what_to_do() -> None:
    assert " ".join(words.NOTHING_YET["episode"]) in drawn(lake(0), (80, 13))[0]
    narrow, _ = drawn(lake(0), NARROW)
    assert words.NOTHING_YET["episode"][0] in narrow
    assert "e:" in narrow
    assert words.NOTHING_YET["pull"][0] in drawn(bandit(0))[0]


def test_of_a_program_that_ended_without_an_episode_no_key_is_named() -> None:
    text = drawn(changed(lake(0), program=ProgramView("a.py", "FrozenLake-v1", ended=True)), (80, 13))[0]
    assert " ".join(words.NOTHING_EVER) in text
    assert "space" not in text


def test_one_action_is_no_tie() -> None:
    space = all_pairs(("A", "B"), ("go",), 0)
    snapshot = lake(q=np.zeros(2), greedy_return=0.5)
    alone = changed(snapshot, world=World(space, snapshot.world.drawing))
    assert curve_data(alone).is_decided
    assert not curve_data(lake(q=np.zeros(44))).is_decided


def test_a_greedy_policy_of_mere_ties_has_no_number() -> None:
    assert label(drawn(lake(q=np.zeros(44)))[0], words.GREEDY) == words.TIES


def test_before_the_first_episode_there_is_no_line() -> None:
    start = student(0, greedy_return=6.2, expected_return=student().exact_answer.expected_return)
    text, _ = drawn(start, NARROW)
    assert not any(0x2800 < ord(character) <= 0x28FF for character in text)
    assert not has_area(text)


def test_a_small_return_far_from_a_negative_optimum_is_not_learned() -> None:
    level = curve(40, -40.0, -40.0, 24)
    far = student(expected_return=-12.0, greedy_return=-17.0, curve=level)
    near = student(expected_return=-12.0, greedy_return=-15.0, curve=level)
    assert words.COST not in drawn(far, (100, 9))[1].heading
    text, widget = drawn(near, (100, 9))
    assert f"{words.COST}: about 25" in widget.heading
    assert label(text, words.AGENT) == "−40", "the cost is the difference of the two labels"


def test_at_full_speed_the_heading_has_no_numbers_that_change() -> None:
    fast = lake(phase=Phase.RUNNING, speed=None, behaviour_return=0.4)
    text, widget = drawn(fast, (80, 9))
    assert widget.heading.endswith(words.COST_AT_PAUSE[0])
    assert label(text, words.GREEDY) == ".73"


def test_many_episodes_without_reward_are_told() -> None:
    barren = lake(curve=flat(0.0), marks=NO_MARKS, episodes=1_234, greedy_return=0.0, return_last_100=0.0)
    text, _ = drawn(barren)
    assert f"{words.NO_REWARD} after 1,234 episodes" in text
    assert words.NO_REWARD not in drawn(lake())[0]


def test_returns_of_zero_where_rewards_may_cancel_out_are_not_called_no_reward() -> None:
    even = student(curve=flat(0.0), marks=NO_MARKS, episodes=1_234, greedy_return=0.0, return_last_100=0.0)
    assert words.NO_REWARD not in drawn(even)[0]


# Steps


def of_steps(**changes: Any) -> Snapshot:
    ends, one = np.arange(1, 101), np.ones(100)
    lengths = np.linspace(400.0, 16.0, 100)
    usual = {"episodes": 100, "greedy_return": 1.0, "return_last_100": 1.0, "length_last_100": 208.0}
    return lake(curve=Curve(ends, one, one, one, lengths), **(usual | changes))


def test_where_all_returns_are_equal_the_steps_per_episode_are_drawn() -> None:
    text, widget = drawn(of_steps())
    assert widget.heading.startswith("Steps · ")
    assert has_area(text)
    assert words.GREEDY not in text
    assert words.OPTIMAL not in text
    assert widget.scale.low == 0.0
    assert label(text, words.AGENT) == "33"  # the mean of the last 10


def test_one_other_return_is_enough_to_draw_returns() -> None:
    shown = of_steps()
    returns = np.ones(100)
    returns[3] = 0.0
    one_off = replace(shown.results.curve, return_mean=returns, return_low=returns)
    _, widget = drawn(changed(shown, curve=one_off))
    assert widget.heading.startswith("Return · ")


def test_where_all_episodes_stop_at_the_time_limit_the_chart_says_so() -> None:
    shown = of_steps()
    limit = shown.world.space.time_limit
    curve = shown.results.curve
    cut = changed(shown, curve=replace(curve, length_mean=np.full(len(curve.episode), float(limit))))
    text, widget = drawn(cut)
    assert limit > 1
    assert widget.heading.startswith("Steps")
    assert words.CUT_OFF in text
    assert words.CUT_OFF not in drawn(shown)[0]


def test_the_axis_of_steps_is_not_kept_for_returns() -> None:
    widget = ReturnCurve(look())
    widget.picture(answered(of_steps()), 60, 9)
    assert widget.scale.high > 100.0
    widget.picture(answered(lake()), 60, 9)
    assert widget.scale.high <= 1.0


def test_the_axis_of_steps_never_begins_below_zero() -> None:
    widget = ReturnCurve(look())
    many = changed(of_steps(), phase=Phase.RUNNING)
    widget.picture(many, 60, 9)
    few = replace(many.results.curve, length_mean=np.linspace(40.0, 16.0, 100))
    widget.picture(changed(many, curve=few), 60, 9)
    assert (widget.scale.low, widget.scale.high) == (0.0, 40.0)


def test_while_a_lesson_holds_the_run_it_names_the_key_that_helps() -> None:
    text, _ = drawn(changed(lake(0), kept_back=frozenset({"run"})), (80, 13))
    assert words.PREDICT in text
    assert "space" not in text


async def test_where_actions_are_no_choice_the_curve_shows_the_error_of_v(make_app: MakeApp) -> None:
    async with on_screen(make_app("random-walk"), (120, 40)) as pilot:
        curve = playground(pilot).board.curve
        shown = await train(pilot, 1_500)
        assert curve.head.startswith("Error")
        assert "RMS of V" in curve.head
        text = screen_text(pilot.app)
        errors = shown.value_errors
        assert errors is not None
        assert errors.step[-1] == 1_500
        assert errors.error[0] > errors.error[-1] > 0.0
        assert f"error{errors.error[-1]:.2f}".replace("0.", ".") in text.replace(" ", "")
        assert "optimal" not in text


def test_a_pull_has_one_step_only() -> None:
    same = flat(1.0)
    assert (
        drawn(bandit(curve=replace(same, length_mean=np.ones(len(same.episode)))))[1].heading[:6] == "Reward"
    )


def test_runs_side_by_side_with_equal_returns_compare_their_steps() -> None:
    curve = of_steps().results.curve
    lanes = tuple(
        changed(lane, curve=curve, length_last_100=20.0 + lane.episodes % 7) for lane in lane_views(2)
    )
    _, widget = drawn(changed(of_steps(), lanes=lanes), (110, 14))
    assert widget.heading.startswith("Steps · 2 runs")


# Bandits


def test_a_bandit_keeps_its_secrets_until_they_are_revealed() -> None:
    text, widget = drawn(bandit(400), (80, 13))
    assert "arm" not in text
    assert words.HIDDEN_ARMS[0] in widget.heading
    text, _ = drawn(bandit(400), revealed=True)
    assert label(text, "arm") == "1.50"
    assert label(text, words.GREEDY) == "1.50"


def test_the_end_of_the_budget_reveals() -> None:
    assert label(drawn(bandit())[0], "arm") == "1.50"


def test_a_hidden_optimum_does_not_show_in_the_axis() -> None:
    data = curve_data(bandit(400))
    assert data.range[1] < 1.5
    assert curve_data(answered(bandit(400))).range[1] == pytest.approx(1.5)


# Any size, any run


def test_keys_may_take_the_place_of_the_caption() -> None:
    widget = ReturnCurve(look())
    widget.hints = ("← →: move · pgup pgdn: a tenth", "← →: move")
    for width, heading in ((50, "Return · ← →: move · pgup pgdn: a tenth"), (28, "Return · ← →: move")):
        widget.picture(lake(), width, 8)
        assert widget.heading == heading


# Planners, stepped worlds


def test_of_a_planner_only_the_greedy_policy_has_a_curve() -> None:
    text, widget = drawn(planning())
    assert widget.heading == f"{words.SWEEPS} · {words.AFTER_SWEEP}"
    assert label(text, words.GREEDY) == ".73"
    assert words.AGENT not in text
    assert not has_area(text)
    assert words.NO_REWARD not in drawn(planning(500))[0]
    assert words.NOTHING_YET["sweep"][0] in drawn(planning(0))[0]


def test_a_stepped_world_has_the_episodes_alone() -> None:
    text, _ = drawn(stepped_lake())
    assert label(text, words.AGENT) == ".41"
    assert words.GREEDY not in text
    assert words.OPTIMAL not in text


@pytest.mark.parametrize(
    ("make", "name"), [(lake, words.RETURN), (bandit, words.REWARD), (planning, words.SWEEPS)]
)
def test_the_title_names_one_quantity_at_every_size(make: Callable[[], Snapshot], name: str) -> None:
    lanes = tuple(replace(lane, algorithm=make().agent.algorithm) for lane in lane_views(2))
    phases = Phase.PAUSED, Phase.RUNNING
    for snapshot, phase, width in product((make(), changed(make(), lanes=lanes)), phases, (24, 40, 60, 120)):
        _, widget = drawn(changed(snapshot, phase=phase, speed=None), (width, 8))
        assert widget.heading.split(" · ")[0] == name


def test_the_title_is_right_before_the_world_is_there() -> None:
    for scenario, changes, name in (
        ("student", {}, words.RETURN),
        ("bandit", {}, words.REWARD),
        ("student", {"algorithm": "value-iteration"}, words.SWEEPS),
    ):
        widget = ReturnCurve(look())
        widget.begin_with(recipe_for(find(scenario), changes, 0))
        widget.picture(None, 60, 8)
        assert widget.heading == name


def test_the_cost_of_exploring_is_that_of_any_policy() -> None:
    softmax = changed(lake(behaviour_return=0.4), hyperparameters=Hyperparameters(policy="softmax"))
    assert "cost of exploring: .33" in drawn(softmax, (80, 9))[1].heading


def test_two_rows_show_the_agent_alone() -> None:
    text, _ = drawn(lake(), (60, 2))
    assert not any(0x2800 < ord(each) <= 0x28FF for each in text)
    assert any(0x2800 < ord(each) <= 0x28FF for each in drawn(lake(), (60, 3))[0])


def test_the_greedy_line_has_one_height_a_column() -> None:
    plot = Plot(0, 20, 4, 100.0, Scale(0.0, 1.0, 0.5))
    ends = np.linspace(0.5, 80.0, 160)
    values = np.tile([0.0, 1.0], 80)
    line = plot.stepped(Steps(ends - 0.5, ends, values, values))
    assert (line.low == line.high)[:16].all()
    assert np.isnan(line.low[17:]).all()
    assert set(line.low[:16].tolist()) == {1.0}
