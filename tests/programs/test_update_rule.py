"""The update that a program makes, found from recordings, and its parts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from correct_learners import ALPHA, GAMMA, moved
from made_agents import Made, sent
from made_recordings import ACTIONS, STATES, Learner, Step, recorded

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.diagnosis.step_story import NOTHING, CellChange, StepUpdate, update_of_step
from rl_tui.programs.diagnosis.update_rule import update_of
from rl_tui.programs.evidence.evidence import Evidence
from rl_tui.programs.evidence.verdict import CodeFault, MovedCell, Rule, UpdateFound, UpdateTarget
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


INITIAL = ("random", "zeros", "high")
SOME_SEEDS = pytest.mark.exhaustive(
    "other random worlds", but=[f"{seed}-{each}" for seed, each in enumerate(INITIAL)]
)


def reading(action: Callable[[FloatArray, Step], int], *, at_ends: bool = True) -> Learner:
    def learn(table: FloatArray, step: Step) -> None:
        future = 0.0 if step.terminated else table[step.next_state, action(table, step)]
        if at_ends or not (step.terminated or step.truncated):
            moved(table, step, step.reward + GAMMA * future)

    return learn


def best_allowed(seed: int) -> Callable[[FloatArray, Step], int]:
    rng = np.random.default_rng(100 + seed)
    allowed = rng.random((STATES, ACTIONS)) < 0.5
    allowed[np.arange(STATES), rng.integers(ACTIONS, size=STATES)] = True
    return lambda table, step: int(
        np.where(allowed[step.next_state], table[step.next_state], -np.inf).argmax()
    )


def drawn_again(seed: int) -> Callable[[FloatArray, Step], int]:
    rng = np.random.default_rng(seed)
    return lambda table, step: (
        int(rng.integers(ACTIONS)) if rng.random() < 0.3 else int(table[step.next_state].argmax())
    )


@SOME_SEEDS
@pytest.mark.parametrize("initial", INITIAL)
@pytest.mark.parametrize("seed", range(3))
def test_a_maximum_over_allowed_actions_is_q_learning(seed: int, initial: str) -> None:
    verdict = verdict_of(recorded(reading(best_allowed(seed)), seed, initial=initial))
    update = verdict.update
    assert (update.rule, update.target) == (Rule.Q_LEARNING, UpdateTarget.ALLOWED)
    assert (update.alpha, update.gamma, update.fits) == (ALPHA, GAMMA, 1.0)
    assert verdict.findings == ()


@pytest.mark.parametrize("initial", INITIAL)
def test_the_last_reward_lost_under_a_mask_is_found(initial: str) -> None:
    verdict = verdict_of(recorded(reading(best_allowed(1), at_ends=False), 1, initial=initial))
    assert verdict.update.target is UpdateTarget.ALLOWED
    (finding,) = verdict.findings
    assert finding.fault is CodeFault.LOSES_UPDATE
    assert finding.steps_for > 100
    assert finding.correction.endswith("gamma * max(Q[s2, b] for b in allowed)")


@SOME_SEEDS
@pytest.mark.parametrize("initial", INITIAL)
@pytest.mark.parametrize("seed", range(3))
def test_a_next_action_that_is_drawn_again_is_a_note(seed: int, initial: str) -> None:
    log = recorded(reading(drawn_again(seed)), seed, initial=initial)
    verdict = verdict_of(log)
    update = verdict.update
    assert (update.rule, update.target) == (Rule.SARSA, UpdateTarget.DRAWN)
    assert (update.alpha, update.gamma) == (ALPHA, GAMMA)
    assert verdict.findings == ()
    (note,) = verdict.notes
    assert "as if it was drawn separately" in note
    last = int(log.recording.changes.step[-1])
    assert update_of_step(log.recording, update, last).explained


def test_the_least_estimate_is_neither() -> None:
    least = reading(lambda table, step: int(table[step.next_state].argmin()))
    assert verdict_of(recorded(least)).update.rule is Rule.UNKNOWN


def test_a_mask_is_not_told_of_a_few_steps() -> None:
    log = recorded(reading(best_allowed(0)), steps=25)
    assert verdict_of(log).update.target is not UpdateTarget.ALLOWED


def stories(recording: Recording) -> list[StepUpdate]:
    update = update_of(Evidence(recording))
    return [update_of_step(recording, update, step) for step in range(500, 900)]


@pytest.mark.parametrize(
    "made",
    [
        {"rule": "q"},
        {"rule": "sarsa"},
        {"rule": "expected"},
        {"rule": "q", "dtype": np.float32},
        {"rule": "sarsa", "alpha": lambda visits, _: 1 / visits},
        {"rule": "q", "alpha": lambda _, episode: 0.5 * 0.99**episode},
        {"rule": "q", "own_reward": lambda s, a, t, r: 3 * r - s},
        {"rule": "sarsa", "late_update": True},
        {"rule": "q", "reward_late": True},
        {"rule": "q", "bootstraps_after_end": True, "initial": 1.0},
    ],
)
def test_the_parts_of_a_step_come_to_what_moved(made: dict[str, Any]) -> None:
    recording = Made(**made).recording(2000)
    explained = [story for story in stories(recording) if story.explained and story.moved]
    assert len(explained) > 250
    for story in explained:
        assert None not in (story.step_size, story.gathered, story.discount, story.bootstrap)
        target = story.gathered + story.discount * story.bootstrap  # type: ignore[operator]
        after = story.before + story.step_size * (target - story.before)  # type: ignore[operator]
        assert after == pytest.approx(story.after, rel=1e-5, abs=1e-6)
        assert story.moved == (CellChange(story.cell, story.before, story.after),)


def test_of_q_learning_each_part_is_the_one_of_the_update() -> None:
    recording = Made().recording(2000)
    steps = recording.steps
    for story in stories(recording):
        ended = bool(steps.terminated[story.step])
        row = recording.table_at(story.step).reshape(-1, 3)[steps.next_state[story.step]]
        assert (story.step_size, story.discount) == (0.1, 0.9)
        assert story.gathered == steps.reward[story.step]
        assert story.bootstrap == (0.0 if ended else row.max())
        assert story.bootstrap_state == (NOTHING if ended else steps.next_state[story.step])


def test_a_step_that_departs_and_one_of_an_unknown_update_have_no_parts() -> None:
    recording = Made().recording(2000)
    update = update_of(Evidence(recording))
    at = int(np.flatnonzero(recording.changes.step == 1234)[0])
    recording.changes.after[at] += 0.5
    departed = update_of_step(recording, update, 1234)
    assert (departed.explained, departed.gathered, len(departed.moved)) == (False, None, 1)
    unknown = update_of_step(recording, UpdateFound(), 1300)
    assert not unknown.explained
    assert [change.after for change in unknown.moved] == [unknown.after]


def test_the_newest_step_of_sarsa_is_explained_before_its_next_action_is_known() -> None:
    recording = Made(rule="sarsa").recording(2000)
    update = update_of(Evidence(recording))
    newest = len(recording.steps.state) - 1
    story = update_of_step(recording, update, newest, recording.table_at(newest))
    assert story.explained == bool(story.moved)


def test_of_several_cells_all_are_named_and_none_is_the_one() -> None:
    recording = Recording()
    recording.find_table(0, 2, np.zeros(4))
    recording.add(np.array([[0, 0, 1, 1.0, 1, 0, 0, 0]]), np.array([[0, 1, 0, 0.5], [0, 2, 0, 0.25]]))
    story = update_of_step(recording, UpdateFound(), 0)
    assert story.moved == (CellChange(1, 0.0, 0.5), CellChange(2, 0.0, 0.25))
    assert (story.cell, story.explained) == (NOTHING, False)


def test_a_step_that_is_not_kept_is_refused() -> None:
    recording = Made().recording(100)
    with pytest.raises(ValueError, match="not kept"):
        update_of_step(recording, UpdateFound(), 100)
