"""Missing and incomplete updates."""

from __future__ import annotations

from pathlib import Path

import pytest
from correct_learners import ALPHA, moved, q_learning
from made_recordings import Learner, Step, recorded

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.programs.diagnosis.diagnosis import MOVES_WITHOUT_GAMMA, notes_on, verdict_of
from rl_tui.programs.diagnosis.program_learner import found_of
from rl_tui.programs.evidence.code_places import program_code
from rl_tui.programs.evidence.evidence import Evidence
from rl_tui.programs.evidence.verdict import CodeFault, UpdateFound
from rl_tui.programs.watched.program_log import FoundTable, ProgramAgent, ProgramLog
from rl_tui.worlds.mdp.space import FloatArray

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
