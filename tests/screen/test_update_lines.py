"""The last step's text for each algorithm."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from samples import bandit, lake, look
from snapshots import changed

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.last_step import NOTHING
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.panels.last_step.last_step import LastStepPanel

LAKE = lake(slippery=False)


def drawn(snapshot: Snapshot, width: int = 80, height: int = 1, *, ascii: bool = False) -> str:  # noqa: A002
    rows = LastStepPanel(look(ascii)).picture(snapshot, width, height)
    assert [row.cell_length for row in rows] == [width] * height
    text = "\n".join(row.text.rstrip() for row in rows)
    assert not ascii or text.isascii()
    return text


def step(algorithm: str, **changes: Any) -> Snapshot:
    assert LAKE.counters.last_step is not None
    pair = int(LAKE.world.space.first_pair[6]) + 1
    usual = {
        "state": 6,
        "pair": pair,
        "updated_pair": pair,
        "outcome": pair,
        "next_state": 10,
        "bootstrap_state": NOTHING if changes.get("terminated") else changes.get("next_state", 10),
        "terminated": False,
        "reward": 0.0,
        "gathered": 0.0,
        "before": 0.36,
        "bootstrap": 0.56,
        "step_size": 0.1,
    }
    last = replace(LAKE.counters.last_step, **(usual | changes))
    if last.learned:
        last = replace(last, after=last.before + last.step_size * last.td_error)
    return changed(LAKE, algorithm=algorithm, last_step=last)


@pytest.mark.parametrize(
    ("algorithm", "word"),
    [
        ("q-learning", "best"),
        ("sarsa", "next"),
        ("expected-sarsa", "mean"),
        ("sarsa-lambda", "next"),
        ("q-lambda", "best"),
        ("dyna-q", "best"),
        ("prioritized-sweeping", "best"),
    ],
)
def test_one_step_methods_differ_in_what_they_expect_next(algorithm: str, word: str) -> None:
    text = drawn(step(algorithm), 60, 9)
    assert f" now  = was  + α  ·(r + γ  ·{word} − was )" in text
    assert " .379 = .360 + .10·(0 + .99·.560 − .360)" in text


def test_double_q_learning_names_its_tables() -> None:
    for table, name in ((1, "Q₁"), (2, "Q₂")):
        snapshot = step("double-q-learning", table=table)
        assert f" {name}(6,↓) = was  + α  ·(r + γ  ·other − was )" in drawn(snapshot, 80, 9)
        assert f"{name}(6,↓) = .360 + .10·(0 + .99·.560 − .360) = .379" in drawn(snapshot)
    assert "Q2(6,v) = was" in drawn(step("double-q-learning", table=2), 80, 9, ascii=True)


def test_n_steps_gather_rewards_and_discount_by_a_power() -> None:
    earlier = int(LAKE.world.space.first_pair[4]) + 1
    snapshot = step("n-step-sarsa", updated_pair=earlier, gathered=0.3, discount=0.99**4)
    text = drawn(snapshot, 80, 9)
    assert " Q(4,↓) = was  + α  ·(G  + γⁿ   ·next − was )" in text
    assert " .408   = .360 + .10·(.3 + .9606·.560 − .360)" in text


def test_n_steps_at_the_end_of_an_episode() -> None:
    snapshot = step(
        "n-step-sarsa", terminated=True, next_state=15, bootstrap=0.0, reward=1.0, gathered=1.0, others=3
    )
    text = drawn(snapshot, 80, 9)
    assert "= was  + α  ·(G − was )" in text
    assert "and 3 more at the end of the episode" in text


@pytest.mark.parametrize(
    ("algorithm", "reason"),
    [
        ("n-step-sarsa", "waits until n rewards are gathered"),
        ("monte-carlo", "waits for the end of the episode"),
        ("prioritized-sweeping", "no change above θ: nothing to update"),
    ],
)
def test_where_nothing_was_learned_yet_it_says_why(algorithm: str, reason: str) -> None:
    waiting = step(algorithm, updated_pair=NOTHING, before=0.0, bootstrap=0.0, step_size=0.0)
    for height in (1, 2, 3, 4, 6, 9):
        text = drawn(waiting, 80, height)
        assert reason in text
        assert "Q(" not in text
        assert "δ" not in text
        drawn(waiting, 80, height, ascii=True)


def test_monte_carlo_learns_from_the_whole_return() -> None:
    start = int(LAKE.world.space.first_pair[0])
    ended = step(
        "monte-carlo",
        terminated=True,
        next_state=15,
        updated_pair=start,
        gathered=0.95,
        discount=0.95,
        bootstrap=0.0,
        others=5,
    )
    text = drawn(ended, 80, 9)
    assert " Q(0,←) = was  + α  ·(G    − was )" in text
    assert "and 5 more, back to its start" in text
    assert "Q(0,←) = .360 + .10·(.950 − .360) = .419" in drawn(ended, 100)
    cut = changed(
        ended,
        last_step=replace(
            ended.counters.last_step, terminated=False, truncated=True, bootstrap=0.2, bootstrap_state=15
        ),
    )  # type: ignore[type-var]
    assert "mean" in drawn(cut, 80, 9)


@pytest.mark.parametrize(
    ("algorithm", "words"),
    [("sarsa-lambda", "and 12 more by their traces"), ("dyna-q", "and 12 more from the model")],
)
def test_further_updates_of_one_step_are_counted(algorithm: str, words: str) -> None:
    snapshot = step(algorithm, others=12)
    assert words in drawn(snapshot, 80, 9)
    assert words in drawn(snapshot, 56, 9)
    assert "+12" in drawn(snapshot, 120)
    assert "equal" not in drawn(snapshot, 80, 9)


def test_a_trace_makes_the_step_larger_or_smaller() -> None:
    assert "+ α e ·(r" in drawn(step("sarsa-lambda", step_size=0.081), 80, 9)


def test_a_pair_from_the_model_leads_to_a_state_of_its_own() -> None:
    other = int(LAKE.world.space.first_pair[9])
    text = drawn(step("prioritized-sweeping", updated_pair=other, bootstrap_state=13, others=9), 80, 9)
    assert "Q(9,←) = was" in text


def planned(algorithm: str = "value-iteration", **changes: Any) -> Snapshot:
    best = int(LAKE.world.space.first_pair[6]) + 1
    usual = {
        "pair": NOTHING,
        "updated_pair": best,
        "outcome": NOTHING,
        "next_state": 6,
        "episode": 3,
        "step": 27,
        "step_size": 1.0,
        "gathered": 0.25,
        "others": 2,
    }
    return step(algorithm, **(usual | changes))


def test_a_planner_backs_up_a_state() -> None:
    text = drawn(planned(), 64, 5)
    assert text.splitlines()[:4] == [
        " sweep 3   backs up state 6   row 1, column 2, counted from 0",
        " and 2 more of this state",
        " Q(6,↓) = Σ p r + γ  ·best",
        " .804   = .250  + .99·.560",
    ]
    assert drawn(planned()) == " sweep 3  Q(6,↓) = .250 + .99·.560 = .804  δ +.444  +2"


@pytest.mark.parametrize("algorithm", [each.id for each in BY_ID.values() if each.planner])
def test_a_planner_tells_nothing_of_a_world_it_did_not_step_in(algorithm: str) -> None:
    for height in (1, 2, 3, 4, 6, 9):
        text = drawn(planned(algorithm), 70, height)
        for word in ("agent", "environment", "reward", "greedy", "→", "random"):
            assert word not in text
    arms = bandit(400)
    assert arms.counters.last_step is not None
    on_arms = changed(
        arms, algorithm=algorithm, last_step=replace(arms.counters.last_step, pair=NOTHING, outcome=NOTHING)
    )
    assert "pulled" not in drawn(on_arms, 60, 8)


@pytest.mark.parametrize(
    ("policy", "explored", "words"),
    [
        ("softmax", False, "softmax (τ = .10), the greedy one"),
        ("softmax", True, "softmax (τ = .10), not the greedy one"),
        ("ucb", True, "UCB (c = 2), not the greedy one"),
        ("thompson", False, "Thompson sampling, the greedy one"),
        ("gradient", True, "gradient bandit, not the greedy one"),
    ],
)
def test_every_action_rule_says_how_it_chose(policy: str, explored: bool, words: str) -> None:
    snapshot = step("q-learning", explored=explored)
    snapshot = changed(snapshot, hyperparameters=Hyperparameters(policy=policy))
    panel = LastStepPanel(look())
    panel.picture(snapshot, 100, 9)
    assert panel.heading == f"Last step · {words}"


def test_a_schedule_is_no_fraction() -> None:
    values = Hyperparameters(alpha=0.5, step_size_schedule="linear", alpha_decay=0.1)
    snapshot = changed(step("q-learning", step_size=0.2), hyperparameters=values)
    assert "+ .20·(" in drawn(snapshot)
    average = replace(values, step_size_schedule="sample-average")
    assert "+ 1/5·(" in drawn(changed(snapshot, hyperparameters=average))
    assert "+ 0·(" in drawn(step("q-learning", step_size=0.0))


def test_a_stepped_environment_has_no_chances() -> None:
    text = drawn(step("q-learning", outcome=NOTHING), 70, 9)
    assert " to 10   reward 0\n" in text


@pytest.mark.parametrize("algorithm", BY_ID)
def test_every_algorithm_fits_any_size(algorithm: str) -> None:
    snapshot = planned(algorithm) if BY_ID[algorithm].planner else step(algorithm, others=1234)
    for width in (1, 3, 10, 20, 40, 54, 80, 140):
        for height in (1, 2, 3, 4, 5, 6, 7, 8, 20):
            drawn(snapshot, width, height)
            drawn(snapshot, width, height, ascii=True)
