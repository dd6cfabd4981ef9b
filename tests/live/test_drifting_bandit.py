"""The drifting bandit against a plain transcription."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from playing import busy
from recipes import one_run, recipe

from rl_tui.common.streams import streams
from rl_tui.live.commands import Step, Train
from rl_tui.live.playback import Playback
from rl_tui.runs.recipe import EditWorld, JournalEntry, Recipe
from rl_tui.runs.run import Run
from rl_tui.runs.training.many_runs import many_runs
from rl_tui.runs.training.seeded_runs import Goal, train
from rl_tui.worlds.editing.edit import read_edits

DRIFT = 0.2
FILE = f"[bandit]\nmeans = [0.5, 0.5, -1]\nstd = 2\ndrift = {DRIFT}\nbudget = 500\n"


@pytest.fixture
def drifting(tmp_path: Path) -> Recipe:
    path = tmp_path / "drifting.toml"
    path.write_text(FILE)
    return recipe(str(path), seed=4, epsilon=0.3)


@dataclass
class Plain:
    means: list[float]
    rewards: list[float]
    optimal: list[bool]
    regret: float = 0.0
    best_total: float = 0.0


def plain(made_from: Recipe, pulls: int) -> Plain:
    run, world = Run(made_from, evaluate=False), streams(made_from.seed).world
    done = Plain([0.5, 0.5, -1.0], [], [])
    for _ in range(pulls):
        run.advance(1)
        last = run.learner.last_step
        best = max(done.means)
        done.rewards.append(done.means[last.pair] + 2.0 * world.standard_normal())
        assert last.reward == pytest.approx(done.rewards[-1], rel=1e-12)
        done.optimal.append(done.means[last.pair] == best)
        done.regret += best - done.means[last.pair]
        done.best_total += best
        done.means = [mean + DRIFT * world.standard_normal() for mean in done.means]
    return done


def test_regret_and_best_arms_are_added_up_pull_by_pull(drifting: Recipe) -> None:
    optimal_pulls: list[np.ndarray] = []
    run = Run(drifting, on_episodes=lambda returns, lengths, optimal: optimal_pulls.append(optimal))
    run.advance(400)
    wanted = plain(drifting, 400)
    spent = run.bandit
    assert spent.pulls == 400
    assert spent.winnings == pytest.approx(sum(wanted.rewards))
    assert spent.regret == wanted.regret
    assert spent.best_possible == wanted.best_total
    assert spent.best_arm_rate == sum(wanted.optimal) / 400
    assert np.concatenate(optimal_pulls).tolist() == wanted.optimal
    mdp = run.learner.mdp
    assert mdp.reward.tolist() == pytest.approx(wanted.means, abs=1e-12)
    assert run.world.space.reward.tolist() == [0.5, 0.5, -1.0]  # type: ignore[attr-defined]


def test_all_exact_figures_are_of_the_means_now(drifting: Recipe) -> None:
    figures, wanted = one_run(drifting, Goal(steps=300)), plain(drifting, 300)
    q = np.array(figures["q"][0])
    assert figures["max_error"] == pytest.approx(np.abs(q - wanted.means).max())
    assert figures["optimal_value_at_start"] == pytest.approx(max(wanted.means))
    assert figures["value_at_start"] == figures["expected_return"]
    assert figures["expected_return"] == pytest.approx(wanted.means[int(q.argmax())])
    assert figures["regret"] == wanted.regret


def test_a_checkpoint_brings_back_the_drift(drifting: Recipe) -> None:
    straight, rewound = Run(drifting), Run(drifting)
    straight.advance(400)
    rewound.advance(130)
    kept = rewound.checkpoint()
    rewound.advance(200)
    rewound.restore(kept)
    assert rewound.bandit == _at(drifting, 130).bandit
    rewound.advance(270)
    assert_same(straight, rewound)
    other = Run(drifting)
    other.restore(kept)
    other.advance(270)
    assert_same(straight, other)


def _at(made_from: Recipe, step: int) -> Run:
    run = Run(made_from)
    run.advance(step)
    return run


def assert_same(one: Run, other: Run) -> None:
    assert one.bandit == other.bandit
    assert one.learner.q.tobytes() == other.learner.q.tobytes()
    mine, yours = one.learner.mdp, other.learner.mdp
    assert mine.reward.tobytes() == yours.reward.tobytes()
    assert one.results.marks.step.tolist() == other.results.marks.step.tolist()
    assert one.results.marks.expected_return.tobytes() == other.results.marks.expected_return.tobytes()


def test_marks_hold_the_mean_of_the_greedy_arm_at_their_own_step(drifting: Recipe) -> None:
    marks = _at(drifting, 97).results.marks
    assert marks.step.tolist() == [0, 16, 32, 48, 64, 80, 96]
    for step, value in zip(marks.step.tolist()[1:], marks.expected_return.tolist()[1:], strict=True):
        greedy = int(_at(drifting, step).learner.q.argmax())
        assert value == pytest.approx(plain(drifting, step).means[greedy], abs=1e-12)


def test_the_curve_counts_the_arm_that_was_best_when_it_was_pulled(drifting: Recipe) -> None:
    document = many_runs(drifting, 1, Goal(episodes=150))
    assert document["curve"]["optimal_action_rate"] == plain(drifting, 150).optimal
    assert document["runs"][0]["best_arm_rate"] == np.mean(plain(drifting, 150).optimal)


def test_each_of_many_runs_is_held_against_its_own_means(drifting: Recipe) -> None:
    for row in many_runs(drifting, 3, Goal(episodes=150))["runs"]:
        alone = one_run(replace(drifting, seed=row["seed"]), Goal(episodes=150))
        assert row == {name: alone[name] for name in row}


def test_each_of_many_runs_whose_means_begin_to_drift_is_held_against_its_own(tmp_path: Path) -> None:
    path = tmp_path / "still.toml"
    path.write_text(FILE.replace(f"drift = {DRIFT}", ""))
    journal = (JournalEntry(50, EditWorld(read_edits(f"world.drift={DRIFT}"))),)
    rows = many_runs(recipe(str(path), seed=4), 3, Goal(episodes=150), journal=journal)["runs"]
    for row in rows:
        run = Run(recipe(str(path), seed=row["seed"]), evaluate=False)
        train(run, Goal(episodes=150), journal=journal)
        mdp = run.learner.mdp
        assert row["max_error"] == np.abs(run.learner.q - mdp.expected_reward).max()


def test_the_screen_is_told_the_means_of_the_moment(drifting: Recipe) -> None:
    playback = Playback(drifting, speed=10.0, automatic=False, clock=lambda: 0.0, on_exact=lambda: None)
    while busy(playback):
        playback.work()
    at_first = playback.snapshot()
    assert at_first.exact_answer.solution.q.tolist() == [0.5, 0.5, -1.0]
    playback.handle(Train(40))
    while busy(playback):
        playback.work()
    playback.handle(Step())
    snapshot, wanted = playback.snapshot(), plain(drifting, 41)
    assert snapshot.exact_answer.solution.q.tolist() == pytest.approx(wanted.means, abs=1e-12)
    assert snapshot.results.greedy_return == pytest.approx(wanted.means[int(snapshot.agent.q.argmax())])
    assert snapshot.results.bandit.regret == wanted.regret


def test_a_bandit_that_stands_still_has_the_same_figures_from_its_visits() -> None:
    run = Run(recipe("bandit", seed=2))
    run.advance(300)
    means = run.world.space.reward  # type: ignore[attr-defined]
    assert run.learner.drifted is None
    assert run.bandit.regret == pytest.approx(float(run.learner.visits @ (means.max() - means)))
    assert run.bandit.best_arm_rate == run.learner.visits[means.argmax()] / 300
    assert run.bandit.best_possible == pytest.approx(300 * means.max())
