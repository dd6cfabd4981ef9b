"""Double Q-learning, right and wrong."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from correct_learners import ALPHA, GAMMA
from made_recordings import ACTIONS, STATES, Learner, Step, recorded
from watched_scripts import script_in, watched

from rl_tui.common.findings import command_line
from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.evidence.verdict import CodeFault, Rule, UpdateTarget
from rl_tui.programs.watched.program_log import ProgramLog
from rl_tui.worlds.mdp.space import FloatArray

Value = Callable[[FloatArray, FloatArray, Step], float]
"""The next value, from the rows of the next state: of the updated table, and of the other table."""
INITIAL = ("random", "zeros", "high")


def right(own: FloatArray, other: FloatArray, _: Step) -> float:
    return float(other[own.argmax()])


def own_best(own: FloatArray, _: FloatArray, __: Step) -> float:
    return float(own.max())


def other_best(_: FloatArray, other: FloatArray, __: Step) -> float:
    return float(other.max())


def two_tables(value: Value, is_first: Callable[[Step], bool] | None = None, *, seed: int = 0) -> Learner:
    """Return a learner of two tables with ``value`` in its target. A coin chooses the table by default."""
    rng = np.random.default_rng((7, seed))

    def learn(tables: FloatArray, step: Step) -> None:
        first = rng.random() < 0.5 if is_first is None else is_first(step)
        own, other = tables if first else tables[::-1]
        future = 0.0 if step.terminated else value(own[step.next_state], other[step.next_state], step)
        own[step.state, step.action] += ALPHA * (step.reward + GAMMA * future - own[step.state, step.action])

    return learn


def box_6_7(log: ProgramLog, alpha: float, gamma: float) -> FloatArray:
    """Return both tables by the box on page 136. The recording only decides which table it was."""
    recording = log.recording
    q1, q2 = np.nan_to_num(recording.initial_pair).reshape(2, -1, recording.actions)
    changes = recording.changes_of_pair
    is_move = np.nan_to_num(changes.before) != changes.after  # a dict also makes rows of zeros
    changed = dict(zip(changes.step[is_move], changes.cell[is_move] // q1.size, strict=True))
    steps = recording.steps
    for t in range(recording.paired_at, recording.count):
        s, a, r, s2 = steps.state[t], steps.action[t], steps.reward[t], steps.next_state[t]
        if steps.terminated[t]:
            next1 = next2 = 0.0  # the value of a terminal state
        else:
            next1, next2 = q2[s2, np.argmax(q1[s2])], q1[s2, np.argmax(q2[s2])]
        if changed.get(t) == 0:
            q1[s, a] += alpha * (r + gamma * next1 - q1[s, a])
        elif changed.get(t) == 1:
            q2[s, a] += alpha * (r + gamma * next2 - q2[s, a])
    return np.stack([q1, q2])


def tables_at_the_end(log: ProgramLog) -> FloatArray:
    tables, changes = np.nan_to_num(log.recording.initial_pair), log.recording.changes_of_pair
    for cell, after in zip(changes.cell, changes.after, strict=True):
        tables[cell] = after
    return tables.reshape(2, -1, log.recording.actions)


# Recordings


@pytest.mark.exhaustive(
    "other random worlds", but=[f"{seed}-{initial}" for seed, initial in enumerate(INITIAL)]
)
@pytest.mark.parametrize("initial", INITIAL)
@pytest.mark.parametrize("seed", range(4))
def test_the_update_is_double_q_learning(seed: int, initial: str) -> None:
    log = recorded(two_tables(right, seed=seed), seed, initial=initial, is_pair=True)
    verdict = verdict_of(log)
    update = verdict.update
    assert (update.rule, update.target) == (Rule.DOUBLE_Q, UpdateTarget.BEST_BY_OTHER)
    assert (update.alpha, update.gamma, update.fits) == (ALPHA, GAMMA, 1.0)
    assert verdict.findings == ()
    assert verdict.notes == ("Q1 and Q2 change in turn. Their mean is shown. --table Q1 shows only Q1.",)
    assert tables_at_the_end(log) == pytest.approx(box_6_7(log, ALPHA, GAMMA), abs=1e-12)


@pytest.mark.parametrize("initial", INITIAL)
@pytest.mark.parametrize(
    ("value", "target"), [(own_best, UpdateTarget.BEST), (other_best, UpdateTarget.OTHER_BEST)]
)
@pytest.mark.parametrize("seed", range(2))
def test_one_table_alone_in_the_target_is_found(
    seed: int, value: Value, target: UpdateTarget, initial: str
) -> None:
    verdict = verdict_of(recorded(two_tables(value, seed=seed), seed, initial=initial, is_pair=True))
    assert (verdict.update.rule, verdict.update.target) == (Rule.DOUBLE_Q, target)
    assert (verdict.update.alpha, verdict.update.gamma) == (ALPHA, GAMMA)
    (finding,) = verdict.findings
    assert (finding.fault, finding.certainty, finding.steps_against) == (CodeFault.WRONG_TABLE, "proven", 0)
    assert finding.steps_for > 50
    assert finding.correction.endswith("Q1: target = r if terminated else r + gamma * Q2[s2, argmax(Q1[s2])]")


def test_the_text_names_the_tables_of_the_first_step() -> None:
    log = recorded(two_tables(own_best), is_pair=True)
    (finding,) = verdict_of(log).findings
    changes = log.recording.changes_of_pair
    own = int(changes.cell[changes.step == finding.step][0]) // (STATES * ACTIONS)
    names = ("Q1", "Q2")
    assert f" {names[own]} changed. " in finding.text
    assert f"maximum of {names[own]} in state" in finding.text
    assert finding.text.endswith(f"the value in {names[1 - own]} of the best action in {names[own]}.")


SILENT: dict[str, Learner] = {
    "the other table chooses": two_tables(lambda own, other, step: own[other.argmax()]),
    "Double SARSA": two_tables(lambda own, other, step: other[step.next_action]),
    "the smaller value": two_tables(lambda own, other, step: min(own.max(), other[own.argmax()])),
    "the best mean": two_tables(lambda own, other, step: (own + other).max() / 2),
    "two learners in strict turn": two_tables(own_best, lambda step: step.number % 2 == 0),
    "two learners by episode": two_tables(own_best, lambda step: step.episode % 2 == 0),
    "two learners in other states": two_tables(own_best, lambda step: step.state % 2 == 0),
    "right, in strict turn": two_tables(right, lambda step: step.number % 2 == 0),
}


@pytest.mark.parametrize("initial", INITIAL)
@pytest.mark.parametrize("name", SILENT)
def test_other_learners_of_two_tables_are_not_blamed(name: str, initial: str) -> None:
    log = recorded(SILENT[name], 1, initial=initial, is_pair=True)
    assert verdict_of(log).findings == ()


def test_few_steps_do_not_tell_which_table_is_read() -> None:
    update = verdict_of(recorded(two_tables(right), steps=15, is_pair=True)).update
    assert update.rule is Rule.UNKNOWN
    assert update.reason


# Scripts


_SCRIPT = """
import random
from collections import defaultdict
import gymnasium as gym
import numpy as np

{before}
env = gym.make("CliffWalking-v1", max_episode_steps=100)
for episode in range(60):
    s, _ = env.reset()
    done = cut = False
    while not (done or cut):
        total = np.array({one}[s]) + np.array({two}[s])
        a = random.randrange(4) if random.random() < 0.2 else int(np.argmax(total))
        s2, r, done, cut, _ = env.step(a)
        if random.random() < 0.5:
            {one}[s][a] += 0.2 * (r + 0.9 * (0 if done else {first}) - {one}[s][a])
        else:
            {two}[s][a] += 0.2 * (r + 0.9 * (0 if done else {second}) - {two}[s][a])
        s = s2
"""
_FORMS = {
    "two arrays": ("Q1 = np.zeros((48, 4)); Q2 = np.zeros((48, 4))", "Q1", "Q2"),
    "attributes": (
        "class Agent: pass\nme = Agent(); me.q_a = [[0.0] * 4 for _ in range(48)]; "
        "me.q_b = [[0.0] * 4 for _ in range(48)]",
        "me.q_a",
        "me.q_b",
    ),
    "a list": ("Q = [np.zeros((48, 4)), np.zeros((48, 4))]", "Q[0]", "Q[1]"),
    "a dict": ("Q = {key: defaultdict(lambda: np.zeros(4)) for key in 'AB'}", "Q['A']", "Q['B']"),
    "an array of both": ("Q = np.zeros((2, 48, 4))", "Q[0]", "Q[1]"),
}
_READ = {
    "right": "{other}[s2][int(np.argmax({own}[s2]))]",
    "own": "max({own}[s2])",
    "other": "max({other}[s2])",
}
_EACH_SEED = [
    *((form, "right", seed) for form in _FORMS for seed in range(20)),
    *((form, fault, seed) for form in _FORMS for fault in ("own", "other") for seed in range(5)),
]


def _watched(folder: Path, form: str, read: str, seed: int, **more: str) -> ProgramLog:
    before, one, two = _FORMS[form]
    first, second = (_READ[read].format(own=own, other=other) for own, other in ((one, two), (two, one)))
    text = _SCRIPT.format(before=before, one=one, two=two, first=first, second=second)
    return watched(script_in(folder, text), seed=seed, **more)


@pytest.mark.process
@pytest.mark.exhaustive(
    "watches 150 programs",
    but=[f"{form}-right-1" for form in _FORMS] + ["two arrays-own-0", "a list-other-0"],
)
@pytest.mark.parametrize(("form", "read", "seed"), _EACH_SEED)
def test_a_script_with_two_tables_is_judged(tmp_path: Path, form: str, read: str, seed: int) -> None:
    log = _watched(tmp_path, form, read, seed)
    verdict = verdict_of(log)

    assert log.error is None
    assert (log.table.name, log.table.other) == _FORMS[form][1:]
    assert (verdict.update.rule, verdict.update.alpha, verdict.update.gamma) == (Rule.DOUBLE_Q, 0.2, 0.9)
    expected = [] if read == "right" else [CodeFault.WRONG_TABLE]
    assert [each.fault for each in verdict.findings] == expected
    both = tables_at_the_end(log)
    if read == "right":
        assert both == pytest.approx(box_6_7(log, 0.2, 0.9), abs=1e-9)
    shown = log.recording.table_at(log.recording.count).reshape(-1, 4)
    assert np.nan_to_num(shown) == pytest.approx(np.nan_to_num(both).mean(0), abs=1e-12)


@pytest.mark.process
def test_a_note_quotes_the_option_for_one_table(tmp_path: Path) -> None:
    notes = verdict_of(_watched(tmp_path, "a dict", "right", 1)).notes
    option = command_line(("--table", "Q['A']"))
    assert f"Q['A'] and Q['B'] change in turn. Their mean is shown. {option} shows only Q['A']." in notes


@pytest.mark.process
def test_counts_beside_a_table_are_no_table(tmp_path: Path) -> None:
    text = _SCRIPT.format(
        before="Q = {'N': np.zeros((48, 4)), 'Q': np.zeros((48, 4))}",
        one="Q['Q']",
        two="Q['Q']",
        first="0",
        second="0",
    )
    assert watched(script_in(tmp_path, text)).table is None


@pytest.mark.process
@pytest.mark.parametrize(("form", "table"), [("two arrays", "Q2"), ("a list", "Q[1]")])
def test_a_person_can_follow_one_of_two_tables(tmp_path: Path, form: str, table: str) -> None:
    log = _watched(tmp_path, form, "right", 0, table=table)

    assert (log.table.name, log.table.other) == (table, "")
    assert log.recording.initial_pair is None
    assert verdict_of(log).findings == ()
