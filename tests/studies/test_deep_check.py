"""The deep check's findings about a world."""

from __future__ import annotations

import pytest
from recipes import recipe

from rl_tui.runs.library import episodes_of
from rl_tui.runs.recipe import begin
from rl_tui.studies.world_check.deep_check import SEEDS, Question, deep_check
from rl_tui.studies.world_check.report import WorldReport

pytestmark = pytest.mark.unit


def report(scenario: str) -> WorldReport:
    of = recipe(scenario)
    mdp = begin(of).world.mdp
    assert mdp is not None
    return deep_check(Question(mdp, of.algorithm, of.hyperparameters, episodes_of(of.scenario)))


@pytest.mark.exhaustive("trains under many seeds")
def test_the_lake_has_its_known_figures() -> None:
    found = report("frozenlake")
    assert found.random_return == 0.013939795959171436
    assert found.first_update.chance == pytest.approx(0.013939795959, abs=1e-12)
    assert found.first_update.median_episodes == 50
    assert (found.best_return, found.shortest_way, found.flips) == (1.0, 6, ())
    assert (found.never_reached, found.endless_states) == ((), ())


@pytest.mark.exhaustive("trains under many seeds")
def test_on_the_cliff_monte_carlo_may_learn_never_to_end() -> None:
    found = report("cliff")
    assert found.endless is not None
    assert "monte-carlo" in found.endless
    assert "q-learning" not in found.endless
    assert found.tried.seeds == SEEDS
    assert (found.best_return, found.shortest_way) == (-13.0, 13)
    assert found.first_update.chance == 1.0


def test_of_a_walk_all_is_known_and_nothing_is_tried_since_each_policy_ends() -> None:
    found = report("random-walk")
    assert (found.random_return, found.best_return, found.shortest_way) == (0.5, 0.5, 3)
    assert (found.flips, found.never_reached, found.endless_states, found.endless) == ((),) * 4
    assert found.first_update.chance == 1.0
    assert found.tried.seeds == ()
