"""Parameters of a world."""

from __future__ import annotations

import pytest

from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.runs.library import find
from rl_tui.studies.sweeps.cells.content import raw_table, scenario_with
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.files.catalogue import scenarios
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.mdp.digest import table_digest
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.sections.schema import parsed


def table(scenario: Scenario, seed: int = 0) -> TabularMDP:
    mdp = scenario.build(streams(seed).world).mdp
    assert mdp is not None
    return mdp


@pytest.mark.parametrize("scenario", scenarios(), ids=lambda scenario: scenario.id)
def test_the_table_of_a_section_reads_back_as_that_section(scenario: Scenario) -> None:
    raw = raw_table(scenario.section)
    section, findings = parsed(type(scenario.section), raw)
    assert findings == []
    assert section == scenario.section
    assert list(type(scenario.section).connection_findings(raw)) == []


def test_a_rule_of_a_map() -> None:
    noisy = scenario_with(find("maze"), {"world.noise": 0.2, "world.step_reward": -0.5})
    assert table(noisy).time_limit == table(find("maze")).time_limit
    assert table(noisy).reward.min() <= -0.5
    assert table_digest(table(noisy)) != table_digest(table(find("maze")))


def test_a_time_limit_of_a_map_and_of_an_environment() -> None:
    assert table(scenario_with(find("maze"), {"world.time_limit": 17})).time_limit == 17
    lake = scenario_with(find("frozenlake"), {"world.kwargs.max_episode_steps": 17})
    assert table(lake).time_limit == 17


def test_an_argument_of_an_environment() -> None:
    dry = scenario_with(find("frozenlake-slippery"), {"world.kwargs.is_slippery": False})
    assert table_digest(table(dry)) == table_digest(table(find("frozenlake")))


def test_how_many_arms_are_drawn() -> None:
    world = scenario_with(find("bandit"), {"world.arms": 3, "world.std": 0.5}).build(streams(4).world)
    assert isinstance(world.drawing, Arms)
    assert world.space.pairs == 3


def test_an_edit_of_one_place() -> None:
    scenario = scenario_with(find("maze"), {"world.cell[0,0]": "#"})
    assert table_digest(table(scenario)) != table_digest(table(find("maze")))


def test_a_rule_of_the_map_that_an_environment_can_be_drawn_as() -> None:
    scenario = scenario_with(find("frozenlake"), {"world.noise": 0.1})
    assert scenario.kind == "grid"
    assert scenario.build(streams(0).world).space.states == table(find("frozenlake")).states


def test_both_at_once() -> None:
    one = scenario_with(find("maze"), {"world.cell[0,0]": "#", "world.noise": 0.1})
    other = scenario_with(find("maze"), {"world.noise": 0.1, "world.cell[0,0]": "#"})
    assert table_digest(table(one)) == table_digest(table(other))
    assert table_digest(table(one)) != table_digest(table(scenario_with(find("maze"), {"world.noise": 0.1})))


@pytest.mark.parametrize(
    ("scenario", "name", "value", "expected"),
    [
        ("maze", "world.noise", 2, "number from 0 to 1"),
        ("maze", "world.noize", 0.1, "noise"),
        ("maze", "world.time_limit", 1.5, "whole number"),
        ("maze", "world.noise.x", 1, "grid.noise: "),
        ("bandit", "world.arm[0]", 1, "works only in a fixed world"),
        ("bandit", "world.means", "[1]", "as many as there are arms"),
        ("taxi", "world.noise", 0.1, "Taxi"),
        ("frozenlake", "world.kwargs.render_mode", "human", "rl-tui draws the world"),
    ],
)
def test_what_is_refused_names_the_setting(
    scenario: str, name: str, value: float | str, expected: str
) -> None:
    with pytest.raises(UserError) as fault:
        scenario_with(find(scenario), {name: value})
    assert name in str(fault.value)
    assert expected in str(fault.value)
    assert "\n" not in str(fault.value)
