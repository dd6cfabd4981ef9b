"""The result of a sweep."""

from __future__ import annotations

import json
import statistics
from collections.abc import Mapping
from typing import Any

import pytest
from plans import plan_of

from rl_tui.studies.statistics.intervals import summary_of
from rl_tui.studies.sweeps.cell import MEASURES, Cell
from rl_tui.studies.sweeps.document import best_documents, json_pieces, sensitivities
from rl_tui.studies.sweeps.plan import SweepPlan
from rl_tui.studies.sweeps.ranking import Standings, standings_of
from rl_tui.studies.sweeps.runs import NO_FIGURES, RunRow, summarized
from rl_tui.studies.sweeps.store import Store, stored
from rl_tui.studies.sweeps.sweep import run_again, run_sweep


def row(seed: int, failed: str | None = None, **figures: float | None) -> RunRow:
    if failed is not None:
        return RunRow(seed, NO_FIGURES, failed)
    return RunRow(seed, {**NO_FIGURES, "episodes": 100, **figures})


def filled(store: Store, plan: SweepPlan, rows: Mapping[int, list[RunRow]]) -> None:
    for index, each in rows.items():
        cell = plan.cell(index)
        assert isinstance(cell, Cell)
        store.add(stored(cell), each)


def areas(*values: float) -> list[RunRow]:
    return [row(seed, area=value) for seed, value in enumerate(values)]


def numbers(standings: Standings) -> list[int]:
    return [cell.index for cell in standings.bests]


PLAN = plan_of("maze", "alpha=0.1,0.2,0.3", runs=12)
SPREAD = [0.01 * seed for seed in range(12)]


def test_the_best_has_the_best_mean_and_what_is_like_it_is_told() -> None:
    with Store.without_file() as store:
        close = [each + 0.001 * (-1) ** seed for seed, each in enumerate(SPREAD)]
        filled(store, PLAN, {0: areas(*(each - 1 for each in SPREAD)), 1: areas(*SPREAD), 2: areas(*close)})
        standings = standings_of(PLAN, store)
        assert standings.measure.id == "area"
        assert numbers(standings) == [1]
        cells = [cell for cell in map(PLAN.cell, range(3)) if isinstance(cell, Cell)]
        assert [standings.verdict(cell) for cell in cells] == [False, True, True]
        (ranking,) = standings.rankings.values()
        assert standings.first(ranking, 2) == [1, 2]
        assert "Holm" in standings.method


def test_where_less_is_better_the_least_is_the_best() -> None:
    with Store.without_file() as store:
        for index in range(3):
            filled(store, PLAN, {index: [row(seed, regret=index + seed) for seed in range(12)]})
        assert numbers(standings_of(PLAN, store, MEASURES["regret"])) == [0]


def test_a_cell_of_which_a_run_broke_down_is_not_the_best() -> None:
    """The runs that did not fail are the lucky ones."""
    with Store.without_file() as store:
        lucky = [*areas(*(each + 5 for each in SPREAD[:11])), row(11, failed="too large")]
        filled(store, PLAN, {0: lucky, 1: areas(*SPREAD)})
        assert numbers(standings_of(PLAN, store)) == [1]
    with Store.without_file() as store:
        filled(store, PLAN, {0: lucky})
        assert numbers(standings_of(PLAN, store)) == [0]


def test_a_cell_of_which_a_run_has_no_value_is_not_the_best() -> None:
    """A policy that never ends has no expected return. The mean would cover only the others."""
    with Store.without_file() as store:
        endless = [row(seed, expected_return=None if seed else -1.0) for seed in range(12)]
        filled(store, PLAN, {0: endless, 1: [row(seed, expected_return=-9.0) for seed in range(12)]})
        assert numbers(standings_of(PLAN, store, MEASURES["expected_return"])) == [1]


def test_runs_that_never_arrive_count_with_all_their_episodes() -> None:
    with Store.without_file() as store:
        early = [row(seed, arrival=None if seed % 2 else 2, arrived=1 - seed % 2) for seed in range(12)]
        late = [row(seed, arrival=40, arrived=1) for seed in range(12)]
        filled(store, PLAN, {0: early, 1: late})
        assert numbers(standings_of(PLAN, store, MEASURES["arrival"])) == [1]


def test_without_a_measure_one_is_taken_that_the_runs_have() -> None:
    planners = plan_of("maze", "gamma=0.5,0.9", overrides={"algorithm": "value-iteration"})
    with Store.without_file() as store:
        run_sweep(planners, store)
        assert standings_of(planners, store).measure.id == "expected_return"
        assert standings_of(planners, store, MEASURES["regret"]).bests == []


def test_worlds_are_not_compared_with_each_other() -> None:
    plan = plan_of("maze", "world.step_reward=0,-1", "alpha=0.1,0.5", runs=12)
    with Store.without_file() as store:
        filled(store, plan, {index: areas(*(each + index for each in SPREAD)) for index in range(4)})
        standings = standings_of(plan, store)
        assert numbers(standings) == [1, 3]
        cells = [cell for cell in map(plan.cell, range(4)) if isinstance(cell, Cell)]
        assert [standings.verdict(cell) for cell in cells] == [False, True, False, True]


def test_only_what_was_chosen_among_several_is_trained_again() -> None:
    worlds = plan_of("maze", "world.step_reward=0,-1", runs=12)
    with Store.without_file() as store:
        filled(store, worlds, {index: areas(*SPREAD) for index in range(2)})
        standings = standings_of(worlds, store)
        assert (numbers(standings), standings.chosen) == ([0, 1], [])
        assert all("again" not in each for each in best_documents(standings, worlds, store, again=True))


def document_of(plan: SweepPlan, store: Store, *, again: bool = False) -> dict[str, Any]:
    standings = standings_of(plan, store)
    if again:
        for cell in standings.chosen:
            run_again(plan, cell, store)
    bests = best_documents(standings, plan, store, again=again)
    found: dict[str, Any] = json.loads("".join(json_pieces(plan, store, standings, bests, seconds=1.0)))
    return found


def test_the_document_has_each_cell_with_the_summary_of_its_runs() -> None:
    plan = plan_of("maze", "alpha=0.1,0.5", "algorithm=sarsa,value-iteration", runs=12)
    with Store.without_file() as store:
        run_sweep(plan, store)
        document = document_of(plan, store, again=True)
        cells = document["cells"]
        assert [(cell["alpha"], cell["algorithm"]) for cell in cells] == [
            (alpha, algorithm) for alpha in (0.1, 0.5) for algorithm in ("sarsa", "value-iteration")
        ]
        for place, cell in enumerate(cells):
            of_plan = plan.cell(place)
            assert isinstance(of_plan, Cell)
            rows = list(store.rows(of_plan.key, plan.seeds))
            assert (cell["runs"], cell["failed"]) == (12, 0)
            values = [each.figures["steps"] for each in rows]
            assert cell["steps"]["mean"] == statistics.fmean(value for value in values if value is not None)
            returns = [each.figures["expected_return"] for each in rows]
            expected = summary_of([each for each in returns if each is not None])
            assert expected is not None
            assert cell["expected_return"] == {
                name: getattr(expected, name) for name in ("mean", "median", "iqm", "low", "high", "count")
            }
        assert cells[1]["area"] == {**dict.fromkeys(("mean", "median", "iqm", "low", "high")), "count": 0}
        assert document["best"] == document["bests"][0]
        best, again = document["best"], document["best"]["again"]
        assert (again["first_seed"], again["runs"]) == (12, 12)
        assert again["shrunk"] == pytest.approx(best["area"]["mean"] - again["area"]["mean"])
        assert again["shrunk_low"] <= again["shrunk"] <= again["shrunk_high"]
    assert [each["id"] for each in document["measures"]] == list(MEASURES)
    assert document["seconds"] == 1.0
    assert document["skipped"] == {"cells": 0, "first": []}


@pytest.mark.exhaustive("compiles loops")
def test_the_document_says_what_cannot_work() -> None:
    plan = plan_of("bandit", "scenario=bandit,maze", "policy=ucb,gradient")
    with Store.without_file() as store:
        run_sweep(plan, store)
        document = document_of(plan, store)
    assert document["skipped"]["cells"] == 1
    assert document["skipped"]["first"][0]["policy"] == "gradient"
    assert document["best"] is None
    assert [each["scenario"] for each in document["bests"]] == ["bandit", "maze"]


def test_of_arrivals_some_are_only_known_to_be_late() -> None:
    arrived = [row(seed, arrival=10 + seed, arrived=1) for seed in range(9)]
    never = [row(seed, arrived=0) for seed in range(9, 12)]
    some = summarized([*arrived, *never]).figures["arrival"]
    assert (some["count"], some["arrived"]) == (12, 9)
    assert (some["mean"], some["iqm"], some["low"]) == (None, None, None)
    assert some["median"] == 15
    assert some["restricted_mean"] == pytest.approx((sum(range(10, 19)) + 3 * 100) / 12)
    assert some["restricted_low"] < some["restricted_mean"] < some["restricted_high"]
    every = summarized(arrived).figures["arrival"]
    assert every["mean"] == pytest.approx(every["restricted_mean"]) == 14
    none = summarized([row(seed) for seed in range(3)]).figures["arrival"]
    assert (none["count"], none["arrived"], none["median"]) == (0, 0, None)
    assert set(none) == set(some) == set(every)


def test_failed_runs_are_counted_and_are_in_no_mean() -> None:
    found = summarized([*areas(1.0, 3.0), row(2, failed="it broke down")])
    assert (found.runs, found.failed) == (3, 1)
    assert (found.figures["area"]["mean"], found.figures["area"]["count"]) == (2.0, 2)


def test_figures_that_are_infinite_are_in_no_mean() -> None:
    assert summarized(areas(1.0, float("inf"))).figures["area"]["count"] == 1


def test_an_empty_store_is_a_document_without_cells() -> None:
    with Store.without_file() as store:
        document = document_of(PLAN, store)
    assert (document["cells"], document["best"], document["bests"]) == ([], None, [])


def test_sensitivity_is_what_settings_of_ones_own_are_worth() -> None:
    """By hand: each scenario has its own best α, which gains half of the way from random to best."""
    plan = plan_of("maze", "scenario=cliff,frozenlake", "alpha=0.1,0.2", "algorithm=sarsa,q-learning", runs=2)
    with Store.without_file() as store:
        for index in range(plan.count):
            cell = plan.cell(index)
            assert isinstance(cell, Cell)
            facts = cell.content.facts
            assert facts.best is not None
            assert facts.random is not None
            is_own = (cell.settings["alpha"] == 0.1) == (cell.settings["scenario"] == "cliff")
            share = 1.0 if is_own or cell.recipe.algorithm == "sarsa" else 0.5
            earned = facts.random + share * (facts.best - facts.random)
            filled(store, plan, {index: [row(seed, expected_return=earned) for seed in range(2)]})
        found = sensitivities(plan, store, MEASURES["expected_return"])
        assert found is not None
        by_name = {each["algorithm"]: each for each in found}
        assert by_name["sarsa"]["value"] == pytest.approx(0.0)
        assert by_name["q-learning"]["value"] == pytest.approx(0.25)
        assert by_name["q-learning"]["tuned"] == pytest.approx(1.0)
        assert [each["best"] for each in by_name["q-learning"]["scenarios"]] == [
            {"alpha": 0.1},
            {"alpha": 0.2},
        ]
        assert sensitivities(plan, store, MEASURES["steps"]) is None
    with Store.without_file() as store:
        assert sensitivities(PLAN, store, MEASURES["area"]) is None
