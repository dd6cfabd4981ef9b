from __future__ import annotations

import json
from pathlib import Path

import pytest
from recipes import one_run, recipe

from rl_tui.common.errors import UserError
from rl_tui.runs.figures import training_figures
from rl_tui.runs.recipe import JournalEntry, TakeAction
from rl_tui.runs.run import Run
from rl_tui.runs.training.episode_rows import EpisodeRows, csv_file
from rl_tui.runs.training.seeded_runs import Goal, train

FIELDS = {
    "scenario", "algorithm", "seed", "hyperparameters", "episodes", "steps", "seconds", "steps_per_second",
    "states", "actions", "q", "visits", "policy", "value_at_start", "optimal_value_at_start", "max_error",
    "expected_return", "return_mean", "return_last_100", "length_last_100", "greedy_ends",
    "first_reward_episode",
}  # fmt: skip


def test_a_lake_is_learned() -> None:
    document = one_run(recipe("frozenlake"), Goal(episodes=10_000))
    assert set(document) >= FIELDS
    assert document["episodes"] == 10_000
    assert document["expected_return"] == 1.0
    assert document["greedy_ends"] == 1.0
    assert document["value_at_start"] == pytest.approx(0.95099, abs=1e-5)
    assert document["optimal_value_at_start"] == pytest.approx(0.95099, abs=1e-5)
    assert document["steps"] == sum(sum(filter(None, row)) for row in document["visits"])
    assert document["actions"] == ["left", "down", "right", "up"]
    assert len(document["q"]) == len(document["policy"]) == len(document["states"]) == 16
    assert document["policy"][5] == []  # a hole
    assert document["q"][5] == [None] * 4
    assert max(document["q"][0]) == pytest.approx(0.95099, abs=1e-3)
    assert 0.7 < document["return_last_100"] < 1.0
    assert document["return_mean"] < document["return_last_100"]
    assert document["hyperparameters"]["epsilon_min"] == 0.0


def test_the_student_learns_what_can_be_worked_out_by_hand() -> None:
    document = one_run(recipe("student", epsilon=1.0), Goal(steps=200_000))
    assert document["steps"] == 200_000
    assert document["policy"] == [["study"], ["quit"], ["sleep"], []]
    assert document["value_at_start"] == pytest.approx(5.2 / 0.82, abs=1e-9)
    assert document["expected_return"] == pytest.approx(7.5)
    assert document["q"][0][document["actions"].index("scroll")] is None
    assert document["first_reward_episode"] == 1


def test_before_any_reward_everything_is_tied_or_first() -> None:
    tied = one_run(recipe("frozenlake"), Goal(steps=1))
    assert tied["policy"][0] == ["left", "down", "right", "up"]
    assert tied["return_last_100"] is None
    assert tied["first_reward_episode"] is None
    first = one_run(recipe("frozenlake", ties="first"), Goal(steps=1))
    assert first["policy"][0] == ["left", "down", "right", "up"]
    assert first["expected_return"] == first["greedy_ends"] == first["value_at_start"] == 0.0


def test_where_there_is_no_exact_answer_there_is_none_made_up(tmp_path: Path) -> None:
    file = tmp_path / "loop.toml"
    file.write_text(
        '[mdp]\nstart = "A"\n[[mdp.transition]]\nstate = "A"\naction = "loop"\nreward = 1.0\nto = "A"\n'
        '[[mdp.transition]]\nstate = "A"\naction = "leave"\nreward = 0.0\nto = "End"\n'
    )
    document = one_run(recipe(str(file), gamma=1.0), Goal(steps=1_000))
    for name in ("value_at_start", "optimal_value_at_start", "expected_return", "max_error"):
        assert document[name] is None
    assert document["greedy_ends"] == 0.0
    json.dumps(document, allow_nan=False)


def test_a_runaway_is_an_error_that_names_the_step(tmp_path: Path) -> None:
    file = tmp_path / "loop.toml"
    file.write_text(
        '[defaults]\nalpha = 1.0\ngamma = 1.0\n[mdp]\nstart = "A"\n'
        '[[mdp.transition]]\nstate = "A"\naction = "loop"\nreward = 1e12\nto = "A"\n'
    )
    with pytest.raises(UserError, match="at step 2"):
        one_run(recipe(str(file)), Goal(steps=1_000))
    by_hand = [JournalEntry(step, TakeAction(0)) for step in range(3)]
    with pytest.raises(UserError, match="at step 2"):
        train(Run(recipe(str(file))), Goal(steps=1_000), journal=by_hand)


def test_progress_goes_from_nothing_to_all() -> None:
    reported: list[tuple[int, int]] = []
    run = Run(recipe("student"), evaluate=False)
    assert train(run, Goal(episodes=100), lambda done, wanted: reported.append((done, wanted))) > 0
    assert reported[0] == (0, 100)
    assert reported[-1] == (100, 100)


def test_every_episode_is_a_row(tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"
    with csv_file(path) as stream:
        run = Run(recipe("student"), on_episodes=EpisodeRows(stream, 1))
        document = training_figures(run, train(run, Goal(episodes=500)))
    header, *rows = path.read_text().splitlines()
    assert header == "run,episode,return,length"
    table = [row.split(",") for row in rows]
    assert [int(row[1]) for row in table] == list(range(1, 501))
    assert {row[0] for row in table} == {"1"}
    last = [float(row[2]) for row in table[-100:]]
    assert sum(last) / 100 == pytest.approx(document["return_last_100"])
    assert sum(int(row[3]) for row in table) == document["steps"]


def test_a_file_that_cannot_be_written_is_said_in_one_line(tmp_path: Path) -> None:
    with (
        pytest.raises(UserError, match="cannot be written") as refused,
        csv_file(tmp_path / "no" / "rows.csv"),
    ):
        raise AssertionError
    assert "\n" not in str(refused.value)
