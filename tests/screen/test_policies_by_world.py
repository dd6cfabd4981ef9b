"""The panel of policies in special worlds."""

from __future__ import annotations

from dataclasses import replace

from conftest import MakeApp
from samples import bandit, stepped_lake
from seams import on_screen, press, screen_text, train
from snapshots import changed
from test_policies_panel import SIZES, drawn, said, studied

from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.exact_answers import NO_TABLE
from rl_tui.screen.panels.policies.policies import OF_MEANS_NOW
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def test_of_arms_that_drift_the_figures_are_of_the_means_as_they_are_now() -> None:
    shown = changed(studied(bandit(400)), is_hidden=False)
    assert OF_MEANS_NOW not in said(shown)
    assert isinstance(shown.world.space, TabularMDP)
    drifting = replace(shown, world=replace(shown.world, space=replace(shown.world.space, drift_std=0.01)))
    assert f"a pull: its mean reward, {OF_MEANS_NOW}" in said(drifting)


def test_of_a_world_without_a_table_one_sentence_is_said() -> None:
    shown = stepped_lake()
    shown = replace(shown, answers=replace(shown.answers, studied=PolicyKind.GREEDY))
    assert said(shown, 60) == f"no exact returns: {NO_TABLE}"
    for size in SIZES:
        drawn(shown, *size)


async def test_the_border_names_the_key_that_leads_back_to_v_where_there_is_v(make_app: MakeApp) -> None:
    for scenario, leads_back in (("student", True), ("bandit", False)):
        async with on_screen(make_app(scenario), (120, 40)) as pilot:
            await press(pilot, "t", "p")
            text = screen_text(pilot.app)
            assert ("esc: back" in text, "esc: close" in text) == (leads_back, not leads_back)


async def test_a_policy_that_may_never_end_has_arrows_without_a_lead(make_app: MakeApp) -> None:
    async with on_screen(make_app("windy"), (120, 40)) as pilot:
        await train(pilot, 500)
        await press(pilot, "t", "p", "down")
        assert "V of" in screen_text(pilot.app)
