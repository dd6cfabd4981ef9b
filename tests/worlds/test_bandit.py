"""The arms of a ``[bandit]`` table."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from rl_tui.common.errors import ScenarioError
from rl_tui.common.streams import streams
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.files.scenario import read_scenario
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

Read = Callable[[str], TabularMDP]


@pytest.fixture
def mdp(tmp_path: Path) -> Read:
    """Return a function: the lines of a [bandit] table → its transition table at seed 3."""

    def read(lines: str) -> TabularMDP:
        path = tmp_path / "mine.toml"
        path.write_text(f"[bandit]\n{lines}\n")
        made = read_scenario(path).build(streams(3).world).mdp
        assert made is not None
        return made

    return read


def test_bernoulli_arms_pay_1_with_their_mean_as_probability(mdp: Read) -> None:
    made = mdp('rewards = "bernoulli"\nmeans = [0.25, 0.5]')
    assert made.probability.tolist() == [0.25, 0.75, 0.5, 0.5]
    assert made.reward.tolist() == [1.0, 0.0, 1.0, 0.0]
    assert made.outcome_action.tolist() == [0, 0, 1, 1]
    assert made.terminated.all()
    assert not made.reward_std.any()


def test_a_certain_bernoulli_arm_has_one_outcome(mdp: Read) -> None:
    made = mdp('rewards = "bernoulli"\nmeans = [0, 1]')
    assert made.first_outcome.tolist() == [0, 1, 2]
    assert made.reward.tolist() == [0.0, 1.0]


def test_bernoulli_means_are_uniform_where_the_file_does_not_say(mdp: Read) -> None:
    drawn = streams(3).world.uniform(0.0, 1.0, 4)
    assert mdp('rewards = "bernoulli"\narms = 4').probability[::2].tolist() == drawn.tolist()
    narrow = mdp('rewards = "bernoulli"\narms = 4\nmean = { uniform = [0.5, 0.75] }')
    assert narrow.probability[::2].tolist() == pytest.approx((0.5 + drawn / 4).tolist())


def test_gaussian_means_may_be_uniform(mdp: Read) -> None:
    made = mdp("arms = 5\nmean = { uniform = [-3, 2] }\nstd = 0.5")
    assert made.reward.tolist() == streams(3).world.uniform(-3.0, 2.0, 5).tolist()
    assert made.reward_std.tolist() == [0.5] * 5


def test_drift_is_part_of_the_table(mdp: Read) -> None:
    assert mdp("means = [0, 0]\ndrift = 0.25").drift_std == 0.25
    assert mdp("means = [0, 0]").drift_std == 0.0


def test_the_shipped_bernoulli_bandit() -> None:
    world = find("bandit-bernoulli").build(streams(7).world)
    assert (world.mdp.pairs, world.budget) == (10, 1_000)
    means = world.mdp.probability[world.mdp.reward == 1.0]
    assert means.tolist() == streams(7).world.uniform(0.0, 1.0, 10).tolist()


def test_the_shipped_drifting_bandit_is_that_of_exercise_2_5() -> None:
    world = find("bandit-drifting").build(streams(7).world)
    assert world.mdp.reward.tolist() == [0.0] * 10
    assert np.unique(world.mdp.reward_std).tolist() == [1.0]
    assert (world.mdp.drift_std, world.budget) == (0.01, 10_000)
    assert find("bandit-drifting").defaults["alpha"] == 0.1


PROBABILITY = "means from 0 to 1, since they are probabilities"


@pytest.mark.parametrize(
    ("lines", "fault"),
    [
        ('arms = 2\nrewards = "poisson"', ("bandit.rewards", '"poisson"', '"gaussian" or "bernoulli"')),
        ("arms = 2\nrewards = 1", ("bandit.rewards", "1", '"gaussian" or "bernoulli"')),
        (
            "arms = 2\nmean = { uniform = [2, 1] }",
            ("bandit.mean.uniform", "[2, 1]", "[low, high], the first not above the second"),
        ),
        (
            "arms = 2\nmean = { uniform = [0, inf] }",
            ("bandit.mean.uniform", "[0, inf]", "[low, high], the first not above the second"),
        ),
        (
            "arms = 2\nmean = { uniform = [0, 1], normal = [0, 1] }",
            ("bandit.mean", "normal and uniform are both set; keep one of them", ""),
        ),
        (
            "arms = 2\nmean = [0, 1]",
            ("bandit.mean", "[0, 1]", "a table, { normal = [mean, std] } or { uniform = [low, high] }"),
        ),
        ('rewards = "bernoulli"\nmeans = [0.5, 1.5]', ("bandit.means[1]", "1.5", PROBABILITY)),
        (
            'arms = 2\nrewards = "bernoulli"\nmean = { uniform = [-0.5, 1] }',
            ("bandit.mean.uniform", "[-0.5, 1]", f"[low, high]: {PROBABILITY}"),
        ),
        (
            'arms = 2\nrewards = "bernoulli"\nmean = { normal = [0.5, 0.1] }',
            ("bandit.mean.normal", "bernoulli rewards need means from 0 to 1; use uniform = [low, high]", ""),
        ),
        (
            'arms = 2\nrewards = "bernoulli"\nstd = 1',
            ("bandit.std", "bernoulli rewards have no std; leave it out", ""),
        ),
        (
            'arms = 2\nrewards = "bernoulli"\ndrift = 0.1',
            ("bandit.drift", "bernoulli rewards have no drift; leave it out", ""),
        ),
        ("arms = 2\ndrift = -1", ("bandit.drift", "-1", "a finite number from 0 to 1e+06")),
        ('arms = 2\ndrift = "slow"', ("bandit.drift", '"slow"', "a finite number from 0 to 1e+06")),
    ],
)
def test_every_fault_gives_its_one_line(mdp: Read, lines: str, fault: tuple[str, str, str]) -> None:
    with pytest.raises(ScenarioError) as error:
        mdp(lines)
    assert [(each.place, each.found, each.expected) for each in error.value.faults] == [fault]


def test_faults_between_keys_are_told_together_with_those_of_form(mdp: Read) -> None:
    with pytest.raises(ScenarioError) as error:
        mdp('rewards = "bernoulli"\nmeans = [2, nan]\ndrift = -1')
    assert [(each.place, each.found) for each in error.value.faults] == [
        ("bandit.means[0]", "2"),
        ("bandit.means[1]", "nan"),
        ("bandit.drift", "-1"),
        ("bandit.drift", "bernoulli rewards have no drift; leave it out"),
    ]
