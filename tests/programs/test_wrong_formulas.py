"""Updates with a wrong formula."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from correct_learners import ALPHA, GAMMA, q_learning
from made_recordings import ACTIONS, STATES, Learner, Step, recorded

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.evidence.verdict import CodeFault, CodeFinding
from rl_tui.programs.watched.program_log import ProgramEnvironment, ProgramLog
from rl_tui.worlds.mdp.space import FloatArray

Formula = Callable[[float, float, float, float], float]
"""The new estimate from the old one, the reward, max Q(s′) and Q(s′, a′)."""
WORLDS = {
    "dense": {"initial": "random"},
    "sparse": {"initial": "zeros", "rewards": (0.0,) * 9 + (1.0,)},
    "optimistic": {"initial": "high", "greedy": 0.8},
}
ALL_WORLDS = {**WORLDS, "costs": {"initial": "zeros", "rewards": (-1.0,)}}
PROVEN: dict[str, tuple[Formula, str]] = {
    "γ − Q": (lambda q, r, best, taken: q + ALPHA * (r + GAMMA - taken - q), "Q(s′, a′) is subtracted."),
    "minus max": (lambda q, r, best, taken: q + ALPHA * (r - GAMMA * best - q), "max Q(s′) is subtracted."),
    "plus Q": (lambda q, r, best, taken: q + ALPHA * (r + GAMMA * best + q), "Q(s, a) is added."),
    "without Q": (lambda q, r, best, taken: q + ALPHA * (r + GAMMA * best), "Q(s, a) is not subtracted."),
    "α forgotten": (lambda q, r, best, taken: (1 - ALPHA) * q + r + GAMMA * best, "That is γ 9"),
}
DECLARED: dict[str, tuple[Formula, str]] = {
    "Q forgotten": (lambda q, r, best, taken: ALPHA * (r + GAMMA * best), "(1 − α) Q(s, a) is missing."),
    "= for +=": (lambda q, r, best, taken: ALPHA * (r + GAMMA * best - q), "with = in place of +="),
    "γ of both": (
        lambda q, r, best, taken: q + ALPHA * (r + GAMMA * (best - q)),
        "γ multiplies Q(s, a) too.",
    ),
    "α of r": (lambda q, r, best, taken: ALPHA * r + GAMMA * best, "α multiplies r only."),
}
RIGHT: dict[str, Formula] = {
    "right": lambda q, r, best, taken: q + ALPHA * (r + GAMMA * best - q),
    "twice the reward": lambda q, r, best, taken: q + ALPHA * (2 * r + GAMMA * best - q),
    "a cost": lambda q, r, best, taken: q + ALPHA * (-r + GAMMA * best - q),
    "a cost for each step": lambda q, r, best, taken: q + ALPHA * (r - 1 + GAMMA * best - q),
    "no next state": lambda q, r, best, taken: q + ALPHA * (r - q),
    "a sum": lambda q, r, best, taken: q + r,
    "undiscounted": lambda q, r, best, taken: q + ALPHA * (r + taken - q),
    "decays": lambda q, r, best, taken: 0.99 * q + ALPHA * (r + GAMMA * best - q),
}


def by(formula: Formula) -> Learner:
    def learn(table: FloatArray, step: Step) -> None:
        row, old = table[step.next_state], table[step.state, step.action]
        best, taken = (0.0, 0.0) if step.terminated else (row.max(), row[step.next_action])
        table[step.state, step.action] = formula(old, step.reward, best, taken)

    return learn


def in_taxi(log: ProgramLog) -> ProgramLog:
    log.environments.append(ProgramEnvironment(0, "Taxi-v3", None, (STATES,), ACTIONS, 12))
    log.numbers |= {"alpha": ALPHA, "gamma": GAMMA}
    return log


def findings(log: ProgramLog) -> list[CodeFinding]:
    return list(verdict_of(log).findings)


@pytest.mark.parametrize("world", ALL_WORLDS.values(), ids=ALL_WORLDS)
@pytest.mark.parametrize("name", PROVEN)
def test_a_wrong_sign_or_term_is_proved(name: str, world: dict[str, object]) -> None:
    formula, said = PROVEN[name]
    log = in_taxi(recorded(by(formula), 1, steps=600, **world))  # type: ignore[arg-type]
    (finding,) = findings(log)
    assert (finding.fault, finding.certainty) == (CodeFault.WRONG_FORMULA, "proven")
    assert (finding.steps_for > 300, finding.steps_against) == (True, 0)
    assert said in finding.text
    assert finding.correction.endswith("Q[s, a] += alpha * (target - Q[s, a])")


@pytest.mark.parametrize("world", WORLDS.values(), ids=WORLDS)
@pytest.mark.parametrize("name", DECLARED)
def test_a_misplaced_step_size_relies_on_its_name(name: str, world: dict[str, object]) -> None:
    formula, said = DECLARED[name]
    log = in_taxi(recorded(by(formula), 1, steps=600, **world))  # type: ignore[arg-type]
    (finding,) = findings(log)
    assert (finding.fault, finding.certainty) == (CodeFault.WRONG_FORMULA, "declared")
    assert said in finding.text
    log.numbers.clear()
    assert [each.certainty for each in findings(log)] == ["proven"] * (name == "= for +=")


def test_a_formula_is_written_with_its_factors() -> None:
    (finding,) = findings(in_taxi(recorded(by(PROVEN["γ − Q"][0]))))
    assert "by 0.1 r + 0.09 − 0.1 Q(s′, a′) − 0.1 Q(s, a)." in finding.text


@pytest.mark.exhaustive(
    "other random worlds", but=[f"{name}-{id_}-1" for name in RIGHT for id_ in ALL_WORLDS]
)
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("world", ALL_WORLDS.values(), ids=ALL_WORLDS)
@pytest.mark.parametrize("name", RIGHT)
def test_a_formula_that_an_own_reward_explains_is_no_fault(
    name: str, world: dict[str, object], seed: int
) -> None:
    log = in_taxi(recorded(by(RIGHT[name]), seed, steps=600, **world))  # type: ignore[arg-type]
    assert findings(log) == []


def test_in_a_game_of_two_the_value_of_the_next_state_is_the_opponents() -> None:
    log = recorded(by(PROVEN["minus max"][0]))
    log.environments.append(ProgramEnvironment(0, "TicTacToe-v0", {}, (STATES,), ACTIONS, 12))
    assert findings(log) == []


def test_one_step_that_departs_from_the_formula_is_enough() -> None:
    wrong, right = by(PROVEN["minus max"][0]), by(RIGHT["right"])

    def learn(table: FloatArray, step: Step) -> None:
        (right if step.number == 300 else wrong)(table, step)

    assert findings(in_taxi(recorded(learn))) == []


@pytest.mark.parametrize("world", ALL_WORLDS.values(), ids=ALL_WORLDS)
def test_an_old_estimate_that_is_not_subtracted_at_the_end_is_found(world: dict[str, object]) -> None:
    def learn(table: FloatArray, step: Step) -> None:
        old = table[step.state, step.action]
        error = GAMMA * table[step.next_state].max() - old
        table[step.state, step.action] += ALPHA * (step.reward + error * (not step.terminated))

    (finding,) = findings(recorded(learn, 1, **world))  # type: ignore[arg-type]
    assert (finding.fault, finding.steps_against) == (CodeFault.WRONG_FORMULA, 0)
    assert "the old estimate is not subtracted" in finding.text


def after_ends(log: ProgramLog, id_: str) -> ProgramLog:
    log.environments.append(ProgramEnvironment(0, id_, {}, (STATES,), ACTIONS, 12))
    steps = log.recording.steps
    steps.episode[:] = 0
    goes_on = np.flatnonzero(steps.terminated[:-1])
    steps.state[goes_on + 1] = steps.next_state[goes_on]
    return log


@pytest.mark.parametrize("id_", ["FrozenLake-v1", "Taxi-v3", "CliffWalking-v1"])
def test_steps_after_the_end_are_found(id_: str) -> None:
    log = after_ends(recorded(q_learning, steps=300), id_)
    found = {each.fault: each for each in findings(log)}
    finding = found[CodeFault.STEPS_AFTER_END]
    assert log.recording.steps.terminated[finding.step - 1]
    assert finding.steps_for == int(log.recording.steps.terminated[:-1].sum())
    assert finding.correction.endswith(
        "begin the next episode when terminated or truncated is true: s, info = env.reset()"
    )


@pytest.mark.parametrize("id_", ["Own-v0", "FrozenLakeThatGoesOn-v0", "rl_tui/bandit-v0"])
def test_an_end_of_an_own_environment_may_be_a_limit(id_: str) -> None:
    log = after_ends(recorded(q_learning, steps=300), id_)
    assert CodeFault.STEPS_AFTER_END not in [each.fault for each in findings(log)]


def test_a_state_that_was_set_after_the_end_begins_an_episode() -> None:
    log = after_ends(recorded(q_learning, steps=300), "FrozenLake-v1")
    steps = log.recording.steps
    goes_on = np.flatnonzero(steps.terminated[:-1])
    steps.state[goes_on + 1] = (steps.next_state[goes_on] + 1) % STATES
    assert CodeFault.STEPS_AFTER_END not in [each.fault for each in findings(log)]
