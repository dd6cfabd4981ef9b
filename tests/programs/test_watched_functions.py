"""Functions step(state, action) as worlds."""

from __future__ import annotations

from pathlib import Path

import pytest
from watched_scripts import check_q_learning, lines_of, script_in, watched

pytestmark = pytest.mark.process

TREASURE = """\
import random
import numpy as np
from collections import defaultdict
ACTIONS = ["left", "right"]
def get_env_feedback(S, A):
    if A == "right":
        if S == 4:
            return "terminal", 1
        return S + 1, 0
    return max(0, S - 1), 0
q = defaultdict(lambda: dict.fromkeys(ACTIONS, 0.0))
for episode in range(100):
    S = 0
    while S != "terminal":
        A = random.choice(ACTIONS)
        S_, R = get_env_feedback(S, A)
        ahead = 0.0 if S_ == "terminal" else max(q[S_].values())
        q[S][A] += 0.1 * (R + 0.9 * ahead - q[S][A])
        S = S_
"""
GRID = """\
import random
import numpy as np
def step(state, action, size=4):
    row, column = state
    down, right = ((-1, 0), (1, 0), (0, -1), (0, 1))[action]
    after = min(size - 1, max(0, row + down)), min(size - 1, max(0, column + right))
    return after, -1.0, after == (0, 3)
Q = np.zeros((4, 4, 4))
for episode in range(200):
    state, done = (3, 0), False
    while not done:
        action = random.randrange(4)
        after, reward, done = step(state, action)
        Q[state][action] += 0.1 * (reward + 0.9 * Q[after].max() * (not done) - Q[state][action])
        state = after
"""


@pytest.mark.parametrize(
    ("text", "name", "table", "form"),
    [(TREASURE, "get_env_feedback", "q", "dict-of-dicts"), (GRID, "step", "Q", "array")],
)
def test_its_calls_are_steps(text: str, name: str, table: str, form: str, tmp_path: Path) -> None:
    log = watched(script_in(tmp_path, text), steps=4000)
    check_q_learning(log, table, form, 0.1, 0.9)
    assert log.environments[0].id == name
    steps = log.recording.steps
    assert (steps.episode_step == 0).sum() == steps.episode.max() + 1 > 20


@pytest.mark.parametrize(
    "function",
    [
        "def move(position, direction):\n    return position + direction",
        "def step(state, action):\n    return env.step(action)[:2]",
        "def step(state, action):\n    raise SystemExit",
        "def take_action(state, q):\n    return [0.5, 1]",
        "def step(env, action):\n    return 1, 2.0",
    ],
)
def test_another_function_is_not_a_world(function: str, tmp_path: Path) -> None:
    text = f"""
import gymnasium
env = gymnasium.make("FrozenLake-v1")
env.reset()
{function}
env.step(0)
result = {function.split("(")[0].removeprefix("def ")}(0, 1)
print(result)
"""
    log = watched(script_in(tmp_path, text))
    assert log.error is None
    assert [each.id for each in log.environments] == ["FrozenLake-v1"]
    assert log.recording.count == 1 + ("env.step" in function)
    assert len(lines_of(log)) == ("SystemExit" not in function)
