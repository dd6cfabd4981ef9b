"""Updates of another cell than Q(s, a), and missing updates."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from correct_learners import ALPHA, CORRECT_LEARNERS, GAMMA, best, moved, q_learning
from made_recordings import ACTIONS, STATES, Learner, Step, recorded

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.programs.diagnosis.diagnosis import MOVES_WITHOUT_GAMMA, notes_on, verdict_of
from rl_tui.programs.diagnosis.faults.cells import proof_of_cell
from rl_tui.programs.diagnosis.program_learner import found_of
from rl_tui.programs.evidence.code_names import CodeNames
from rl_tui.programs.evidence.code_places import program_code
from rl_tui.programs.evidence.evidence import Evidence
from rl_tui.programs.evidence.verdict import CodeFault, UpdateFound
from rl_tui.programs.watched.program_log import FoundTable, ProgramAgent, ProgramLog
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


READS = {
    "nothing at all": ("pass", True),
    "the value of the next state": ("best = 0.0 if done else np.max(self.q[s_next])", True),
    "by another method": ("best = self.value(s_next)", True),
    "and counts": ("self.steps += 1", True),
    "and keeps what came last": ("self.last_s, self.last_a = s_next, a", True),
    "a cell is written": ("self.q[s][a] += r", False),
    "a row is written": ("row = self.q[s]\n        row[a] = r", False),
    "another method writes": ("self.learn(s, a, r)", False),
    "something unknown is called": ("self.memory.append((s, a, r))", False),
    "a new table takes its place": ("self.q = self.q + r", False),
    "numpy writes": ("np.put(self.q, a, r)", False),
    "an unknown function is called": ("best = fit(self.q, s, a, r)", False),
}


def nothing(table: FloatArray, step: Step) -> None:
    """Learns nothing."""


def without_next(table: FloatArray, step: Step) -> None:
    moved(table, step, step.reward)


def after_moving(table: FloatArray, step: Step) -> None:
    table[step.next_state, step.action] += ALPHA * step.reward


def agent(folder: Path, body: str) -> ProgramLog:
    file = folder / "mine.py"
    file.write_text(
        "import numpy as np\nclass Agent:\n    def value(self, s):\n        return max(self.q[s])\n"
        "    def learn(self, s, a, r):\n        self.q[s][a] = r\n"
        f"    def step(self, s, a, r, s_next, done):\n        {body}\n"
    )
    log = recorded(nothing, initial="zeros")
    log.agent = ProgramAgent("Agent", "udacity", done_is_either=True)
    log.table = FoundTable("agent.q", "lists", (6, 3), "float64")
    log.called["step"] = (str(file), 7)
    log.ended = False
    return log


@pytest.mark.parametrize("name", READS)
def test_an_update_is_missing_only_where_the_code_surely_writes_nothing(name: str, tmp_path: Path) -> None:
    body, is_missing = READS[name]
    log = agent(tmp_path, body)
    assert program_code(log).lacks_update == is_missing
    findings = verdict_of(log).findings
    assert [each.fault for each in findings] == [CodeFault.LOSES_UPDATE] * is_missing
    for each in findings:
        assert (each.line, "add the missing update" in each.correction) == (7, True)
        assert "agent." not in each.correction
        if "s_next" in body:
            assert "self.q[s_next]" in each.correction


def test_an_agent_that_learned_lacks_nothing(tmp_path: Path) -> None:
    log = recorded(q_learning, initial="zeros")
    log.agent, log.called = (
        ProgramAgent("f", "function", done_is_either=False),
        agent(tmp_path, "pass").called,
    )
    assert CodeFault.LOSES_UPDATE not in [each.fault for each in verdict_of(log).findings]


def test_the_line_that_leaves_the_loop_before_the_update_is_named(tmp_path: Path) -> None:
    file = tmp_path / "lake.py"
    file.write_text(
        "q = make()\nwhile True:\n    s2, r, term, trunc, _ = env.step(a)\n    if term or trunc:\n"
        "        break\n    q[s, a] += 0.1 * (r - q[s, a])\n"
    )
    log = recorded(nothing, initial="zeros")
    steps = log.recording.steps
    steps.reward[:] = steps.terminated
    log.table, log.called["step"] = FoundTable("q", "array", (6, 3), "float64"), (str(file), 3)
    [finding] = verdict_of(log).findings
    assert finding.correction.startswith("update before line 4, which leaves the loop")
    steps.reward[~steps.terminated] = 1.0  # now steps that reach the update have rewards too
    [finding] = verdict_of(log).findings
    assert "line 4" not in finding.correction


@pytest.mark.parametrize(("rewards", "by_column"), [((-1.0, -2.0), True), ((1.0, 2.0), False)])
def test_a_discount_that_moves_nothing_is_told(rewards: tuple[float, ...], by_column: bool) -> None:
    log = recorded(without_next, initial="zeros", rewards=rewards, steps=12)
    update, numbers = UpdateFound(gamma=0.0), {"agent.gamma": 0.95, "alpha": ALPHA}
    [note, *_] = notes_on(Evidence(log.recording, numbers), update)
    assert f"{MOVES_WITHOUT_GAMMA}, but `agent.gamma` in your code is 0.95" in note
    assert ("state. A maximum over states instead of actions, as in max(Q[:, a])" in note) == by_column
    for without in ({}, {"gamma": 0.0}):
        notes = notes_on(Evidence(log.recording, without), update)
        assert not any(MOVES_WITHOUT_GAMMA in each for each in notes)
    log = recorded(without_next, initial="zeros")
    log.numbers |= numbers
    verdict = verdict_of(log)
    assert verdict.update.gamma == 0.0
    assert any(MOVES_WITHOUT_GAMMA in each for each in verdict.notes)
    for update, gamma, source in (
        (verdict.update, 0.95, "declared"),
        (UpdateFound(gamma=0.5), 0.5, "found"),
        (UpdateFound(), 0.95, "declared"),
    ):
        found = found_of(update, numbers, Hyperparameters())
        assert (found.hyperparameters.gamma, found.gamma_source) == (gamma, source)


@pytest.mark.parametrize("learner", [after_moving, without_next])
def test_a_few_steps_that_move_the_next_state_are_a_note(learner: Learner) -> None:
    log = recorded(learner, initial="zeros", rewards=(1.0,), steps=2)
    verdict, steps = verdict_of(log), log.recording.steps
    assert verdict.findings == ()
    assert (
        "Too few numbers of the table have changed so far: 2 steps changed a number, after 2 rewards."
        in verdict.notes
    )
    told = [note for note in verdict.notes if "changed, not Q(s, a)" in note]
    assert len(told) == (learner is after_moving and bool((steps.state != steps.next_state).any()))
    assert (steps.state != steps.next_state).any()
