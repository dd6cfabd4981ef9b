from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from drawn_curves import NARROW, NO_MARKS, drawn, flat
from lane_samples import lane_views
from samples import answered, bandit, lake, look, planning, stepped_lake, student
from snapshots import changed

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.library import recipe_for
from rl_tui.screen.panels.curve import words
from rl_tui.screen.panels.curve.curve import ReturnCurve
from rl_tui.screen.panels.curve.data import curve_data
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.mdp.space import all_pairs
from rl_tui.worlds.world import World

# Words and figures


def test_lines_are_named_where_they_end() -> None:
    text, widget = drawn(lake())
    assert f"{words.GREEDY} .73" in text
    assert "episodes, last 100: .41" in text
    assert f"{words.OPTIMUM} .54" in text
    assert widget.heading == words.RETURN_TITLES[0]


def test_a_narrow_panel_has_short_names_and_the_figures_in_its_title() -> None:
    text, widget = drawn(lake(), NARROW)
    assert "greedy .73" in text
    assert "last 100: .41" in text
    assert f"{words.SHORT_OPTIMUM} .54" in text
    assert widget.heading == f"Return · greedy .73 · {words.SHORT_OPTIMUM} .54"
    assert drawn(lake(), (28, 7))[1].heading == f"greedy .73 · {words.SHORT_OPTIMUM} .54"


def test_a_mean_of_fewer_than_100_episodes_says_of_how_many() -> None:
    assert "episodes, last 7: .41" in drawn(lake(episodes=7))[0]
    assert "pulls, last 100: 1.31" in drawn(bandit())[0]
    assert "last 100: 1.31" in drawn(bandit(), NARROW)[0]


def test_the_cost_of_exploring_is_said_below_or_in_the_border() -> None:
    text, widget = drawn(lake(behaviour_return=0.4))
    assert "exploring (ε .10) costs .33 an episode" in text
    assert widget.footing == ""
    text, widget = drawn(lake(behaviour_return=0.4), NARROW)
    assert "exploring" not in text
    assert widget.footing == "exploring (ε .10) costs .33"
    assert "exploring (ε .10) brings .01 an episode" in drawn(lake(behaviour_return=0.74))[0]


def test_a_gap_of_which_that_is_not_known_is_not_laid_to_exploring() -> None:
    text, widget = drawn(lake())
    assert f"gap .32 an episode · {words.COST_BY_KEY[0]}" in text
    assert widget.footing == ""
    text, widget = drawn(lake(), NARROW)
    assert "gap" not in text
    assert widget.footing == f"gap .32 · {words.COST_BY_KEY[1]}"


@pytest.mark.parametrize(
    "changes",
    [
        {"greedy_return": None},
        {"return_last_100": None},
        {"greedy_return": 0.3},
        {"episodes": 99},
        {"greedy_return": 0.4101},
        {"greedy_return": 0.35, "return_last_100": 0.1},  # too far below .54: not learned yet
        {"expected_return": None},
        {"q": np.zeros(44)},
    ],
)
def test_no_cost_is_claimed_that_is_not_seen(changes: dict[str, Any]) -> None:
    text, widget = drawn(lake(**changes))
    assert "gap" not in text + widget.footing


def test_without_exploring_no_gap_is_blamed_on_it() -> None:
    snapshot = lake()
    still = changed(snapshot, hyperparameters=snapshot.agent.hyperparameters.changed("epsilon", 0.0))
    assert "gap" not in drawn(still)[0]


def test_before_the_first_episode_it_says_what_to_do() -> None:
    assert " ".join(words.NO_EPISODE_YET) in drawn(lake(0), (64, 13))[0]
    narrow, _ = drawn(lake(0), NARROW)
    assert all(part in narrow for part in words.NO_EPISODE_YET)
    assert "└0" in narrow
    assert words.NO_PULL_YET[0] in drawn(bandit(0))[0]


def test_one_action_is_no_tie() -> None:
    space = all_pairs(("A", "B"), ("go",), 0)
    snapshot = lake(q=np.zeros(2), greedy_return=0.5)
    alone = changed(snapshot, world=World(space, snapshot.world.drawing))
    assert curve_data(alone).is_decided
    assert not curve_data(lake(q=np.zeros(44))).is_decided


def test_a_greedy_policy_of_mere_ties_has_no_figure() -> None:
    ties = lake(q=np.zeros(44))
    text, _ = drawn(ties)
    assert words.TIES in text
    assert words.GREEDY not in text
    text, widget = drawn(ties, NARROW)
    assert words.TIES in text
    assert widget.heading == words.RETURN_TITLES[0]


def test_before_the_first_episode_there_is_no_line() -> None:
    start = student(0, greedy_return=6.2, expected_return=student().exact_answer.expected_return)
    text, widget = drawn(start, NARROW)
    assert not any(0x2800 < ord(character) <= 0x28FF for character in text)
    assert widget.heading == words.RETURN_TITLES[0]


def test_a_small_return_far_from_a_negative_optimum_is_not_learned() -> None:
    far = student(expected_return=-12.0, greedy_return=-17.0, return_last_100=-40.0)
    near = student(expected_return=-12.0, greedy_return=-15.0, return_last_100=-40.0)
    assert "gap" not in drawn(far)[0]
    assert "gap 25" in drawn(near)[0]


def test_at_full_speed_the_border_has_no_figures() -> None:
    fast = lake(phase=Phase.RUNNING, speed=None, behaviour_return=0.4)
    text, widget = drawn(fast, NARROW)
    assert widget.heading == words.RETURN_TITLES[0]
    assert widget.footing == words.COST_AT_PAUSE[0]
    assert "greedy .73" in text
    assert "exploring (ε .10) costs .33" in drawn(fast)[0]


def test_many_episodes_without_reward_are_told() -> None:
    barren = lake(curve=flat(0.0), marks=NO_MARKS, episodes=1_234, greedy_return=0.0, return_last_100=0.0)
    text, _ = drawn(barren)
    assert f"{words.NO_REWARD} in 1,234 finished episodes" in text
    assert "episodes, last 100: 0" in text
    assert f"{words.GREEDY} 0" in text
    assert words.NO_REWARD not in drawn(lake())[0]


def test_returns_of_zero_where_rewards_may_cancel_out_are_not_called_no_reward() -> None:
    even = student(curve=flat(0.0), marks=NO_MARKS, episodes=1_234, greedy_return=0.0, return_last_100=0.0)
    assert words.NO_REWARD not in drawn(even)[0]


def test_a_constant_return_is_a_line_on_the_axis() -> None:
    barren = lake(curve=flat(0.0), marks=NO_MARKS, episodes=1_234, greedy_return=None, expected_return=None)
    bottom = drawn(barren)[0].splitlines()[-2]
    assert bottom.startswith("  0┤⣀⣀⣀⣀")


# Bandits


def test_a_bandit_keeps_its_secrets_until_they_are_revealed() -> None:
    text, widget = drawn(bandit(400))
    assert "arm" not in text.replace(words.HIDDEN_ARMS[0], "")
    assert words.HIDDEN_ARMS[0] in text
    assert widget.heading == words.REWARD_TITLE
    text, _ = drawn(bandit(400), revealed=True)
    assert f"{words.BEST_ARM} 1.50" in text
    assert f"{words.GREEDY_ARM} 1.50" in text


def test_the_end_of_the_budget_reveals() -> None:
    assert f"{words.BEST_ARM} 1.50" in drawn(bandit())[0]


def test_a_hidden_optimum_does_not_show_in_the_axis() -> None:
    data = curve_data(bandit(400))
    assert data.range[1] < 1.5
    assert curve_data(answered(bandit(400))).range[1] == pytest.approx(1.5)


# Any size, any run


@pytest.mark.parametrize("snapshot", [None, lake(), lake(0), student(), bandit(0), bandit(400), bandit()])
@pytest.mark.parametrize("ascii", [False, True])
def test_it_fits_any_size(snapshot: Snapshot | None, ascii: bool) -> None:  # noqa: A002
    for width in (1, 2, 5, 13, 14, 20, 30, 50, 120):
        for height in (1, 2, 3, 5, 12, 30):
            drawn(snapshot, (width, height), ascii=ascii)


def test_keys_may_stand_on_the_border_in_place_of_the_remark() -> None:
    widget = ReturnCurve(look())
    widget.hints = ("← →: move · pgup pgdn: a tenth", "← →: move")
    for width, footing in ((40, "← →: move · pgup pgdn: a tenth"), (20, "← →: move"), (8, "")):
        widget.picture(lake(), width, 8)
        assert widget.footing == footing or not footing


# Planners, stepped worlds, other action rules


def test_of_a_planner_only_the_greedy_policy_has_a_curve() -> None:
    text, widget = drawn(planning())
    assert widget.heading == words.SWEEP_TITLES[0]
    assert "sweep" in text
    assert f"{words.GREEDY} .73" in text
    assert "episode" not in text
    assert words.NO_REWARD not in drawn(planning(500))[0]
    assert drawn(planning(), (24, 8))[1].heading == words.SWEEP_TITLES[-1]
    assert words.NO_SWEEP_YET[0] in drawn(planning(0))[0]


def test_a_stepped_world_has_the_episodes_alone() -> None:
    text, widget = drawn(stepped_lake())
    assert widget.heading == words.RETURN_TITLES[0]
    assert "episodes, last 100: .41" in text
    assert "greedy" not in text
    assert "best" not in text


@pytest.mark.parametrize("phase", [Phase.PAUSED, Phase.RUNNING])
@pytest.mark.parametrize("width", [24, 40, 60, 120])
@pytest.mark.parametrize(
    ("make", "names"),
    [(lake, words.RETURN_TITLES), (bandit, (words.REWARD_TITLE,)), (planning, words.SWEEP_TITLES)],
)
def test_the_title_names_one_quantity_at_every_size(
    make: Callable[[], Snapshot], names: tuple[str, ...], width: int, phase: Phase
) -> None:
    lanes = tuple(replace(lane, algorithm=make().agent.algorithm) for lane in lane_views(2))
    for snapshot in (make(), changed(make(), lanes=lanes)):
        _, widget = drawn(changed(snapshot, phase=phase, speed=None), (width, 8))
        heading = widget.heading
        others = {words.RETURN_TITLES[-1], words.REWARD_TITLE, words.SWEEP_TITLES[-1]} - {names[-1]}
        assert heading.startswith((*names, "greedy ", "2 lanes")), heading
        assert not any(heading.startswith(other) for other in others), heading
        assert names[-1] in heading or width < 40


def test_the_title_is_right_before_the_world_is_there() -> None:
    for scenario, changes, names in (
        ("student", {}, words.RETURN_TITLES),
        ("bandit", {}, (words.REWARD_TITLE,)),
        ("student", {"algorithm": "value-iteration"}, words.SWEEP_TITLES),
    ):
        widget = ReturnCurve(look())
        widget.begin_with(recipe_for(find(scenario), changes, 0))
        widget.picture(None, 60, 8)
        assert widget.heading == names[0]


@pytest.mark.parametrize("make", [planning, stepped_lake])
@pytest.mark.parametrize("ascii", [False, True])
def test_they_fit_any_size(make: Callable[[], Snapshot], ascii: bool) -> None:  # noqa: A002
    for width in (1, 5, 14, 30, 60, 120):
        for height in (1, 3, 6, 20):
            drawn(make(), (width, height), ascii=ascii)


def test_what_exploring_costs_names_no_rate_that_is_not_in_force() -> None:
    known = lake(behaviour_return=0.4)
    softmax = changed(known, hyperparameters=Hyperparameters(policy="softmax"))
    assert "(ε .10)" in drawn(known)[0]
    text = drawn(softmax)[0]
    assert "exploring costs .33 an episode" in text
    assert "ε" not in text
