from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from recipes import recipe

from rl_tui.common.errors import UserError
from rl_tui.runs.training import benchmark
from rl_tui.runs.training.benchmark import PlainLoop


def test_the_plain_loop_learns_what_ours_does() -> None:
    loop = PlainLoop(recipe("frozenlake"), random_ties=True)
    loop.take_steps(20_000)
    assert np.max(loop.q[0]) == pytest.approx(0.951, abs=0.01)


def test_the_plain_loop_that_takes_the_first_of_equals_walks_into_the_edge() -> None:
    loop = PlainLoop(recipe("frozenlake"), random_ties=False)
    loop.take_steps(5_000)
    assert not loop.q.any()


def test_the_plain_loop_starts_and_explores_as_ours_does() -> None:
    hopeful = PlainLoop(recipe("frozenlake", initial_q=1.0, epsilon=0.0), random_ties=False)
    hopeful.take_steps(2_000)
    assert np.max(hopeful.q[0]) == pytest.approx(0.951, abs=0.02)
    tiring = PlainLoop(recipe("frozenlake", epsilon=1.0, epsilon_decay=1e9), random_ties=False)
    tiring.take_steps(10_000)
    assert tiring.episodes < 150  # of 100 steps each, once it no longer explores


def test_an_environment_that_fails_in_the_plain_loop_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def failing(_: object, action: int) -> None:
        print("a word")
        raise KeyboardInterrupt("out of breath")

    loop = PlainLoop(recipe("frozenlake"), random_ties=False)
    monkeypatch.setattr("gymnasium.envs.toy_text.frozen_lake.FrozenLakeEnv.step", failing)
    with ThreadPoolExecutor(1) as pool, pytest.raises(UserError) as fault:
        pool.submit(loop.take_steps, 10).result()
    assert str(fault.value) == "FrozenLake-v1 failed in the plain loop: KeyboardInterrupt: out of breath"
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("name", ["alpha", "step_size_schedule"])
def test_the_plain_loop_has_no_sample_average(name: str) -> None:
    with pytest.raises(UserError, match="give a number for alpha"):
        PlainLoop(recipe("frozenlake", **{name: "sample-average"}), random_ties=False)


def test_the_document_of_a_benchmark(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(benchmark, "KERNEL_STEPS", 10_000)
    monkeypatch.setattr(benchmark, "PLAIN_STEPS", 100)
    document = benchmark.benchmark(recipe("frozenlake-slippery"), rounds=2)
    assert document["scenario"] == "frozenlake-slippery"
    kernel, plain = document["kernel_steps_per_second"], document["gymnasium_steps_per_second"]
    assert document["ratio"] == kernel / plain
    assert document["gymnasium_random_ties_steps_per_second"] > 0
    assert document["ratio_many_runs"] == document["many_runs_steps_per_second"] / plain


def test_a_planner_is_not_raced() -> None:
    with pytest.raises(UserError, match="takes no steps"):
        benchmark.benchmark(recipe("frozenlake", algorithm="value-iteration"))


def test_only_gymnasium_environments_can_be_raced() -> None:
    with pytest.raises(UserError, match="student is not a Gymnasium environment"):
        benchmark.benchmark(recipe("student"))
