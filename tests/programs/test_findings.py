"""The findings about given steps, their limits, and correct programs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from correct_learners import ALPHA, CORRECT_LEARNERS, GAMMA, best, moved, q_learning, sarsa
from made_recordings import ACTIONS, STATES, Learner, Step, recorded

from rl_tui.programs.diagnosis.diagnosis import findings_of, verdict_of
from rl_tui.programs.diagnosis.faults.cells import proof_of_cell
from rl_tui.programs.evidence.code_names import CodeNames
from rl_tui.programs.evidence.evidence import Evidence
from rl_tui.programs.evidence.verdict import (
    CodeFault,
    CodeFinding,
    MovedCell,
    Rule,
    SuspectedRisk,
    UpdateFound,
    UpdateTarget,
)
from rl_tui.programs.grading.grade import GradedRun, GradedSubmission
from rl_tui.programs.grading.watch_report import finding_as_json
from rl_tui.programs.watched.messages import StepFlag
from rl_tui.programs.watched.program_log import FoundTable, ProgramAgent, ProgramEnvironment, ProgramLog
from rl_tui.programs.watched.recording import Recording
from rl_tui.worlds.mdp.space import FloatArray

SEEDS = range(3)
Q_LEARNING = UpdateFound(
    Rule.Q_LEARNING, ALPHA, "constant", GAMMA, fits=1.0, informative=1000, target=UpdateTarget.BEST
)
SARSA = replace(Q_LEARNING, rule=Rule.SARSA, target=UpdateTarget.NEXT_ACTION)
UNKNOWN = UpdateFound()


def bootstraps(table: FloatArray, step: Step) -> None:
    moved(table, step, step.reward + GAMMA * table[step.next_state].max())


def sarsa_bootstraps(table: FloatArray, step: Step) -> None:
    moved(table, step, step.reward + GAMMA * table[step.next_state, step.next_action])


def done_is_done(table: FloatArray, step: Step) -> None:
    """Treats the time limit as a terminal state."""
    over = step.terminated or step.truncated
    moved(table, step, step.reward + (0.0 if over else GAMMA * table[step.next_state].max()))


def previous_reward(table: FloatArray, step: Step) -> None:
    """Takes the reward of the step before, even across episodes."""
    moved(table, step, step.reward_before + GAMMA * best(table, step))


def previous_reward_within(table: FloatArray, step: Step) -> None:
    moved(table, step, (0.0 if step.first else step.reward_before) + GAMMA * best(table, step))


def after_moving(table: FloatArray, step: Step) -> None:
    cell = step.next_state, step.action
    table[cell] += ALPHA * (step.reward + GAMMA * best(table, step) - table[cell])


def swapped(table: FloatArray, step: Step) -> None:
    cell = step.next_state, step.action
    table[cell] += ALPHA * (step.reward + GAMMA * table[step.state].max() - table[cell])


def column(table: FloatArray, step: Step) -> None:
    moved(table, step, step.reward + (0.0 if step.terminated else GAMMA * table[:, step.action].max()))


def own_state(table: FloatArray, step: Step) -> None:
    moved(table, step, step.reward + (0.0 if step.terminated else GAMMA * table[step.state].max()))


def next_cell(table: FloatArray, step: Step) -> None:
    cell = step.state, step.next_action
    table[cell] += ALPHA * (step.reward - table[cell])


def shares(table: FloatArray, step: Step) -> None:
    q_learning(table, step)
    table[:, step.action] = table[step.state, step.action]


def skips_ends(table: FloatArray, step: Step) -> None:
    if not step.terminated:
        q_learning(table, step)


def takes_too_much(table: FloatArray, step: Step) -> None:
    moved(table, step, step.reward + GAMMA * best(table, step), alpha=1.2)


@dataclass(frozen=True)
class Faulty:
    learner: Learner
    fault: CodeFault
    update: UpdateFound = Q_LEARNING
    initial: str = "random"
    dtype: str = "float64"
    arrange: Callable[[ProgramLog], None] = lambda _: None


def shared(log: ProgramLog) -> None:
    log.shared_at = 0


def holds_gamma(log: ProgramLog) -> None:
    """Give the code the root of its discount."""
    log.numbers["agent.gamma"] = GAMMA**0.5


def holds_numbers(log: ProgramLog) -> None:
    log.numbers |= {"alpha": ALPHA, "gamma": GAMMA, "epsilon": 0.05}


FAULTY = {
    "terminal row": Faulty(bootstraps, CodeFault.BOOTSTRAPS_AFTER_END),
    "terminal row, optimistic": Faulty(bootstraps, CodeFault.BOOTSTRAPS_AFTER_END, initial="high"),
    "terminal row, float32": Faulty(bootstraps, CodeFault.BOOTSTRAPS_AFTER_END, dtype="float32"),
    "terminal row of SARSA": Faulty(sarsa_bootstraps, CodeFault.BOOTSTRAPS_AFTER_END, SARSA),
    "cut off": Faulty(done_is_done, CodeFault.NO_BOOTSTRAP_AFTER_TRUNCATION),
    "reward before": Faulty(previous_reward, CodeFault.SHIFTED_REWARD, replace(Q_LEARNING, fits=0.6)),
    "reward before, 0 at first": Faulty(previous_reward_within, CodeFault.SHIFTED_REWARD),
    "moved": Faulty(
        after_moving,
        CodeFault.UPDATES_AFTER_MOVING,
        replace(Q_LEARNING, place=MovedCell.MOVED),
        initial="zeros",
    ),
    "moved, no rule": Faulty(after_moving, CodeFault.UPDATES_AFTER_MOVING, UNKNOWN),
    "swapped": Faulty(swapped, CodeFault.WRONG_CELL, UNKNOWN),
    "swapped, float32": Faulty(swapped, CodeFault.WRONG_CELL, UNKNOWN, dtype="float32"),
    "column": Faulty(column, CodeFault.WRONG_AXIS, replace(Q_LEARNING, target=UpdateTarget.COLUMN)),
    "own state": Faulty(
        own_state, CodeFault.WRONG_FORMULA, replace(Q_LEARNING, target=UpdateTarget.OWN_STATE)
    ),
    "next action": Faulty(next_cell, CodeFault.WRONG_CELL, UNKNOWN),
    "shared": Faulty(shares, CodeFault.SHARED_TABLE, UNKNOWN, initial="zeros", arrange=shared),
    "ends lost": Faulty(skips_ends, CodeFault.LOSES_UPDATE),
    "step size": Faulty(takes_too_much, CodeFault.STEP_SIZE_OUT_OF_RANGE, replace(Q_LEARNING, alpha=1.2)),
    "gamma twice": Faulty(q_learning, CodeFault.GAMMA_TWICE, arrange=holds_gamma),
    "integers": Faulty(
        q_learning, CodeFault.ROUNDING_TABLE, UNKNOWN, initial="high", dtype="int64", arrange=holds_numbers
    ),
}


def found(log: ProgramLog, update: UpdateFound) -> tuple[CodeFinding, ...]:
    assert log.table is not None
    return findings_of(Evidence(log.recording, log.numbers, log.table.dtype), update, log)[0]


@pytest.mark.exhaustive("other random worlds", but=[f"{name}-0" for name in FAULTY])
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", FAULTY)
def test_a_fault_is_told_alone_and_nothing_speaks_against_it(name: str, seed: int) -> None:
    faulty = FAULTY[name]
    log = recorded(faulty.learner, seed, initial=faulty.initial, dtype=faulty.dtype)
    faulty.arrange(log)
    (finding,) = found(log, faulty.update)
    assert finding.fault is faulty.fault
    assert finding.steps_for >= 3
    assert finding.steps_against == 0
    assert 0 <= finding.step < log.recording.count
    assert finding.text
    assert finding.correction


def undiscounted(table: FloatArray, step: Step) -> None:
    moved(table, step, step.reward + best(table, step))


def short_sighted(table: FloatArray, step: Step) -> None:
    moved(table, step, step.reward)


CORRECT: dict[str, tuple[Learner, UpdateFound]] = {
    "sarsa, not found": (sarsa, UNKNOWN),
    "gamma 1": (undiscounted, replace(Q_LEARNING, gamma=1.0)),
    "gamma 0": (short_sighted, replace(Q_LEARNING, gamma=0.0, target=UpdateTarget.NOTHING)),
    "gamma not known": (q_learning, replace(Q_LEARNING, gamma=None)),
}


@pytest.mark.parametrize("initial", ["random", "zeros", "high"])
@pytest.mark.parametrize("name", CORRECT)
def test_of_what_is_right_nothing_is_told(name: str, initial: str) -> None:
    learner, update = CORRECT[name]
    for seed in SEEDS:
        log = recorded(learner, seed, initial=initial)
        holds_numbers(log)
        assert found(log, update) == (), seed


@pytest.mark.parametrize("schedule", ["1/N", "by-episode"])
def test_a_fault_is_told_also_where_the_step_size_falls(schedule: str) -> None:
    counts: dict[tuple[int, int], int] = {}

    def learn(table: FloatArray, step: Step) -> None:
        cell = step.state, step.action
        counts[cell] = counts.get(cell, 0) + 1
        alpha = 1.0 / counts[cell] if schedule == "1/N" else 0.5 * 0.999**step.episode
        moved(table, step, step.reward + GAMMA * table[step.next_state].max(), alpha=alpha)

    update = replace(Q_LEARNING, alpha=None, alpha_schedule=schedule)  # type: ignore[arg-type]
    faults = [each.fault for each in found(recorded(learn), update)]
    assert faults == [CodeFault.BOOTSTRAPS_AFTER_END]


def test_one_flag_for_both_ends_is_no_fault_of_the_agent() -> None:
    log = recorded(done_is_done)
    log.agent = ProgramAgent("Agent", "udacity", done_is_either=True)
    assert found(log, Q_LEARNING) == ()


def test_two_steps_are_not_enough() -> None:
    log = recorded(bootstraps, steps=1500)
    first = found(log, Q_LEARNING)[0]
    ends = np.flatnonzero(log.recording.steps.terminated)
    assert first.step == ends[0]
    assert found(recorded(bootstraps, steps=int(ends[1]) + 1), Q_LEARNING) == ()
    assert len(found(recorded(bootstraps, steps=int(ends[2]) + 1), Q_LEARNING)) == 1


def test_one_step_that_speaks_against_it_is_enough() -> None:
    def once_right(table: FloatArray, step: Step) -> None:
        (q_learning if step.number > 1400 else bootstraps)(table, step)

    assert found(recorded(once_right), Q_LEARNING) == ()


def test_the_square_of_a_discount_is_a_discount_where_the_code_holds_it() -> None:
    log = recorded(q_learning)
    holds_gamma(log)
    log.numbers["discount"] = GAMMA
    assert found(log, Q_LEARNING) == ()


def test_a_number_that_is_no_discount_is_no_root() -> None:
    log = recorded(q_learning)
    log.numbers["epsilon_decay"] = GAMMA**0.5
    assert found(log, Q_LEARNING) == ()


def test_integers_that_lose_nothing_are_no_fault() -> None:
    def counts_steps(table: FloatArray, step: Step) -> None:
        moved(table, step, step.reward + best(table, step), alpha=1.0)

    log = recorded(counts_steps, initial="zeros", dtype="int64")
    log.numbers["alpha"] = 1.0
    assert found(log, UNKNOWN) == ()


def test_a_shared_row_is_told_only_where_rows_move_alike() -> None:
    log = recorded(q_learning)
    log.shared_at = 0
    assert found(log, Q_LEARNING) == ()


def often_the_first(number: int) -> int:
    return number % 4 if number % 10 == 0 else 0


def standing(
    episodes: int, action_of: Callable[[int], int], recording: Recording | None = None
) -> ProgramLog:
    """Return a program that never leaves the corner of the frozen lake, with a table of zeros."""
    count = 100 * episodes
    number = np.arange(count)
    columns = np.zeros((count, 8))
    columns[:, 2] = [action_of(each) for each in number]
    columns[99::100, 5] = StepFlag.TRUNCATED
    columns[:, 6], columns[:, 7] = number // 100, number % 100
    table = FoundTable("Q", "array", (16, 4), "float64")
    log = ProgramLog(recording or Recording(), table=table, ended=True)
    log.environments.append(ProgramEnvironment(0, "FrozenLake-v1", {"is_slippery": False}, (16,), 4, 100))
    log.recording.find_table(0, 4, np.zeros(64))
    log.recording.add(columns, np.empty((0, 4)))
    return log


@pytest.mark.parametrize(
    ("action_of", "fault"),
    [(lambda number: 0, CodeFault.NEVER_EXPLORES), (often_the_first, CodeFault.FIRST_OF_TIES)],
    ids=["never", "first"],
)
def test_a_risk_is_told_where_random_ties_would_have_seen_a_reward(
    action_of: Callable[[int], int], fault: CodeFault
) -> None:
    (finding,) = found(standing(700, action_of), UNKNOWN)
    assert finding.fault is fault
    assert finding.kind == "risk"
    assert found(standing(50, action_of), UNKNOWN) == ()  # few episodes: it may be bad luck


def test_a_dict_that_gets_rows_of_zeros_has_learned_nothing() -> None:
    log, absent = standing(700, often_the_first), np.full(64, np.nan)
    log.recording.find_table(0, 4, absent)
    cells = np.arange(4.0)
    log.recording.add(np.empty((0, 8)), np.column_stack((np.zeros(4), cells, absent[:4], np.zeros(4))))
    assert [each.fault for each in found(log, UNKNOWN)] == [CodeFault.FIRST_OF_TIES]
    one = np.array([[2.0, 0.0, 0.0, 1.0]])
    log.recording.add(np.empty((0, 8)), one)
    assert found(log, UNKNOWN) == ()


def test_a_long_run_is_judged_by_the_episodes_that_are_kept() -> None:
    log = standing(1400, often_the_first, Recording(most=100_000))
    (finding,) = found(log, UNKNOWN)
    assert log.recording.first > 0
    assert finding.fault is CodeFault.FIRST_OF_TIES
    assert finding.step >= log.recording.first


def test_where_all_actions_are_taken_there_is_no_risk() -> None:
    assert found(standing(700, lambda number: number * 7 // 3 % 4), UNKNOWN) == ()


def test_without_a_table_of_transitions_nothing_is_said_of_luck() -> None:
    log = standing(700, lambda number: 0)
    log.environments[0] = ProgramEnvironment(0, "Own-v0", None, (16,), 4, 100)
    assert found(log, UNKNOWN) == ()


def test_a_table_of_integers_that_nothing_writes_to_is_no_fault() -> None:
    log = recorded(lambda table, step: None, initial="zeros", dtype="int64")
    holds_numbers(log)
    assert found(log, UNKNOWN) == ()


def test_a_finding_that_rests_on_a_name_says_so() -> None:
    log = recorded(q_learning)
    holds_gamma(log)
    (finding,) = found(log, Q_LEARNING)
    assert finding.certainty == "declared"
    assert finding.correction.endswith("agent.gamma * max(Q[s2])")


def test_people_count_steps_from_1() -> None:
    (finding,) = found(recorded(done_is_done), Q_LEARNING)
    log = recorded(done_is_done)
    assert log.recording.steps.truncated[finding.step]
    assert finding.text.startswith(f"At step {finding.step + 1:,} the time limit")
    assert finding_as_json(finding)["step"] == finding.step + 1


def test_the_correction_of_shared_rows_is_of_the_form_of_the_table() -> None:
    assert CodeNames(form="lists").rows(3) == "[[0.0] * 3 for state in range(states)]"
    assert CodeNames(form="dict-of-arrays").rows(3) == "{state: [0.0] * 3 for state in range(states)}"


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_a_step_size_is_told_also_of_a_table_that_runs_away(dtype: str) -> None:
    def diverges(table: FloatArray, step: Step) -> None:
        with np.errstate(all="ignore"):
            moved(table, step, step.reward + GAMMA * best(table, step), alpha=10.0)

    log = recorded(diverges, dtype=dtype, steps=3000)
    assert not np.isfinite(log.recording.changes.after).all()
    assert [each.fault for each in verdict_of(log).findings] == [CodeFault.STEP_SIZE_OUT_OF_RANGE]


def test_a_cell_of_the_next_state_is_corrected_by_where_the_maximum_is_taken() -> None:
    (moved_on,) = found(recorded(after_moving, 0), UNKNOWN)
    (exchanged,) = found(recorded(swapped, 0), UNKNOWN)
    assert moved_on.correction == "update Q[s, a], not Q[s2, a], and set s = s2 after that"
    assert exchanged.correction.startswith("swap s and s2: target = ")


def test_a_state_that_step_overwrites_is_given_another_name() -> None:
    names = CodeNames(state="s", next_state="s")
    proof = proof_of_cell(Evidence(recorded(after_moving, 0).recording), names)
    assert proof.correction == (
        "call the next state next_s, then update Q[s, a], not Q[next_s, a], and set s = next_s after that"
    )
    exchanged = proof_of_cell(Evidence(recorded(swapped, 0).recording), names)
    assert exchanged.correction.startswith("call the next state next_s, then swap s and next_s: target = ")


WORLDS = {
    "dense": {"initial": "random", "rewards": (-1.0, 0.0, 0.0, 1.0, 2.0)},
    "costs": {"initial": "zeros", "rewards": (-1.0,), "greedy": 0.8},
    "sparse": {"initial": "high", "rewards": (0.0,) * 9 + (1.0,), "greedy": 0.7, "dtype": "float32"},
}


@pytest.mark.exhaustive(
    "other worlds", but=[f"{name}-{[*WORLDS][i % 3]}" for i, name in enumerate(CORRECT_LEARNERS)]
)
@pytest.mark.parametrize("world", WORLDS)
@pytest.mark.parametrize("name", CORRECT_LEARNERS)
def test_nothing_is_said_of_a_correct_learner(name: str, world: str) -> None:
    log = recorded(CORRECT_LEARNERS[name](), 1, steps=1200, **WORLDS[world])  # type: ignore[arg-type]
    log.environments.append(ProgramEnvironment(0, "Taxi-v3", None, (STATES,), ACTIONS, 12))
    log.numbers |= {"alpha": 0.1, "gamma": 0.9, "epsilon": 0.2}
    assert verdict_of(log).findings == ()


RISK = CodeFinding(
    CodeFault.FIRST_OF_TIES, "proven", 0, 900, 100, "900 of 1,000 choices.", "choose at random"
)


def graded(luck: float, dry: int, seeds: int, share: float = 0.01) -> GradedSubmission:
    suspected = [SuspectedRisk(RISK, luck)] * dry + [None] * (seeds - dry)
    runs = tuple(
        GradedRun(seed, share, share if each else 1.0, suspected=each) for seed, each in enumerate(suspected)
    )
    return GradedSubmission("mine.py", runs, 0.95)


def test_a_run_that_is_too_short_for_a_proof_leaves_a_suspicion() -> None:
    verdict = verdict_of(standing(50, often_the_first))
    assert verdict.findings == ()
    assert verdict.suspected is not None
    assert verdict.suspected.finding.fault is CodeFault.FIRST_OF_TIES
    assert 1e-4 < verdict.suspected.luck < 1.0
    assert verdict_of(standing(50, lambda number: number % 4)).suspected is None


@pytest.mark.parametrize(
    ("luck", "dry", "seeds", "is_told"),
    [
        (0.2, 20, 20, True),
        (0.2, 4, 20, False),  # as many are dry with random choices
        (0.2, 14, 20, True),
        (0.009, 2, 2, True),
        (0.02, 2, 2, False),
        (0.9, 20, 20, False),
        (1e-5, 1, 1, True),
        (0.0, 0, 20, False),
    ],
)
def test_the_luck_of_all_seeds_decides(luck: float, dry: int, seeds: int, is_told: bool) -> None:
    found = graded(luck, dry, seeds).findings
    assert [(each.fault, count) for each, count in found] == [(CodeFault.FIRST_OF_TIES, dry)] * is_told
    for each, _ in found:
        assert each.text == (
            f"{RISK.text} This happened in {dry} of {seeds} seeds. With random choices among equal "
            "values, the "
            "probability of that is below 0.0001."
        )


def test_what_did_not_make_it_fail_is_not_told() -> None:
    assert graded(0.2, 20, 20, share=1.0).findings == []
