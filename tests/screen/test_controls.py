"""The controls panel."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import pytest
from recipes import recipe
from samples import bandit, lake, look
from snapshots import changed
from textual.app import App, ComposeResult

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID, parameters_of
from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE, Hyperparameters
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.screen.keys.registry import ACTIONS
from rl_tui.screen.panels.controls.controls import Controls, in_force, sliders_of
from rl_tui.screen.panels.controls.settings import AgentSettings, laid_out, settings_of
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.screen.theme.glyphs import ASCII, UNICODE, Glyphs

LAKE = lake()
EVERY = [
    (algorithm.id, policy)
    for algorithm in BY_ID.values()
    for policy in (["epsilon-greedy"] if algorithm.planner else POLICY_BY_ID)
]


def told(algorithm: str, policy: str, **changes: float | str) -> Snapshot:
    values = replace(Hyperparameters(policy=policy), **changes)  # type: ignore[arg-type]
    return changed(LAKE, algorithm=algorithm, hyperparameters=values)


def test_sliders_come_in_the_order_of_the_registry() -> None:
    names = {
        (algorithm, policy): [row.name for row in sliders_of(algorithm, Hyperparameters(policy=policy))]
        for algorithm, policy in EVERY
    }
    assert names["q-learning", "epsilon-greedy"] == ["alpha", "gamma", "epsilon"]
    assert names["sarsa-lambda", "softmax"] == ["alpha", "gamma", "temperature", "lambda"]
    assert names["q-learning", "ucb"] == ["alpha", "gamma", "confidence"]
    assert names["q-learning", "thompson"] == ["alpha", "gamma"]
    assert names["value-iteration", "epsilon-greedy"] == ["gamma"]
    for key, sliders in names.items():
        assert 1 <= len(sliders) <= 4, f"{key}: there is room for four sliders at most"
        assert sliders == [name for name in parameters_of(*key) if name in sliders]


def test_what_changes_nothing_for_a_bandit_has_no_slider_and_is_no_setting() -> None:
    values = Hyperparameters()
    for algorithm in BY_ID.values():
        names = [row.name for row in sliders_of(algorithm.id, values, is_bandit=True)]
        assert names == (["gamma"] if algorithm.planner else ["alpha", "epsilon"])
    shown = values_of(changed(bandit(), algorithm="n-step-sarsa", hyperparameters=values))
    assert "n" not in shown
    assert shown["seed"]


def test_schedules_and_whole_numbers_have_no_slider() -> None:
    for parameter in PARAMETERS.values():
        assert not (parameter.slide and (parameter.schedule or parameter.whole or parameter.range is None))


def test_the_slider_of_alpha_shows_a_sample_average_by_schedule_too() -> None:
    alpha = PARAMETERS["alpha"]
    assert in_force(Hyperparameters(alpha=0.2), alpha) == 0.2
    assert in_force(Hyperparameters(alpha=SAMPLE_AVERAGE), alpha) == SAMPLE_AVERAGE  # type: ignore[arg-type]
    assert in_force(Hyperparameters(alpha=0.2, step_size_schedule=SAMPLE_AVERAGE), alpha) == SAMPLE_AVERAGE
    assert in_force(Hyperparameters(step_size_schedule=SAMPLE_AVERAGE), PARAMETERS["gamma"]) == 0.99


def values_of(snapshot: Snapshot) -> dict[str, str]:
    return {setting.label or setting.action: setting.value for setting in settings_of(snapshot)}


def test_settings_follow_algorithm_and_rule() -> None:
    plain = values_of(told("q-learning", "epsilon-greedy"))
    assert plain["agent.choose_algorithm"] == "Q-learning"
    assert plain["agent.choose_policy"] == "ε-greedy"
    assert plain["ties"] == "random"
    assert "ties" not in values_of(told("q-learning", "softmax"))
    assert values_of(told("n-step-sarsa", "epsilon-greedy", n=7))["n"] == "7"
    assert values_of(told("dyna-q", "epsilon-greedy", planning_steps=50))["planning"] == "50"
    assert values_of(told("q-lambda", "ucb", traces="accumulating"))["traces"] == "accumulating"
    assert values_of(told("q-learning", "gradient"))["baseline"] == "mean"
    planner = values_of(told("value-iteration", "epsilon-greedy"))
    assert "agent.choose_policy" not in planner
    assert planner["accuracy"] == "1e-09"


def test_what_schedules_have_come_to_is_told() -> None:
    decaying = told("sarsa", "epsilon-greedy", epsilon_decay=0.1, alpha=0.5, alpha_decay=0.1)
    assert values_of(decaying)["ε now"] == "0.000"
    assert values_of(changed(decaying, episodes=0))["α now"] == "0.500"
    assert "ε now" not in values_of(told("sarsa", "softmax", epsilon_decay=0.1))
    assert "ε now" not in values_of(
        told("sarsa", "epsilon-greedy", epsilon_decay=0.1, epsilon_schedule="constant")
    )


def test_a_click_on_a_setting_does_what_its_key_does() -> None:
    known = {action.command or action.id for action in ACTIONS}
    for algorithm, policy in EVERY:
        clicked = {each.action for each in settings_of(told(algorithm, policy)) if each.action}
        assert clicked <= known


async def test_a_slider_that_stays_shows_its_value_though_others_come_and_go() -> None:
    class Alone(App[None]):
        def compose(self) -> ComposeResult:
            yield controls

    controls = Controls(look())
    controls.begin_with(recipe("frozenlake", algorithm="sarsa-lambda", gamma=0.9))
    async with Alone().run_test() as pilot:
        controls.wanted = Hyperparameters(gamma=0.5)
        controls.show(told("q-learning", "epsilon-greedy", gamma=0.5))
        await pilot.pause()
        await pilot.app.workers.wait_for_complete()
        values = {each.id: each.value for each in controls.query(Slider)}
        assert values == {"alpha": 0.1, "gamma": 0.5, "epsilon": 0.1}


def test_where_a_run_is_over_it_can_start_again() -> None:
    for phase in (Phase.SPENT, Phase.DONE):
        over = changed(told("value-iteration", "epsilon-greedy"), phase=phase)
        assert "start again" in values_of(over).values()


@pytest.mark.parametrize("glyphs", [UNICODE, ASCII], ids=["unicode", "ascii"])
@pytest.mark.parametrize("size", [(80, 1), (60, 1), (58, 2), (58, 3), (58, 4), (60, 8), (58, 9), (200, 1)])
def test_every_algorithm_with_every_rule_fits(size: tuple[int, int], glyphs: Glyphs) -> None:
    width, height = size
    for algorithm, policy in EVERY:
        settings = settings_of(told(algorithm, policy, epsilon_decay=0.1, alpha_decay=0.1))
        lines = laid_out(settings, width, height, glyphs)
        assert 1 <= len(lines) <= height
        for line in lines:
            assert line[0].start >= 1
            assert line[-1].end <= width
            assert all(before.end < after.start for before, after in pairwise(line))
        shown = [cell.setting for line in lines for cell in line]
        assert len(shown) == len(set(shown))
        left_out = set(settings) - set(shown)
        assert not left_out or max(each.rank for each in shown) <= min(each.rank for each in left_out)
        if width >= 80 or height > 1:
            assert {"agent.choose_algorithm", "menus.open('a')"} <= {each.action for each in shown}
        if height >= 9:
            assert not left_out


async def test_a_slider_whose_value_was_refused_goes_back_each_time() -> None:
    class Alone(App[None]):
        def compose(self) -> ComposeResult:
            yield controls

    controls = Controls(look())
    controls.begin_with(recipe("frozenlake", alpha=0.5))
    async with Alone().run_test():
        controls.wanted = Hyperparameters(alpha=0.5)
        slider = controls.query_one("#alpha", Slider)
        for _ in range(3):
            controls.show(told("q-learning", "epsilon-greedy", alpha=0.5))
            assert slider.value == 0.5
            slider.action_end(True)
            assert slider.value == 1.0


async def test_the_settings_stand_below_a_blank_row_where_all_of_them_fit() -> None:
    class Alone(App[None]):
        CSS = "#sliders { height: auto; } Slider { height: 1; } #settings { height: 1fr; }"

        def compose(self) -> ComposeResult:
            yield controls

    controls = Controls(look())
    controls.begin_with(recipe("frozenlake"))
    async with Alone().run_test(size=(48, 9)) as pilot:
        for height, rows in (
            (9, ["", "sliders", "sliders", "sliders", "", "Q-learning · ε-greedy · ties random · Q₀ 0"]),
            (4, ["sliders", "sliders", "sliders", "Q-learning · ε-greedy · 10/s · a: change"]),
        ):
            controls.wanted = LAKE.agent.hyperparameters
            controls.show(LAKE)
            await pilot.resize_terminal(48, height)
            settings = controls.query_one(AgentSettings)
            top = controls.query_one(Slider).region.y
            drawn = [settings.render_line(y).text.strip() for y in range(settings.size.height)]
            assert ["" for _ in range(top)] + ["sliders"] * 3 + drawn[: len(rows) - 3 - top] == rows
