"""Updates of another cell than Q(s, a)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from correct_learners import ALPHA, CORRECT_LEARNERS, GAMMA, best
from made_recordings import ACTIONS, STATES, Learner, Step, recorded

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.diagnosis.faults.cells import proof_of_cell
from rl_tui.programs.evidence.code_names import CodeNames
from rl_tui.programs.evidence.evidence import Evidence
from rl_tui.programs.evidence.verdict import CodeFault
from rl_tui.programs.watched.program_log import FoundTable, ProgramLog
from rl_tui.worlds.mdp.space import FloatArray

Pair = tuple[int, int]
WORLDS = {
    "dense": {"initial": "random"},
    "costs": {"initial": "zeros", "rewards": (-1.0,)},
    "sparse": {"initial": "high", "rewards": (0.0,) * 9 + (1.0,)},
}
MIXED: dict[str, Callable[[FloatArray, Step, Pair], Pair]] = {
    "(s, a before)": lambda table, step, before: (step.state, before[1]),
    "(s before, a)": lambda table, step, before: (before[0], step.action),
    "(s, argmax Q(s))": lambda table, step, before: (step.state, int(table[step.state].argmax())),
    "(s′, argmax Q(s′))": lambda table, step, before: (step.next_state, int(table[step.next_state].argmax())),
}


def moving(cell: Callable[[FloatArray, Step, Pair], Pair]) -> Learner:
    """Return Q-learning of another ``cell``, found from the table, the step and the pair before."""
    before = [(0, 0)]

    def learn(table: FloatArray, step: Step) -> None:
        moved = cell(table, step, (step.state, step.action) if step.first else before[0])
        table[moved] += ALPHA * (step.reward + GAMMA * best(table, step) - table[moved])
        before[0] = step.state, step.action

    return learn


def swapped_sarsa(table: FloatArray, step: Step) -> None:
    future = 0.0 if step.terminated else GAMMA * table[step.state, step.action]
    cell = step.next_state, step.next_action
    table[cell] += ALPHA * (step.reward + future - table[cell])


def next_pair(table: FloatArray, step: Step) -> None:
    cell = step.next_state, step.next_action
    table[cell] += ALPHA * (step.reward + GAMMA * table[cell] - table[cell])


@pytest.mark.parametrize("world", WORLDS)
@pytest.mark.parametrize("place", MIXED)
def test_a_cell_of_two_steps_or_of_the_best_action_is_found(place: str, world: str) -> None:
    log = recorded(moving(MIXED[place]), 1, steps=600, **WORLDS[world])  # type: ignore[arg-type]
    (finding,) = verdict_of(log).findings
    assert (finding.fault, finding.steps_against) == (CodeFault.WRONG_CELL, 0)
    assert f"which is Q{place}. It should be" in finding.text


@pytest.mark.parametrize("name", CORRECT_LEARNERS)
def test_a_correct_learner_moves_cells_that_were_taken(name: str) -> None:
    for seed in range(2):
        for greedy in (0.0, 0.9, 1.0):
            log = recorded(CORRECT_LEARNERS[name](), seed, steps=150, initial="zeros", greedy=greedy)
            assert proof_of_cell(Evidence(log.recording), CodeNames()) is None


@pytest.mark.parametrize("greedy", [0.0, 0.97, 1.0])
def test_a_table_with_other_numbers_of_states_and_actions_is_no_fault(greedy: float) -> None:
    def learn(table: FloatArray, step: Step) -> None:
        cell = (step.state + 1) % STATES, (step.action + 1) % ACTIONS
        table[cell] += ALPHA * (step.reward - table[cell])

    for seed in range(10):
        for initial in ("zeros", "random"):
            log = recorded(learn, seed, steps=400, initial=initial, greedy=greedy)
            assert verdict_of(log).findings == ()


@pytest.mark.parametrize("world", WORLDS)
def test_swapped_pairs_are_corrected_by_what_is_in_the_target(world: str) -> None:
    (swapped,) = verdict_of(recorded(swapped_sarsa, **WORLDS[world])).findings  # type: ignore[arg-type]
    assert "The target has Q(s, a), not Q(s′, a′)." in swapped.text
    assert swapped.correction.startswith(
        "swap s and s2: target = r if terminated else r + gamma * Q[s2, next"
    )
    (other,) = verdict_of(recorded(next_pair, **WORLDS[world])).findings  # type: ignore[arg-type]
    assert other.correction.startswith("update Q[s, a] while s is the state before the step and a the")


def test_a_program_that_plans_may_move_any_cell() -> None:
    evidence = Evidence(recorded(next_pair).recording)
    assert proof_of_cell(evidence, CodeNames()) is not None
    assert proof_of_cell(evidence, CodeNames(), plans=True) is None


SKIPS = {
    "if not done:": True,
    "if not (term or trunc):": True,
    "if done:\n        pass\n    else:": True,
    "if not term and learning:": False,
    "if learning:": False,
    "if is_over(term):": False,
    "if n < 9:": False,
}


@pytest.mark.parametrize("at_ends", [True, False])
@pytest.mark.parametrize("test", SKIPS)
def test_a_table_that_skips_its_ends_never_moves(test: str, at_ends: bool, tmp_path: Path) -> None:
    log = never_moved(tmp_path, test, at_ends=at_ends)
    is_proved = SKIPS[test] and at_ends
    assert [each.fault for each in verdict_of(log).findings] == [CodeFault.LOSES_UPDATE] * is_proved
    for each in verdict_of(log).findings:
        assert each.correction.startswith("also update after the last step of an episode, where all rewards")
    log.ended = False
    assert verdict_of(log).findings == ()


def never_moved(folder: Path, test: str, *, at_ends: bool) -> ProgramLog:
    file = folder / "lake.py"
    file.write_text(
        "q = make()\nwhile True:\n    s2, r, term, trunc, _ = env.step(a)\n    done = term or trunc\n"
        f"    {test}\n        q[s, a] += 0.1 * (r - q[s, a])\n"
    )
    log = recorded(lambda table, step: None, initial="zeros")
    steps = log.recording.steps
    steps.reward[:] = steps.terminated if at_ends else ~steps.terminated
    log.table, log.called["step"] = FoundTable("q", "array", (6, 3), "float64"), (str(file), 3)
    return log
