"""The metrics of a single run."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import pytest
from plans import cell_of

from rl_tui.agents.compiling.loops import compile_here
from rl_tui.agents.exact.policy_figures import expected_return, uniform_policy
from rl_tui.agents.exact.solve import best_expected_return
from rl_tui.runs.recipe import begin
from rl_tui.runs.run import Run
from rl_tui.runs.training.seeded_runs import Goal, SeededRuns, no_progress
from rl_tui.studies.sweeps import runs
from rl_tui.studies.sweeps.cell import MEASURES, Cell, loop_in_batches
from rl_tui.studies.sweeps.runs import NO_FIGURES, marks_up_to, run_rows

DIVERGING = {"alpha": 1.0, "gamma": 1.0, "lambda": 1.0, "traces": "accumulating"}
CELLS = {
    "a map": ("maze", "algorithm=q-learning"),
    "a wind": ("windy", "algorithm=sarsa"),
    "a bandit": ("bandit", "epsilon=0.1"),
    "arms that drift": ("bandit", "world.drift=0.1"),
    "a map that is drawn": ("maze", "scenario=frozenlake-random"),
    "an environment that is stepped": ("gym:Blackjack-v1", "world.table=false"),
    "a planner": ("maze", "algorithm=value-iteration"),
}


def by_train(cell: Cell, seed: int) -> dict[str, object]:
    runs = SeededRuns(cell.recipe)
    run = runs.new_run(seed)
    runs.train(run, Goal(episodes=cell.goal.episodes), no_progress)
    return runs.row(run)


@pytest.mark.parametrize("name", CELLS)
def test_figures_are_those_of_train(name: str) -> None:
    cell = cell_of(*CELLS[name])
    for row in run_rows(cell, (3, 8)):
        alone = by_train(cell, row.seed)
        assert row.failed is None
        assert row.figures["area"] == alone["return_mean"]
        shared = {*MEASURES} & {*alone}
        assert {name: row.figures[name] for name in shared} == {name: alone[name] for name in shared}


def test_a_row_does_not_depend_on_those_beside_it() -> None:
    cell = cell_of("maze", "algorithm=sarsa")
    together = {row.seed: row.figures for row in run_rows(cell, range(5))}
    assert together == {seed: next(run_rows(cell, (seed,))).figures for seed in (4, 2, 0, 1, 3)}


@pytest.mark.exhaustive("compiles batches")
@pytest.mark.parametrize(
    ("scenario", "setting"),
    [
        ("maze", "algorithm=q-learning"),
        ("windy", "algorithm=sarsa"),
        ("frozenlake-slippery", "ties=first"),
        ("student", "policy=softmax"),
    ],
)
def test_rows_of_a_batch_are_those_of_each_seed_alone(
    scenario: str, setting: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    cell = cell_of(scenario, setting)
    loop = loop_in_batches(cell)
    assert loop is not None
    compile_here(loop)
    with monkeypatch.context() as patch:
        patch.setattr(runs, "Run", None)  # no run is trained singly
        in_batches = {row.seed: row.figures for row in run_rows(cell, range(5, 12))}
    monkeypatch.setattr(runs, "runs_in_batches", lambda cell: None)
    assert in_batches == {row.seed: row.figures for row in run_rows(cell, range(5, 12))}


@pytest.mark.exhaustive("compiles a batch")
def test_a_run_of_a_batch_that_breaks_down_says_why() -> None:
    cell = cell_of("windy", "algorithm=sarsa-lambda", overrides=DIVERGING)
    loop = loop_in_batches(cell)
    assert loop is not None
    compile_here(loop)
    rows = list(run_rows(cell, range(4)))
    alone = [next(run_rows(cell, (seed,))) for seed in range(4)]
    assert [(row.failed, row.figures) for row in rows] == [(row.failed, row.figures) for row in alone]
    assert any(row.failed for row in rows)


@pytest.mark.parametrize("scenario", ["frozenlake", "windy", "maze"])
@pytest.mark.parametrize("seed", range(3))
def test_arrival_is_the_first_mark_within_5_percent(scenario: str, seed: int) -> None:
    """Checked after every episode, in the plainest way."""
    cell = cell_of(scenario, "algorithm=q-learning", episodes=150)
    run = Run(cell.recipe, begin(cell.recipe), evaluate=False)
    mdp = run.world.mdp
    assert mdp is not None
    best, random = best_expected_return(mdp), expected_return(mdp, uniform_policy(mdp))
    assert best is not None
    assert random is not None
    cell_of_seed = next(run_rows(cell, (seed,)))
    alone = Run(replace(cell.recipe, seed=seed), evaluate=False)
    expected = None
    marks = set(marks_up_to(150))
    for episode in range(1, 151):
        alone.advance(episodes=1)
        earned = alone.greedy_return(alone.learner.q, alone.recipe.hyperparameters.ties)
        is_near = earned is not None and best - earned <= 0.05 * (best - random)
        if expected is None and episode in marks and is_near:
            expected = episode
    assert cell_of_seed.figures["arrival"] == expected
    assert cell_of_seed.figures["arrived"] == int(expected is not None)


def test_what_nobody_knows_is_null() -> None:
    stepped = next(run_rows(cell_of("gym:Blackjack-v1", "world.table=false"), (0,))).figures
    assert {name for name, value in stepped.items() if value is None} == {
        "expected_return",
        "value_at_start",
        "max_error",
        "arrival",
        "arrived",
        "regret",
    }
    planner = next(run_rows(cell_of("maze", "algorithm=value-iteration"), (0,))).figures
    assert {name for name, value in planner.items() if value is None} == {"area", "regret", "return_last_100"}
    drifting = next(run_rows(cell_of("bandit", "world.drift=0.1"), (0,))).figures
    assert (drifting["arrival"], drifting["arrived"]) == (None, None)


def test_regret_is_what_is_lost_against_the_best_policy() -> None:
    cell = cell_of("maze", "algorithm=q-learning")
    figures = next(run_rows(cell, (0,))).figures
    best = cell.content.facts.best
    assert figures["area"] is not None
    assert best is not None
    assert figures["regret"] == pytest.approx(20 * best - 20 * figures["area"])


def test_a_run_that_breaks_down_is_a_row_that_says_why() -> None:
    cell = cell_of("windy", "algorithm=sarsa-lambda", overrides=DIVERGING)
    rows = list(run_rows(cell, (0, 1)))
    assert [row.seed for row in rows] == [0, 1]
    for row in rows:
        assert row.failed is not None
        assert row.figures == NO_FIGURES


def test_marks_are_near_enough() -> None:
    for episodes in (1, 2, 7, 1_000, 123_457):
        marks = list(marks_up_to(episodes))
        assert marks[0] == 1
        assert marks[-1] == episodes
        gaps = list(pairwise(marks))
        assert all(after == before + 1 or after / before < 1.19 for before, after in gaps)
    assert len(list(marks_up_to(10**9))) < 130


def test_it_is_asked_whether_to_go_on() -> None:
    class StopError(Exception):
        pass

    def stop() -> None:
        raise StopError

    with pytest.raises(StopError):
        next(run_rows(cell_of("maze", "alpha=0.1"), (0,), stop))


def test_every_measure_has_a_figure() -> None:
    figures = next(run_rows(cell_of("maze", "alpha=0.1"), (0,))).figures
    assert list(figures) == [*MEASURES, "arrived"]
