"""Algorithm, policy and options are chosen with keys."""

from __future__ import annotations

import pytest
from conftest import MakeApp
from sample_worlds import bandit_world, lake_world
from seams import choose, notes, on_screen, playground, press, screen_text, slider, snapshot, train
from textual.widgets import Input, OptionList, Static

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters
from rl_tui.live.snapshot import Phase
from rl_tui.runs.library import recipe_for
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.dialogs.choice import algorithm_choice, policy_choice
from rl_tui.screen.dialogs.form import Choice, Prompt
from rl_tui.screen.dialogs.options import Options, in_force
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.screen.panels.model import ModelPanel
from rl_tui.screen.panels.status_line import StatusLine
from rl_tui.screen.theme.glyphs import ASCII, UNICODE
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.mdp.space import all_pairs


def refused(choice: Choice) -> dict[str, str]:
    return {each.id: each.refused for each in choice.candidates if each.refused}


def test_every_algorithm_and_rule_can_be_chosen_where_it_works() -> None:
    recipe = recipe_for(find("bandit"), {}, 0)
    arms, lake, unknown = bandit_world().space, lake_world().space, all_pairs("ab", "xy", 0)
    assert not refused(algorithm_choice(arms, recipe, UNICODE))
    assert not refused(policy_choice(arms, recipe, UNICODE))
    assert set(refused(policy_choice(lake, recipe, UNICODE))) == {"gradient", "thompson"}
    planners = {each.id for each in BY_ID.values() if each.planner}
    assert set(refused(algorithm_choice(unknown, recipe, UNICODE))) == planners
    assert all("table" in each for each in refused(algorithm_choice(unknown, recipe, UNICODE)).values())


def test_every_choice_has_name_summary_and_equation() -> None:
    recipe = recipe_for(find("student"), {}, 0)
    for choice, rows in (
        (algorithm_choice(lake_world().space, recipe, ASCII), BY_ID.values()),
        (policy_choice(lake_world().space, recipe, ASCII), POLICY_BY_ID.values()),
    ):
        assert [each.name for each in choice.candidates] == [each.name for each in rows]
        assert all(each.words and len(each.lines) == 3 and all(each.lines) for each in choice.candidates)
        assert [each.id for each in choice.candidates if each.id == choice.current] == [choice.current]


async def test_a_planner_is_chosen_stepped_and_done(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), (100, 24), notifications=True) as pilot:
        await press(pilot, "a", "a")
        assert isinstance(pilot.app.screen, Choice)
        await choose(pilot, "value-iteration")
        assert snapshot(pilot).agent.algorithm == "value-iteration"
        assert [each.parameter.name for each in playground(pilot).query(Slider)] == ["gamma"]
        first = await press(pilot, "s")
        assert first.counters.last_step.planned
        assert (await press(pilot, "e")).counters.episodes == 1
        await press(pilot, "w", "m")
        assert playground(pilot).board.opened == "model"
        assert pilot.app.screen.query_one(ModelPanel).pair in range(5)
        await press(pilot, "escape")
        await press(pilot, "a", "p")
        assert "Not here: Value iteration tries every action and follows no policy." in screen_text(pilot.app)
        await press(pilot, "escape")
        done = await train(pilot, 100_000)
        assert done.playback.phase is Phase.DONE
        assert "converged after" in pilot.app.screen.query_one(StatusLine).render_line(0).text
        await press(pilot, "space")
        assert notes(pilot.app)[-1].startswith("Converged after")
        await press(pilot, "1", "pagedown")
        assert snapshot(pilot).playback.phase is Phase.PAUSED
        pilot.app.set_focus(None)
        again = await press(pilot, "e")
        assert again.counters.step > done.counters.step
        await press(pilot, "a", "a")
        await choose(pilot, "q-learning")
        assert [each.parameter.name for each in playground(pilot).query(Slider)] == [
            "alpha",
            "gamma",
            "epsilon",
        ]


async def test_a_policy_is_chosen_and_an_option_that_changes_nothing_says_why(make_app: MakeApp) -> None:
    app = make_app("bandit")
    async with on_screen(app, (120, 40), notifications=True) as pilot:
        assert [each.id for each in app.screen.query(Slider)] == ["alpha", "epsilon"]
        assert snapshot(pilot).agent.hyperparameters.sample_average
        await press(pilot, "a", "o")
        choices, hint = app.screen.query_one(OptionList), app.screen.query_one("#about", Static)
        for name, reason in (("gamma", "every pull ends its episode"), ("epsilon", "")):
            choices.highlighted = choices.get_option_index(name)
            await settle(pilot)
            text = " ".join(str(hint.render()).split())
            assert ("No effect now" in text) is bool(reason)
            assert reason in text
        await press(pilot, "escape", "a", "p")
        await choose(pilot, "gradient")
        gradient = snapshot(pilot).agent.hyperparameters
        assert gradient.policy == "gradient"
        assert gradient.alpha == Hyperparameters().alpha
        assert notes(app)[-1] == "gradient bandit needs a step size: α is 0.1 from here on"
        await press(pilot, "a", "o")
        await choose(pilot, "alpha")
        app.screen.query_one(Input).value = "1/n"
        await press(pilot, "enter")
        assert notes(app)[-1].startswith("policy gradient needs a step size")
        await press(pilot, "escape")
        assert snapshot(pilot).agent.hyperparameters.alpha == Hyperparameters().alpha
        assert playground(pilot).recipe.hyperparameters == snapshot(pilot).agent.hyperparameters


async def test_options_list_all_that_counts_and_change_it(make_app: MakeApp) -> None:
    async with on_screen(make_app("student")) as pilot:
        await press(pilot, "a", "o")
        assert isinstance(pilot.app.screen, Options)
        listed = pilot.app.screen.query_one(OptionList)
        ids = [listed.get_option_at_index(number).id for number in range(listed.option_count)]
        assert ids == ["alpha", "gamma", "epsilon", "policy", "ties", "initial_q", "schedules"]
        await choose(pilot, "schedules")
        ids = [listed.get_option_at_index(number).id for number in range(listed.option_count)]
        assert ids[:6] == ["alpha", "gamma", "epsilon", "policy", "ties", "initial_q"]
        assert {"step_size_schedule", "epsilon_decay"} <= set(ids[6:])
        assert not {"n", "temperature", "lambda", "accuracy"} & set(ids)
        await choose(pilot, "epsilon_decay")
        assert isinstance(pilot.app.screen, Prompt)
        pilot.app.screen.query_one(Input).value = "0.25"
        await press(pilot, "enter")
        assert isinstance(pilot.app.screen, Options)
        assert snapshot(pilot).agent.hyperparameters.epsilon_decay == 0.25
        listed = pilot.app.screen.query_one(OptionList)
        assert listed.highlighted_option
        assert listed.highlighted_option.id == "epsilon_decay"
        assert "0.25" in str(listed.highlighted_option.prompt)
        await choose(pilot, "epsilon_schedule")
        assert isinstance(pilot.app.screen, Choice)
        await choose(pilot, "linear")
        assert snapshot(pilot).agent.hyperparameters.epsilon_schedule == "linear"
        await press(pilot, "escape")
        assert snapshot(pilot).counters.step == 0
        await press(pilot, "a", "o", "7")
        await choose(pilot, "step_size_schedule")
        await choose(pilot, "sample-average")
        await press(pilot, "escape")
        assert snapshot(pilot).agent.hyperparameters.sample_average
        assert slider(pilot.app, "alpha").value == "sample-average"
        await press(pilot, "1", "right")
        values = snapshot(pilot).agent.hyperparameters
        assert not values.sample_average
        assert slider(pilot.app, "alpha").value == values.alpha


def test_what_is_in_force_is_said_in_plain_words() -> None:
    usual = Hyperparameters()
    assert in_force("alpha", usual)[0] == "constant 0.1"
    assert in_force("step_size_schedule", usual)[0] == "constant"
    falling = usual.changed("alpha_decay", 0.01).changed("alpha_min", 0.02)
    assert in_force("alpha", falling)[0] == "0.1 to 0.02"
    assert in_force("step_size_schedule", falling)[0] == "exponential"
    assert in_force("alpha_min", falling) == ("0.02", "where it ends")
    stopped = falling.changed("step_size_schedule", "constant")
    assert in_force("alpha", stopped)[0] == "constant 0.1"
    average = usual.changed("alpha", "sample-average")
    assert in_force("alpha", average)[0] == "1/N"
    assert in_force("step_size_schedule", average)[0] == "sample-average"


@pytest.mark.parametrize("name", PARAMETERS)
def test_every_option_says_what_it_is_where_there_is_least_room(name: str) -> None:
    meaning = ASCII.spelled(in_force(name, Hyperparameters())[1])
    assert 0 < len(meaning) <= 17
    assert meaning != name.replace("_", " ")


def test_every_planner_has_a_reason_to_follow_no_policy() -> None:
    for algorithm in BY_ID.values():
        assert ("policy" in BY_ID[algorithm.id].parameters) is not algorithm.planner
