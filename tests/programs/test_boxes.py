"""Environments whose observations have fractions."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from held_programs import held
from watched_scripts import LOOP, check_q_learning, script_in, watched

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.watched.child.boxes.sites import Sites
from rl_tui.programs.watched.child.script import read_script

pytestmark = pytest.mark.process

CART_POLE = """\
import random
from collections import defaultdict
from enum import Enum
import gymnasium as gym
import numpy as np
class Push(Enum):
    LEFT, RIGHT = 0, 1
env = gym.make("CartPole-v1")
def bins(seen):
    position, _, angle, speed = seen
    return int(position > 0), int(np.digitize(angle, [-0.1, -0.03, 0, 0.03, 0.1])), int(speed > 0)
{table}
for episode in range(300):
    s, done = bins(env.reset()[0]), False
    while not done:
        a = env.action_space.sample() if random.random() < 0.2 else int(np.argmax({row}))
        seen, r, dead, late, _ = env.step(a)
        s2, done, push = bins(seen), dead or late, Push(a)
        ahead = 0.0 if dead else max({row2})
        {put}
        s = s2
"""
MOUNTAIN_CAR = """\
import gymnasium as gym
import numpy as np
{agent}
env = gym.make("MountainCar-v0")
low, width = env.observation_space.low, (env.observation_space.high - env.observation_space.low) / 12
def bins(seen):
    return tuple(((seen - low) / width).astype(int))
agent = Agent()
for episode in range(30):
    s, done = bins(env.reset()[0]), False
    while not done:
        a = agent.act(s)
        seen, r, dead, late, _ = env.step(a)
        s2, done = bins(seen), dead or late
        if not done:
            agent.learn(s, a, r, s2)
        s = s2
"""
ARRAY = "Q = np.zeros((2, 6, 2, 2))"
AGENT = """\
import numpy as np
class Agent:
    def __init__(self):
        self.q_table = np.random.uniform(-2, 0, (12, 12, 3))
    def act(self, s):
        return int(np.argmax(self.q_table[s])) if np.random.random() < 0.8 else np.random.randint(3)
    def learn(self, s, a, r, s2):
        ahead = np.max(self.q_table[s2])
        self.q_table[s + (a,)] = 0.9 * self.q_table[s + (a,)] + 0.1 * (r + 0.95 * ahead)
"""


check_nearly = partial(check_q_learning, least=0.99)


def cart_pole(table: str, row: str, put: str) -> str:
    """Return a program in which `row` is the row of the state `$`."""
    return CART_POLE.format(table=table, row=row.replace("$", "s"), row2=row.replace("$", "s2"), put=put)


def learning(cell: str) -> str:
    return f"{cell} += 0.2 * (r + 0.99 * ahead - {cell})"


@pytest.mark.parametrize(
    ("table", "row", "cell", "form"),
    [
        (
            "Q = [[[[0.0] * 2 for _ in range(2)] for _ in range(6)] for _ in range(2)]",
            "Q[$[0]][$[1]][$[2]]",
            "Q[s[0]][s[1]][s[2]][a]",
            "lists",
        ),
        (ARRAY, "Q[$]", "Q[s][a]", "array"),
        (ARRAY, "Q[$]", "Q[s + (a,)]", "array"),
        (ARRAY, "Q[$]", "Q[s][push.value]", "array"),
        (ARRAY, "Q[$]", "Q[s[0], s[1], s[2], a]", "array"),
        ("Q = defaultdict(lambda: [0.0, 0.0])", "Q[str($)]", "Q[str(s)][a]", "dict-of-arrays"),
        ("Q = defaultdict(lambda: {0: 0.0, 1: 0.0})", "[Q[$][0], Q[$][1]]", "Q[s][a]", "dict-of-dicts"),
        ("Q = defaultdict(float)", "[Q[$, 0], Q[$, 1]]", "Q[(s, a)]", "dict-of-pairs"),
    ],
    ids=["nested lists", "row", "sum of tuples", "enum", "parts", "text", "dicts", "pairs"],
)
def test_the_state_is_the_index_of_the_table(
    table: str, row: str, cell: str, form: str, tmp_path: Path
) -> None:
    log = watched(script_in(tmp_path, cart_pole(table, row, learning(cell))), steps=1000)
    check_nearly(log, "Q", form, 0.2, 0.99)
    assert log.environments[0].id == "CartPole-v1"
    assert log.recording.count == 1000
    steps = log.recording.steps
    inside = ~(steps.terminated | steps.truncated)[:-1]
    assert (steps.next_state[:-1][inside] == steps.state[1:][inside]).all()


@pytest.mark.parametrize("is_imported", [False, True])
def test_an_agent_may_put_an_arrays_index(is_imported: bool, tmp_path: Path) -> None:
    if is_imported:
        script_in(tmp_path, AGENT, "agent.py")
    agent = "from agent import Agent" if is_imported else AGENT
    log = watched(script_in(tmp_path, MOUNTAIN_CAR.format(agent=agent)), steps=1500)
    check_nearly(log, "self.q_table", "array", 0.1, 0.95)


def test_a_row_may_have_another_name(tmp_path: Path) -> None:
    text = cart_pole(ARRAY, "Q[$]", "row = Q[s]; row[a] += 0.2 * (r + 0.99 * ahead - row[a])")
    check_nearly(watched(script_in(tmp_path, text), steps=2000), "Q", "array", 0.2, 0.99)


def test_a_value_after_the_end_is_found(tmp_path: Path) -> None:
    text = cart_pole(ARRAY, "Q[$]", learning("Q[s][a]"))
    log = watched(script_in(tmp_path, text.replace("0.0 if dead else ", "")), steps=1500)
    assert [each.fault for each in verdict_of(log).findings] == ["bootstraps-after-end"]


@pytest.mark.parametrize(
    "put",
    ["Q[bins(seen)][a] += 0.1", "row = Q[bins(seen)]; row[a] += 0.1"],
    ids=["computed inside", "a row by another name"],
)
def test_an_index_that_cannot_be_read_is_said(put: str, tmp_path: Path) -> None:
    log = watched(script_in(tmp_path, cart_pole(ARRAY, "Q[$]", put)))
    assert (log.error, log.table, log.recording.count) == (None, None, 0)
    assert log.notes == [
        "CartPole-v1: rl-tui reads the state from the index of your table, but your program has not written "
        "to a table with a readable index yet"
    ]


def test_a_table_may_be_written_late_and_then_only_read(tmp_path: Path) -> None:
    text = cart_pole(ARRAY, "Q[$]", f"if 400 < episode < 700: {learning('Q[s][a]')}").replace("300", "900")
    log = watched(script_in(tmp_path, text.replace("sample() if random.random() < 0.2", "sample() if True")))
    assert "your program has not written" in log.notes[0]
    check_nearly(log, "Q", "array", 0.2, 0.99)
    steps = log.recording.steps
    assert 200 < steps.episode.max() < 700
    assert (steps.episode_step == 0).sum() >= steps.episode.max()


def test_a_table_changed_by_steps_of_other_actions_is_not_used(tmp_path: Path) -> None:
    log = watched(script_in(tmp_path, cart_pole(ARRAY, "Q[$]", "Q[s][1 - a] += 0.1")))
    assert (log.error, log.table, log.recording.count) == (None, None, 0)
    assert "Q is not used, because each step changes actions that were not taken" in log.notes[-1]


def test_it_waits_and_stops_at_each_step(tmp_path: Path) -> None:
    text = cart_pole(ARRAY, "Q[$]", learning("Q[s][a]"))
    steps = watched(script_in(tmp_path, text, "whole.py"), steps=1000).recording.steps
    ends = np.flatnonzero(steps.terminated | steps.truncated) + 1
    with held(tmp_path, text) as program:
        for count in (0, 1, 2, int(ends[0]), int(ends[8]), int(ends[8]) + 1):
            recording = program.go_to(count).recording
            assert recording.count == count
            assert recording.steps.state.tolist() == steps.state[:count].tolist()
        assert program.stop_at(episode_ends=2).recording.count == ends[10]
        recording = program.stop_at(value=[int(steps.state[0]) * 2 + int(steps.action[0]), 3.0]).recording
        assert recording.changes.after[-1] >= 3.0


def test_the_last_steps_before_an_error_are_told(tmp_path: Path) -> None:
    text = cart_pole(ARRAY, "Q[$]", learning("Q[s][a]")).replace("range(300)", "range(40)") + "1 / 0\n"
    log = watched(script_in(tmp_path, text))
    assert log.error is not None
    steps = log.recording.steps
    assert (steps.episode[-1], steps.terminated[-1]) == (39, True)


def test_reading_an_index_calls_nothing_of_the_programs(tmp_path: Path) -> None:
    text = """
    import gymnasium as gym
    import numpy as np
    class Place:
        @property
        def state(self):
            raise RuntimeError("a property was read")
        def __add__(self, other):
            calls.append(1)
            return 0, 1
    calls, place, Q = [], Place(), np.zeros((2, 2))
    env = gym.make("CartPole-v1")
    for _ in range(50):
        env.reset()
        env.step(1)
        Q[place + 1] += 0.5
        try:
            Q[place.state, 1] += 0.5
        except RuntimeError:
            pass
    print(len(calls))
    """
    log = watched(script_in(tmp_path, text))
    assert (log.error, [line.text for line in log.output]) == (None, ["50"])


def test_a_table_that_a_user_named_is_taken(tmp_path: Path) -> None:
    text = cart_pole(f"{ARRAY}; old = Q.copy()", "Q[$]", learning("Q[s][a]"))
    path = script_in(tmp_path, text.replace("        s = s2", "        old[s][a] = 1.0\n        s = s2"))
    for wanted in (None, "old"):
        log = watched(path, steps=500, table=wanted)
        assert log.table is not None
        assert (log.table.name, log.table.others) == (wanted or "Q", () if wanted else ("old",))


def test_a_program_without_such_environments_is_compiled_as_it_is(tmp_path: Path) -> None:
    path = script_in(tmp_path, LOOP.format(episodes=1))
    script, finders = read_script(path), list(sys.meta_path)
    before = script.compiled()
    Sites().add_calls(script)
    assert script.compiled() == before
    assert sys.meta_path == finders


@pytest.mark.filterwarnings("error")
def test_a_warning_of_the_compiler_is_given_once(tmp_path: Path) -> None:
    script = read_script(script_in(tmp_path, "step = 3\nif step is 3:\n    pass\n"))
    with pytest.raises(SyntaxError, match="literal"):
        script.compiled()
