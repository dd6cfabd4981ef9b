"""Places in a source, found by reading it."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from rl_tui.programs.evidence.code_names import CodeNames, names_of
from rl_tui.programs.evidence.code_places import CodeLine, ProgramCode, program_code
from rl_tui.programs.evidence.verdict import Rule, UpdateFound, UpdateTarget
from rl_tui.programs.watched.program_log import FoundTable, ProgramLog

LOOP = """
import gymnasium as gym
import numpy as np

world = gym.make("FrozenLake-v1")
{table}
gamma = .9
for episode in range(9):
    s, _ = world.reset()
    over = False
    while not over:
        {choice}
        new_s, reward, ended, cut, info = world.step(a)
        {update}
        s, over = new_s, ended or cut
"""
TABLE = "Q = np.zeros((16, 4))"
CHOICE = "a = int(np.argmax(Q[s]))"
UPDATE = "Q[s, a] += .1 * (reward + gamma * Q[new_s].max() - Q[s, a])"


def code_of(
    folder: Path, source: str, name: str = "Q", *, form: str = "array", lines: bool = True
) -> tuple[ProgramCode, ProgramLog, list[str]]:
    path = folder / "program.py"
    path.write_text(source, encoding="utf-8")
    text = source.splitlines()
    log = ProgramLog(table=FoundTable(name, form, (16, 4), "float64"))
    at = next(place for place, line in enumerate(text, 1) if ".step(" in line and "world" in line)
    log.called["step"] = str(path), at
    if lines:
        log.lines[str(path), next(place for place, line in enumerate(text, 1) if "+=" in line)] = 40
    return program_code(log), log, text


def text_of(line: CodeLine | None, text: list[str]) -> str:
    return text[line.line - 1].strip()


def loop(table: str = TABLE, choice: str = CHOICE, update: str = UPDATE) -> str:
    return LOOP.format(table=table, choice=choice, update=update)


def test_of_a_plain_loop(tmp_path: Path) -> None:
    code, _, text = code_of(tmp_path, loop())
    assert text_of(code.update_line(), text) == UPDATE
    assert text_of(code.table_line(), text) == TABLE
    assert text_of(code.choice_line(), text) == CHOICE
    assert text_of(code.call_line(), text).startswith("new_s, reward")
    assert code.always_writes


def test_without_traced_lines_the_update_is_read(tmp_path: Path) -> None:
    code, _, text = code_of(tmp_path, loop(), lines=False)
    assert text_of(code.update_line(), text) == UPDATE


@pytest.mark.parametrize(
    "update",
    [
        "Q[s, a] == Q[s, a] + .1 * (reward - Q[s, a])",
        "q = Q.copy(); q[s, a] += reward",
        "value = Q[s, a]; value += reward",
        "Q[s][a] = .9 * Q[s][a] + .1 * reward",
    ],
)
def test_a_write_is_seen_also_where_it_goes_amiss(update: str, tmp_path: Path) -> None:
    code, _, _ = code_of(tmp_path, loop(update=update), lines=False)
    assert code.always_writes


@pytest.mark.parametrize("update", ["pass", "Q[s] = np.zeros(4)", "best = max(Q[s])", "counts[s, a] += 1"])
def test_what_is_no_update_is_none(update: str, tmp_path: Path) -> None:
    code, _, _ = code_of(tmp_path, loop(update=update), lines=False)
    assert not code.always_writes


@pytest.mark.parametrize(
    ("update", "always"),
    [
        ("if training: Q[s, a] += reward", False),
        ("if ended: Q[s, a] += reward\n        else: Q[s, a] += reward + max(Q[new_s])", True),
        ("for _ in range(2): Q[s, a] += reward", True),
        ("if training: learn(s, a, reward)", False),
        ("learn(s, a, reward)", True),
    ],
)
def test_an_update_under_a_condition_is_not_always_made(update: str, always: bool, tmp_path: Path) -> None:
    source = "def learn(s, a, r):\n    Q[s, a] += r\n" + loop(update=update)
    code, _, _ = code_of(tmp_path, source, lines=False)
    assert code.always_writes is always


def test_an_evaluation_beside_the_training_makes_no_updates(tmp_path: Path) -> None:
    evaluation = "def evaluate(world):\n    while True:\n        world.step(Q[0].argmax())\n"
    code, _, _ = code_of(tmp_path, evaluation + loop(), lines=False)
    assert not code.always_writes


@pytest.mark.parametrize(
    ("table", "update", "sets"),
    [
        (TABLE, UPDATE, False),
        ("Q = {}\nfor cell in cells: Q[cell] = 0.0", UPDATE, False),
        (TABLE, UPDATE + "\n        if ended: Q[s, a] = 0", True),
        (TABLE, UPDATE + "\n        if ended: Q[s, a] = -1.0", True),
    ],
)
def test_an_update_may_set_a_number(table: str, update: str, sets: bool, tmp_path: Path) -> None:
    code, _, _ = code_of(tmp_path, loop(table=table, update=update), lines=False)
    assert code.sets_a_constant is sets


def test_a_write_in_a_function_that_is_given_the_table(tmp_path: Path) -> None:
    source = "def learn(table, s, a, r):\n    table[s][a] += r\n" + loop(update="learn(Q, s, a, reward)")
    code, _, text = code_of(tmp_path, source)
    assert text_of(code.update_line(), text) == "table[s][a] += r"
    assert code.always_writes


def test_a_table_that_a_function_makes(tmp_path: Path) -> None:
    source = "def make():\n    t = [[0] * 4] * 16\n    return t\n" + loop(table="Q = make()")
    code, _, text = code_of(tmp_path, source)
    assert text_of(code.table_line(), text) == "t = [[0] * 4] * 16"


def test_an_action_that_a_function_chooses(tmp_path: Path) -> None:
    function = "def pick(s):\n    if s > 9:\n        return 0\n    return np.argmax(Q[s])\n"
    code, _, text = code_of(tmp_path, function + loop(choice="a = pick(s)"))
    assert text_of(code.choice_line(), text) == "return np.argmax(Q[s])"


def test_an_action_chosen_in_branches(tmp_path: Path) -> None:
    choice = "if np.random.rand() < .1:\n            a = 2\n        else:\n            a = Q[s].argmax()"
    code, _, text = code_of(tmp_path, loop(choice=choice))
    assert text_of(code.choice_line(), text) == "a = Q[s].argmax()"


@pytest.mark.parametrize(
    "source", ["def broken(:\n    world.step(a)\n    Q += 1", "world.step(a) \x00\nQ += 1"]
)
def test_a_source_that_cannot_be_read_tells_no_names(source: str, tmp_path: Path) -> None:
    code, log, _ = code_of(tmp_path, source)
    assert log.table is not None
    assert code.table_line() is None
    assert code.choice_line() is not None
    assert not code.always_writes
    assert names_of(code, log.table, UpdateFound(), {}) == CodeNames()


def test_the_choice_of_an_agent_without_a_loop(tmp_path: Path) -> None:
    agent = """
class Agent:
    def select_action(self, state):
        return self.Q[state].argmax()

    def step(self, state, action, reward, next_state, done):
        self.Q[state][action] += reward  # not world.step(
"""
    code, _, text = code_of(tmp_path, agent, "agent.Q")
    assert text_of(code.choice_line(), text) == "return self.Q[state].argmax()"


def test_lines_of_notebooks_do_no_harm(tmp_path: Path) -> None:
    code, _, text = code_of(tmp_path, "%matplotlib inline\n!pip install gymnasium\n" + loop())
    assert text_of(code.table_line(), text) == TABLE


def test_a_correction_speaks_in_the_names_of_the_program(tmp_path: Path) -> None:
    code, log, _ = code_of(tmp_path, loop())
    assert log.table is not None
    update = UpdateFound(Rule.Q_LEARNING, 0.1, "constant", 0.9, target=UpdateTarget.BEST)
    names = names_of(code, log.table, update, {"gamma": 0.9, "0.1": 0.1})
    assert names.target() == "target = reward if ended else reward + gamma * max(Q[new_s])"


def test_a_correction_speaks_in_the_names_of_an_agent(tmp_path: Path) -> None:
    agent = (
        "class Agent:\n    def update(self, obs, action, reward, terminated, next_obs):\n"
        "        self.q_values[obs][action] += 1.0\n"
    )
    code, log, _ = code_of(
        tmp_path, agent + loop(update="agent.update(s, a, reward, ended, new_s)"), "agent.q_values"
    )
    assert log.table is not None
    names = names_of(code, log.table, UpdateFound(), {})
    assert names.next_state == "next_obs"
    assert names.terminated == "terminated"
    assert names.state == "obs"


def test_code_is_examined_once_for_each_state_of_its_file(tmp_path: Path) -> None:
    code, log, _ = code_of(tmp_path, loop())
    log.numbers["gamma"] = 0.9
    log.lines[next(iter(log.lines))] += 1
    assert program_code(log) is code
    path = tmp_path / "program.py"
    path.write_text(loop(update="pass"), encoding="utf-8")
    saved = path.stat().st_mtime_ns + 10**9
    os.utime(path, ns=(saved, saved))
    assert program_code(log) is not code
    assert (code.always_writes, program_code(log).always_writes) == (True, False)
