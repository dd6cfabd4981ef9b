"""The update that a program makes, found from recordings."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from made_agents import Made, sent
from made_recordings import Step, recorded

from rl_tui.programs.diagnosis.update_rule import update_of
from rl_tui.programs.evidence.evidence import Evidence
from rl_tui.programs.evidence.verdict import MovedCell, Rule, UpdateFound, UpdateTarget
from rl_tui.programs.watched.recording import Recording
from rl_tui.worlds.mdp.space import FloatArray

NAMES = {"q": Rule.Q_LEARNING, "sarsa": Rule.SARSA, "expected": Rule.EXPECTED_SARSA}


def found(steps: int = 2000, *, held_as: str = "", **made: Any) -> UpdateFound:
    return update_of(Evidence(Made(**made).recording(steps), dtype=held_as))


@pytest.mark.exhaustive("60 worlds", but=["0", "1", "2", "3", "4", "5", "6", "7"])
@pytest.mark.parametrize("seed", range(60))
def test_rule_step_size_and_discount_of_random_worlds_are_exact(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rule = ("q", "sarsa", "expected")[seed % 3]
    alpha, gamma = float(rng.uniform(0.01, 1)), float(rng.uniform(0.3, 1))
    epsilon = float(rng.uniform(0.1, 0.9))
    states, actions = int(rng.integers(4, 40)), int(rng.integers(2, 6))
    update = found(
        seed=seed,
        rule=rule,
        alpha=lambda visits, episode: alpha,
        gamma=gamma,
        epsilon=epsilon,
        states=states,
        actions=actions,
    )
    assert update.rule is NAMES[rule]
    assert update.alpha == pytest.approx(alpha, rel=1e-6)
    assert update.gamma == pytest.approx(gamma, rel=1e-6)
    assert update.epsilon == (pytest.approx(epsilon, rel=1e-6) if rule == "expected" else None)
    assert (update.fits, update.departs_at, update.reason) == (1.0, None, "")
    assert (update.alpha_schedule, update.reward, update.place) == (
        "constant",
        "environment",
        MovedCell.TAKEN,
    )


@pytest.mark.parametrize("rule", ["q", "sarsa"])
@pytest.mark.parametrize(
    "made",
    [
        {"gamma": 1.0, "minus_one": True},
        {"sparse": True},
        {"alpha": lambda visits, episode: 1.0},
        {"alpha": lambda visits, episode: 1e-6},
        {"dtype": np.float32},
        {"dtype": np.float32, "alpha": lambda visits, episode: 0.01},
        {"dtype": np.float16},
        {"bootstraps_after_end": True, "initial": 1.0},
        {"evaluates_every": 3},
        {"initial": 5.0},
        {"time_limit": 4},
    ],
)
def test_the_update_is_found_whatever_the_world_and_the_table(rule: str, made: dict[str, Any]) -> None:
    agent = Made(rule=rule, **made)
    update = found(4000, rule=rule, **made)
    assert update.rule is NAMES[rule], update.reason
    assert update.alpha == pytest.approx(agent.alpha(1, 1), rel=1e-6)
    assert update.gamma == pytest.approx(agent.gamma, rel=1e-6)


@pytest.mark.parametrize("rule", ["q", "sarsa"])
@pytest.mark.parametrize("evaluates_every", [0, 3])
def test_sample_averages_are_found(rule: str, evaluates_every: int) -> None:
    update = found(3000, rule=rule, alpha=lambda visits, _: 1 / visits, evaluates_every=evaluates_every)
    assert (update.rule, update.alpha, update.alpha_schedule, update.gamma) == (NAMES[rule], None, "1/N", 0.9)


def test_sample_averages_are_found_in_a_table_that_is_found_late() -> None:
    recording = Made(alpha=lambda visits, _: 1 / visits).recording(3000)
    steps, changes = sent(recording)
    late = Recording()
    late.add(steps[:700], changes[:0])
    late.find_table(700, recording.actions, recording.table_at(700))
    late.add(steps[700:], changes[changes[:, 0] >= 700])
    update = update_of(Evidence(late))
    assert (update.rule, update.alpha_schedule, update.gamma) == (Rule.Q_LEARNING, "1/N", 0.9)


@pytest.mark.parametrize("rule", ["q", "sarsa"])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_a_step_size_that_falls_with_the_episodes_is_found(rule: str, dtype: Any) -> None:
    update = found(3000, rule=rule, dtype=dtype, alpha=lambda _, episode: 0.5 * 0.99**episode)
    assert update.fits == 1.0
    assert (update.rule, update.alpha, update.alpha_schedule) == (NAMES[rule], None, "by-episode")
    assert update.gamma == pytest.approx(0.9, rel=1e-6)


@pytest.mark.parametrize("rule", ["q", "sarsa"])
@pytest.mark.parametrize(
    "reward",
    [lambda s, a, t, r: r - 0.3 * s, lambda s, a, t, r: 2 * r + 1, lambda s, a, t, r: r - 3 * (t == 11)],
)
def test_a_reward_of_its_own_is_told_as_such(rule: str, reward: Any) -> None:
    update = found(4000, rule=rule, own_reward=reward)
    assert (update.rule, update.reward) == (NAMES[rule], "own")
    assert (update.alpha, update.gamma) == (pytest.approx(0.1, rel=1e-6), pytest.approx(0.9, rel=1e-6))


@pytest.mark.parametrize("rule", ["q", "sarsa"])
@pytest.mark.parametrize("sparse", [False, True])
def test_the_reward_of_the_step_before_is_told_from_that_of_the_step(rule: str, sparse: bool) -> None:
    update = found(4000, rule=rule, reward_late=True, sparse=sparse)
    assert (update.rule, update.uses_reward_before, update.gamma) == (NAMES[rule], True, 0.9)


@pytest.mark.parametrize("rule", ["q", "sarsa"])
def test_an_update_one_step_late_is_no_other_rule(rule: str) -> None:
    update = found(3000, rule=rule, late_update=True)
    assert (update.rule, update.place, update.gamma) == (NAMES[rule], MovedCell.ONE_LATE, 0.9)
    assert not update.uses_reward_before


def test_without_exploration_nothing_tells_the_rule() -> None:
    update = found(3000, rule="sarsa", epsilon=0.0, initial=2.0)
    assert (update.rule, update.alpha, update.gamma, update.fits) == (Rule.UNKNOWN, 0.1, 0.9, None)
    assert "greedy" in update.reason


def test_a_discount_of_0_tells_no_rule() -> None:
    update = found(gamma=0.0)
    assert (update.rule, update.alpha, update.gamma) == (Rule.UNKNOWN, 0.1, 0.0)
    assert update.reason


def test_episodes_of_one_step_tell_the_step_size_and_no_discount() -> None:
    update = found(states=2, actions=4)
    assert (update.alpha, update.gamma) == (0.1, 0.9)  # the only non-terminal state may follow itself
    rows = Made(states=2, actions=4).recording(2000)
    ended = np.flatnonzero(rows.steps.terminated)
    only_ends = Recording()
    only_ends.find_table(0, 4, np.zeros(8))
    steps, changes, q = [], [], np.zeros(8)
    for number, at in enumerate(ended):
        cell = int(rows.steps.action[at])
        steps.append((0, 0, cell, float(at % 7), 1, 1, number, 0))
        after = q[cell] + 0.1 * (at % 7 - q[cell])
        changes.append((number, cell, q[cell], after))
        q[cell] = after
    only_ends.add(np.array(steps, float), np.array(changes))
    update = update_of(Evidence(only_ends))
    assert (update.rule, update.alpha, update.gamma, update.informative) == (Rule.UNKNOWN, 0.1, None, 0)


def test_steps_that_all_say_the_same_tell_no_update() -> None:
    """For first visits with equal rewards, every step size has a matching discount."""
    same = Recording()
    same.find_table(0, 2, np.ones(40))
    steps = [(0, place, 0, 0.0, place + 1, 0, 0, place) for place in range(18)]
    same.add(np.array(steps, float), np.array([(place, 2 * place, 1.0, 0.98) for place in range(18)]))
    update = update_of(Evidence(same))
    assert (update.rule, update.alpha, update.gamma) == (Rule.UNKNOWN, None, None)


def test_the_reward_before_is_0_at_first_where_the_program_has_it_so() -> None:
    recording = Made(rule="sarsa", reward_late=True, reward_before_at_first=0.0, time_limit=5).recording(4000)
    update = update_of(Evidence(recording))
    assert (update.rule, update.uses_reward_before, update.reward) == (Rule.SARSA, True, "environment")
    assert (update.gamma, update.fits) == (0.9, 1.0)


def test_nothing_is_said_of_an_update_that_is_none_of_these() -> None:
    rng = np.random.default_rng(3)
    update = found(alpha=lambda visits, episode: float(rng.uniform(0, 0.5)))
    assert (update.rule, update.alpha, update.gamma, update.fits) == (Rule.UNKNOWN, None, None, None)
    assert update.reason
    made = {"dtype": np.int64, "minus_one": True, "alpha": lambda *_: 0.6, "initial": 50}
    for dtype, is_cut_off in (("int64", True), ("float64", False), ("", False)):
        whole = found(held_as=dtype, **made)
        assert whole.rule is Rule.UNKNOWN
        assert ("whole numbers" in whole.reason) is is_cut_off


def test_a_table_that_counts_visits_is_none_of_values() -> None:
    def counts(table: FloatArray, step: Step) -> None:
        table[step.state, step.action] += 1.0

    evidence = Evidence(recorded(counts, initial="zeros").recording, dtype="float64")
    assert update_of(evidence).reason.startswith("Each step adds 1")


def test_a_table_that_stays_as_it_is_says_so() -> None:
    update = found(alpha=lambda *_: 0.0)
    assert (update.rule, update.reason) == (Rule.UNKNOWN, "No number of the table has changed yet.")


def test_the_first_step_that_departs_is_named() -> None:
    recording = Made().recording(3000)
    at = int(np.flatnonzero(recording.changes.step == 1234)[0])
    recording.changes.after[at] += 0.5
    update = update_of(Evidence(recording))
    assert (update.rule, update.departs_at) == (Rule.Q_LEARNING, 1234)
    assert 0.99 < (update.fits or 0) < 1


def test_numbers_of_a_long_run_are_the_same_at_every_look() -> None:
    evidence = Evidence(Made(sparse=True, epsilon=0.3).recording(25_000))
    first, second = update_of(evidence), update_of(evidence)
    assert first == second
    assert (first.rule, first.alpha, first.gamma, first.target) == (
        Rule.Q_LEARNING,
        0.1,
        0.9,
        UpdateTarget.BEST,
    )


def test_rows_that_a_dict_makes_as_it_goes_are_no_changes() -> None:
    recording = Made(initial=0.25).recording(3000)
    begun, steps, made, actions = recording.initial.copy(), recording.steps, set(), recording.actions
    rows: list[tuple[float, ...]] = []
    for step in range(len(steps.state)):
        for state in {int(steps.state[step]), int(steps.next_state[step])} - made:
            made.add(state)
            rows += [
                (step, cell, np.nan, begun[cell]) for cell in range(state * actions, (state + 1) * actions)
            ]
    sent_steps, sent_changes = sent(recording)
    whole = np.concatenate((np.array(rows), sent_changes))
    whole = whole[np.argsort(whole[:, 0], kind="stable")]
    as_dict = Recording()
    as_dict.find_table(0, actions, np.full(len(begun), np.nan))
    as_dict.add(sent_steps, whole)
    update = update_of(Evidence(as_dict))
    assert (update.rule, update.alpha, update.gamma) == (Rule.Q_LEARNING, 0.1, 0.9)
    assert (update.fits or 0) > 0.99
