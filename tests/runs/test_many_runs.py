from __future__ import annotations

import io
import json
import math
from collections.abc import Sequence
from concurrent.futures import Future, wait
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from recipes import one_run, recipe

from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.common.errors import UserError
from rl_tui.runs.figures import summary
from rl_tui.runs.measures import BANDIT_FIGURES, FIGURES
from rl_tui.runs.run import Run
from rl_tui.runs.training import batched_runs
from rl_tui.runs.training import many_runs as experiments_many_runs
from rl_tui.runs.training.batched_runs import (
    LONG_CALL,
    MOST_STEPS_AT_ONCE,
    SHORT_CALL,
    BatchedRuns,
    steps_of_next_call,
)
from rl_tui.runs.training.many_runs import many_runs
from rl_tui.runs.training.seeded_runs import Goal, SeededRuns


def timeless(document: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in document.items() if key not in ("seconds", "steps_per_second")}


def test_a_summary_of_known_numbers() -> None:
    assert summary([1.0, 2.0, None, 3.0, 4.0]) == {
        "mean": 2.5,
        "stderr": pytest.approx(math.sqrt(5 / 3) / 2),
        "min": 1.0,
        "max": 4.0,
        "count": 4,
    }
    assert summary([7.0])["stderr"] is None
    assert summary([None]) == {"mean": None, "stderr": None, "min": None, "max": None, "count": 0}


def test_each_run_is_the_single_run_of_its_seed() -> None:
    document = many_runs(recipe("bandit", seed=5), 3, Goal(episodes=300))
    assert [row["seed"] for row in document["runs"]] == [5, 6, 7]
    for row in document["runs"]:
        alone = one_run(recipe("bandit", seed=row["seed"]), Goal(episodes=300))
        assert row == {name: alone[name] for name in row}
    assert set(document["summary"]) == {*FIGURES, *BANDIT_FIGURES}
    json.dumps(document, allow_nan=False)


@pytest.mark.parametrize("goal", [Goal(episodes=450), Goal(steps=2_000)])
def test_the_number_of_workers_does_not_show(goal: Goal) -> None:
    one = many_runs(recipe("student"), 4, goal, workers=1)
    several = many_runs(recipe("student"), 4, goal, workers=4)
    assert timeless(one) == timeless(several)


def episodes_of_run(seed: int, episodes: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    reported: list[tuple[np.ndarray, ...]] = []
    run = Run(recipe("bandit", seed=seed), evaluate=False, on_episodes=lambda *each: reported.append(each))
    run.advance(episodes=episodes)
    returns, lengths, optimal = (np.concatenate(each) for each in zip(*reported, strict=True))
    best = int(run.world.space.reward.argmax())
    assert optimal.sum() == run.learner.visits[best]
    return returns, lengths, optimal


def test_the_curve_is_what_numpy_says() -> None:
    document = many_runs(recipe("bandit"), 3, Goal(episodes=450))
    curve = document["curve"]
    assert curve["episode"] == list(range(3, 451, 3))
    runs = [episodes_of_run(seed, 450) for seed in range(3)]
    means = np.array([returns.reshape(-1, 3).mean(axis=1) for returns, _, _ in runs])
    best = np.array([pulls.reshape(-1, 3).mean(axis=1) for _, _, pulls in runs])
    assert curve["return_mean"] == pytest.approx(means.mean(axis=0))
    assert curve["return_stderr"] == pytest.approx(means.std(axis=0, ddof=1) / math.sqrt(3))
    assert curve["optimal_action_rate"] == pytest.approx(best.mean(axis=0))
    assert curve["optimal_action_stderr"] == pytest.approx(best.std(axis=0, ddof=1) / math.sqrt(3))
    assert curve["length_mean"] == [1.0] * 150
    assert curve["length_stderr"] == [0.0] * 150


def test_a_curve_may_have_a_bin_for_each_episode() -> None:
    fine = many_runs(recipe("bandit"), 3, Goal(episodes=450), most_bins=450)["curve"]
    coarse = many_runs(recipe("bandit"), 3, Goal(episodes=450))["curve"]
    assert fine["episode"] == list(range(1, 451))
    for name in ("return_mean", "optimal_action_rate"):
        assert np.reshape(fine[name], (-1, 3)).mean(axis=1) == pytest.approx(np.array(coarse[name]))


def test_with_steps_the_curve_ends_with_the_fewest_episodes() -> None:
    document = many_runs(recipe("student"), 3, Goal(steps=3_000))
    fewest = min(row["episodes"] for row in document["runs"])
    curve = document["curve"]
    width = math.ceil(fewest / 200)
    assert curve["episode"] == [*range(width, fewest, width), fewest]
    assert len(curve["return_mean"]) == len(curve["episode"]) <= 200
    assert "optimal_action_rate" not in curve


def test_one_run_has_no_standard_error() -> None:
    document = many_runs(recipe("student"), 1, Goal(episodes=10))
    assert document["curve"]["return_stderr"] == [None] * 10
    assert document["summary"]["steps"]["stderr"] is None


def test_without_a_finished_episode_there_is_no_curve() -> None:
    document = many_runs(recipe("frozenlake"), 2, Goal(steps=1))
    names = ("episode", "return_mean", "return_stderr", "length_mean", "length_stderr")
    assert document["curve"] == {name: [] for name in names}
    assert document["summary"]["return_last_100"]["count"] == 0


def test_taking_the_first_of_equals_hardly_ever_sees_a_reward() -> None:
    always_left = many_runs(recipe("frozenlake", ties="first"), 10, Goal(episodes=2_000))
    at_random = many_runs(recipe("frozenlake"), 10, Goal(episodes=2_000))
    assert always_left["summary"]["first_reward_episode"]["count"] <= 2
    assert at_random["summary"]["first_reward_episode"]["count"] == 10


def test_rows_come_in_the_order_of_the_runs(tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"
    document = many_runs(recipe("student"), 3, Goal(episodes=50), path)
    rows = [line.split(",") for line in path.read_text().splitlines()[1:]]
    assert [(int(run), int(episode)) for run, episode, _, _ in rows] == [
        (run, episode) for run in (1, 2, 3) for episode in range(1, 51)
    ]
    for run, row in enumerate(document["runs"], 1):
        assert sum(int(length) for number, _, _, length in rows if int(number) == run) == row["steps"]


def test_progress_is_that_of_all_runs_together() -> None:
    reported: list[tuple[int, int]] = []
    many_runs(recipe("student"), 4, Goal(episodes=20), on_progress=lambda *each: reported.append(each))
    assert reported[-1] == (80, 80)
    assert [done for done, _ in reported] == sorted(done for done, _ in reported)


def test_a_run_that_breaks_down_is_named_by_its_seed(tmp_path: Path) -> None:
    file = tmp_path / "loop.toml"
    file.write_text(
        '[defaults]\nalpha = 1.0\ngamma = 1.0\n[mdp]\nstart = "A"\n'
        '[[mdp.transition]]\nstate = "A"\naction = "loop"\nreward = 1e12\nto = "A"\n'
    )
    with pytest.raises(UserError, match=r"seed 3: .* at step 2"):
        many_runs(recipe(str(file), seed=3), 4, Goal(steps=100))


def test_the_next_call_takes_as_many_steps_as_fit_the_time_that_the_last_one_took() -> None:
    assert steps_of_next_call(1_000, SHORT_CALL / 2) == 2_000
    assert steps_of_next_call(1_000, (SHORT_CALL + LONG_CALL) / 2) == 1_000
    assert steps_of_next_call(1_000, 2 * LONG_CALL) == 500
    assert steps_of_next_call(MOST_STEPS_AT_ONCE, 0.0) == MOST_STEPS_AT_ONCE
    assert steps_of_next_call(1, math.inf) == 1


def test_policies_of_a_batch_may_be_evaluated_a_few_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    seeded = SeededRuns(recipe("frozenlake-slippery"))
    assert seeded.batched_loop is not None
    BACKGROUND.get(seeded.batched_loop)
    runs = BatchedRuns(seeded, range(5), Goal(episodes=300))
    runs.train()
    at_once = runs.rows()
    monkeypatch.setattr(batched_runs, "STATES_AT_ONCE", 2 * seeded.first.world.space.states)
    checks = list[None]()
    assert runs.rows(lambda: checks.append(None)) == at_once
    assert len(checks) == 3


def test_maps_drawn_from_the_seed_are_not_batched_as_their_shapes_differ() -> None:
    assert SeededRuns(recipe("frozenlake-random")).batched_loop is None
    assert SeededRuns(recipe("bandit")).batched_loop is not None


def test_ctrl_c_does_not_wait_for_runs_that_never_began(monkeypatch: pytest.MonkeyPatch) -> None:
    left = []

    def wait_and_note(futures: Sequence[Future[Any]], timeout: float | None = None) -> Any:
        found = wait(futures, timeout)
        left.append(len(found.not_done))
        return found

    def interrupt(done: int, wanted: int) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(experiments_many_runs, "wait", wait_and_note)
    with pytest.raises(KeyboardInterrupt):
        many_runs(recipe("student"), 20, Goal(episodes=3), workers=1, on_progress=interrupt)
    assert left[-1] == 0


class Interrupted(io.StringIO):
    """Accepts only the head of the table, then raises the interrupt of ctrl+C."""

    def write(self, text: str, /) -> int:
        if "1,1," in self.getvalue() + text:
            super().write(text)
            raise KeyboardInterrupt
        return super().write(text)


def test_ctrl_c_while_rows_are_written_does_not_write_them_twice() -> None:
    rows = Interrupted()
    with pytest.raises(KeyboardInterrupt):
        many_runs(recipe("student"), 2, Goal(episodes=3), csv=rows, workers=1)
    assert rows.getvalue().count("\n1,1,") == 1
    assert "\n2,1," not in rows.getvalue()
