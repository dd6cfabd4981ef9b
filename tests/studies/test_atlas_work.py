"""The settings map: settings, cells, and requests."""

from __future__ import annotations

import pickle
from dataclasses import replace

import pytest
from recipes import recipe

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.compatibility import is_bandit
from rl_tui.common.kiosk import in_kiosk
from rl_tui.runs.background.background import LONGEST
from rl_tui.runs.recipe import Recipe, begin
from rl_tui.runs.training.many_runs import many_runs
from rl_tui.runs.training.seeded_runs import Goal
from rl_tui.studies.atlas import request as atlas_request
from rl_tui.studies.atlas import work
from rl_tui.studies.atlas.cells import CellGrid
from rl_tui.studies.atlas.figures import Atlas, AtlasCell, AtlasStandings, AtlasState
from rl_tui.studies.atlas.request import AtlasRequest, axes_of, surroundings, why_unmapped
from rl_tui.studies.atlas.work import AtlasWork
from rl_tui.studies.sweeps.cell import MEASURES
from rl_tui.studies.sweeps.cells.variation import Variation


def asked(made_from: Recipe) -> AtlasRequest:
    return surroundings(made_from, begin(made_from).world, is_awaited=True)


def why_not(made_from: Recipe, *, is_edited: bool = False) -> str:
    return why_unmapped(made_from, begin(made_from).world, is_edited=is_edited)


def small(made_from: Recipe, runs: int = 3, episodes: int = 20) -> AtlasRequest:
    variations = Variation("epsilon", (0.1, 0.3)), Variation("alpha", (0.1, 0.5))
    return replace(asked(made_from), variations=variations, runs=runs, episodes=episodes)


def worked_out(request: AtlasRequest) -> list[Atlas]:
    found: list[Atlas] = []
    AtlasWork(request, found.append).run()
    return found


@pytest.mark.parametrize("algorithm", [row.id for row in BY_ID.values() if not row.planner])
def test_the_value_in_force_is_one_of_those_that_vary(algorithm: str) -> None:
    for policy in POLICY_BY_ID.values():
        scenario = "bandit" if policy.bandits_only else "frozenlake"
        made_from = recipe(scenario, algorithm=algorithm, policy=policy.id, alpha=0.137)
        space = begin(made_from).world.space
        axes = axes_of(made_from, is_bandit=is_bandit(space))
        assert axes
        for each in axes:
            values = [each.value(place) for place in range(each.count)]
            assert made_from.hyperparameters.value(each.name) in values
            assert values == sorted(set(values))
            assert 3 <= len(values) <= 12


def test_a_run_of_the_cell_in_force_is_the_run_itself() -> None:
    made_from = recipe("cliff", seed=3)
    request = asked(made_from)
    assert request.recipe_of(request.in_force, 3) == made_from
    assert request.seeds[0] == 3


def test_cells_have_places_on_their_axes() -> None:
    grid = CellGrid((Variation("epsilon", (0.1, 0.3)), Variation("alpha", (0.1, 0.5, 0.9))))
    assert [grid.index(grid.places(index)) for index in range(grid.count)] == list(range(6))
    assert grid.settings(5) == {"epsilon": 0.3, "alpha": 0.9}
    assert grid.moved(0, {0: 1, 1: 2}) == 5
    assert grid.moved(5, {0: 1, 1: 1}) == 5


def test_each_cell_is_what_train_comes_to() -> None:
    request = small(recipe("student"))
    told = worked_out(request)
    last = told[-1]
    assert last.state is AtlasState.DONE
    assert (last.done, last.planned, last.episodes) == (12, 12, 20)
    for index in range(request.cells.count):
        runs = many_runs(request.recipe_of(index, 0), 3, Goal(episodes=20))["summary"]
        cell = last.cells[index]
        assert (cell.runs, cell.failed) == (3, 0)
        assert cell.value(MEASURES["area"]) == runs["return_mean"]["mean"]
        assert cell.value(MEASURES["expected_return"]) == runs["expected_return"]["mean"]
    assert last.standings["area"].best in last.standings["area"].alike


def test_the_cell_in_force_comes_first() -> None:
    request = small(recipe("student", epsilon=0.3, alpha=0.5))
    assert request.in_force == 3
    assert next(request.plan(20).order()) == 3
    assert sorted(request.plan(20).order()) == [0, 1, 2, 3]


def test_the_best_is_named_once_all_runs_are_done() -> None:
    *on_the_way, last = worked_out(small(recipe("student")))
    assert len(on_the_way) > 2
    assert not any(each.standings for each in on_the_way)
    assert {"area", "expected_return"} <= set(last.standings)


@pytest.mark.parametrize(
    ("measure", "runs", "mean", "is_named"),
    [("area", 4, 0.3, False), ("area", 10, 0.3, True), ("area", 4, 0.05, True), ("regret", 4, 0.05, False)],
)
def test_no_best_is_named_where_a_cell_that_lacks_runs_is_better(
    measure: str, runs: int, mean: float, is_named: bool
) -> None:
    cells = {
        0: AtlasCell(10, figures={measure: {"mean": 0.1}}),
        1: AtlasCell(runs, figures={measure: {"mean": mean}}),
        2: AtlasCell(4, failed=4),
    }
    found = {measure: AtlasStandings(0, frozenset({0}))}
    assert work.settled(found, cells, runs=10) == (found if is_named else {})


def test_the_largest_atlas_fits_into_a_message() -> None:
    last = worked_out(small(recipe("student"), runs=1))[-1]
    each = pickle.dumps(last.cells[0])
    assert 12 * 12 * len(each) < LONGEST / 4


def test_long_episodes_make_for_fewer_of_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(work, "MOST_STEPS", 600)
    last = worked_out(small(recipe("student"), episodes=500))[-1]
    assert last.episodes is not None
    assert 1 <= last.episodes < 500


def test_it_ends_when_its_time_is_up() -> None:
    found: list[Atlas] = []
    now = iter(range(10**9))
    AtlasWork(small(recipe("student")), found.append, lambda: next(now) * work.MOST_SECONDS).run()
    assert found[-1].state is AtlasState.OUT_OF_TIME
    assert "processor time was reached" in found[-1].message


@pytest.mark.parametrize(
    ("made_from", "is_edited", "words"),
    [
        (recipe("frozenlake", algorithm="value-iteration"), False, "plans with the model"),
        (recipe("blackjack"), False, "simulated environment"),
        (recipe("frozenlake"), True, "was edited"),
    ],
)
def test_where_there_is_nothing_to_map_it_says_why(made_from: Recipe, is_edited: bool, words: str) -> None:
    assert words in why_not(made_from, is_edited=is_edited)


def test_there_is_none_in_a_kiosk_nor_of_a_large_world(monkeypatch: pytest.MonkeyPatch) -> None:
    assert not why_not(recipe("frozenlake"))
    monkeypatch.setattr(atlas_request, "MOST_PAIRS", 3)
    assert "3 state–action pairs" in why_not(recipe("frozenlake"))
    monkeypatch.setattr(atlas_request, in_kiosk.__name__, lambda: True)
    assert "kiosk" in why_not(recipe("frozenlake"))
