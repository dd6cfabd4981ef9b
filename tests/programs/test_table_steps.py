"""Worlds in functions, and worlds known only by the table."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from held_programs import held
from watched_scripts import check_q_learning, lines_of, script_in, watched

from rl_tui.programs.diagnosis.diagnosis import verdict_of

pytestmark = pytest.mark.process

CORRIDOR = """\
import random
import numpy as np
Q = np.zeros((6, 2))
for episode in range(400):
    place = 2
    while 0 < place < 5:
        a = random.randrange(2)
        ahead = place + (1 if a else -1)
        bonus = 7.0
        r = {1: 0.0, 5: 2.0}.get(ahead, -0.25)
        {update}
        place = ahead
"""
LEARNER = """\
import random
class Learner:
    def __init__(self):
        self.size, self.values = 4, {}
        for x in range(4):
            for y in range(4):
                self.values[x, y] = {"N": 0.0, "S": 0.0, "W": 0.0, "E": 0.0}
    def go(self, action):
        dx, dy = {"N": (0, -1), "S": (0, 1), "W": (-1, 0), "E": (1, 0)}[action]
        x, y = self.at
        self.at = min(3, max(0, x + dx)), min(3, max(0, y + dy))
    def play(self):
        self.at = 0, 0
        while self.at != (3, 2):
            before = self.at
            row = self.values[before]
            action = random.choice("NSWE") if random.random() < 0.3 else max(row, key=row.get)
            self.go(action)
            step_reward = 5 if self.at == (3, 2) else -1
            target = step_reward + 0.8 * max(self.values[self.at].values())
            {update}
learner = Learner()
for _ in range(300):
    learner.play()
"""


@pytest.mark.parametrize(
    "update",
    [
        "Q[place, a] += 0.2 * (r + 0.9 * np.max(Q[ahead, :]) - Q[place, a])",
        "Q[place][a] = 0.8 * Q[place][a] + 0.2 * (r + 0.9 * max(Q[ahead]))",
        "row = Q[place]; row[a] += 0.2 * (r + 0.9 * Q[ahead].max() - row[a])",
        "error = r + 0.9 * Q[ahead].max() - Q[place, a]; Q[place, a] += 0.2 * error",
        "Q[place, a] += 0.2 * (pay(ahead) + 0.9 * np.max(Q[ahead]) - Q[place, a])",
        "aim = 0.9 * max(Q[ahead]) + pay(ahead); Q[place, a] += 0.2 * (aim - Q[place, a])",
    ],
)
def test_a_world_inside_of_the_loop_is_known_by_the_table(update: str, tmp_path: Path) -> None:
    text = CORRIDOR.replace("{update}", update)
    if "pay(" in update:  # no variable has the reward
        text = text.replace("bonus = 7.0", "pay = {1: 0.0, 5: 2.0}.get")
        text = text.replace("r = {1: 0.0, 5: 2.0}.get(ahead, -0.25)", "").replace(
            "pay(ahead)", "pay(ahead, -0.25)"
        )
    log = watched(script_in(tmp_path, text), steps=1000)
    check_q_learning(log, "Q", "array", 0.2, 0.9)
    steps = log.recording.steps
    begins = steps.episode_step == 0
    assert log.recording.count == 1000
    assert (steps.state[begins] == 2).all()
    assert (steps.next_state[:-1][~begins[1:]] == steps.state[1:][~begins[1:]]).all()
    assert set(steps.reward) == {0.0, 2.0, -0.25}


def test_steps_of_a_table_are_permitted_one_by_one(tmp_path: Path) -> None:
    text = CORRIDOR.replace("{update}", "Q[place, a] += 0.2 * (r + 0.9 * max(Q[ahead]) - Q[place, a])")
    steps = watched(script_in(tmp_path, text, "whole.py"), steps=600).recording.steps
    begins = np.flatnonzero(steps.episode_step == 0)
    with held(tmp_path, text) as program:
        for count in (0, 1, 2, int(begins[9]), 300):
            recording = program.go_to(count).recording
            assert recording.count == count
            assert recording.steps.state.tolist() == steps.state[:count].tolist()
        after = begins[begins > 300]
        assert program.stop_at(episode_ends=2).recording.count == after[1]


@pytest.mark.parametrize("cell", ["self.values[before][action]", "row[action]"])
def test_a_world_that_is_the_learner_is_known_by_its_table(cell: str, tmp_path: Path) -> None:
    text = LEARNER.replace("{update}", f"{cell} += 0.5 * (target - {cell})")
    log = watched(script_in(tmp_path, text), steps=1500)
    check_q_learning(log, "self.values", "dict-of-dicts", 0.5, 0.8)


@pytest.mark.parametrize(
    ("rows", "form"),
    [
        ("[[dict.fromkeys('NSWE', 0.0) for y in range(4)] for x in range(4)]", "array-of-dicts"),
        ("np.array([[dict.fromkeys('NSWE', 0.0) for y in range(4)] for x in range(4)])", "array-of-dicts"),
        ("{At(x, y): dict.fromkeys('NSWE', 0.0) for x in range(4) for y in range(4)}", "dict-of-dicts"),
    ],
)
def test_rows_are_dicts_at_places_or_by_named_tuples(rows: str, form: str, tmp_path: Path) -> None:
    text = f"""\
import random
from collections import namedtuple
import numpy as np
At = namedtuple("At", "x y")
Q = {rows}
"""
    step = "Q[s][a] += 0.5 * (reward + 0.8 * max(Q[s2].values()) - Q[s][a])"
    text += f"""\
for _ in range(300):
    s = At(0, 0)
    while s != (3, 2):
        a = random.choice("NSWE")
        dx, dy = {{"N": (0, -1), "S": (0, 1), "W": (-1, 0), "E": (1, 0)}}[a]
        s2 = At(min(3, max(0, s.x + dx)), min(3, max(0, s.y + dy)))
        (x, y), (x2, y2) = s, s2
        reward = 5 if s2 == (3, 2) else -1
        {step if form[0] == "d" else step.replace("[s]", "[x][y]").replace("[s2]", "[x2][y2]")}
        s = s2
"""
    check_q_learning(watched(script_in(tmp_path, text), steps=1500), "Q", form, 0.5, 0.8)


CALLING = """\
import random
import numpy as np
class Learner:
    def __init__(self):
        self.q = np.zeros((6, 2))
    def pay(self, state, action):
        return 1.0 if state == 5 else -0.1
    def getQ(self, state, action):
        return self.q[state, action]
    def target(self, state):
        return self.pay(state, 0) + 0.9 * max(self.q[state])
    def learn(self):
        for episode in range(300):
            s = 0
            while s < 5:
                a = random.randrange(2) if random.random() < 0.8 else int(np.argmax(self.q[s]))
                n = max(0, s + (1 if a else -1))
                {update}
                s = n
Learner().learn()
"""


@pytest.mark.parametrize(
    "update",
    [
        "self.q[s, a] += 0.2 * (self.pay(n, a) + 0.9 * max(self.q[n]) - self.q[s, a])",
        "self.q[s, a] = self.getQ(s, a) + 0.2 * (self.pay(n, a) + 0.9 * max(self.q[n]) - self.getQ(s, a))",
        "b = self.q[n].argmax(); self.q[s, a] += .2 * (self.pay(n, 0) + .9 * self.getQ(n, b) - self.q[s, a])",
        "row = self.q[n]; self.q[s, a] += 0.2 * (self.pay(n, a) + 0.9 * max(row) - self.q[s, a])",
        "best = max(self.q[n]); self.q[s, a] = 0.8 * self.q[s, a] + 0.2 * (self.pay(n, a) + 0.9 * best)",
    ],
)
def test_a_method_that_returns_the_reward_is_read(update: str, tmp_path: Path) -> None:
    log = watched(script_in(tmp_path, CALLING.replace("{update}", update)), steps=1500)
    check_q_learning(log, "self.q", "array", 0.2, 0.9)
    assert set(log.recording.steps.reward) == {1.0, -0.1}


@pytest.mark.parametrize(
    "update",
    [
        "self.q[s, a] += 0.2 * (self.target(n) - self.q[s, a])",
        "self.q[s, a] += 0.2 * (self.target(n) - self.getQ(s, a))",
        "self.q[s][a] = self.q[s, a] + 0.2 * (self.target(n) - self.q[s, a])",
        "self.q[s, a] = 0.8 * self.getQ(s, a) + 0.2 * self.target(n)",
        "aim = self.target(n); self.q[s, a] += 0.2 * (aim - self.q[s, a])",
        "self.q[s, a] += 0.2 * (self.pay(n, a) + 0.1 + 0.9 * max(self.q[n]) - self.q[s, a])",
    ],
)
def test_a_call_that_may_return_more_than_the_reward_is_not_read(update: str, tmp_path: Path) -> None:
    text = CALLING.replace("{update}", "best = self.q[n]; " + update)
    assert watched(script_in(tmp_path, text)).recording.count == 0


def test_an_update_without_a_reward_is_watched_but_unknown(tmp_path: Path) -> None:
    text = CORRIDOR.replace("{update}", "Q[place, a] = 0.9 * Q[place, a] + 0.1 * max(Q[ahead])")
    log = watched(script_in(tmp_path, text.replace("        bonus = 7.0\n", "").replace("zeros", "ones")))
    verdict = verdict_of(log)
    assert (log.error, verdict.findings, verdict.update.rule) == (None, (), "unknown")
    assert log.recording.count > 500


def test_the_table_of_another_agent_is_not_followed(tmp_path: Path) -> None:
    text = LEARNER.replace("{update}", "row[action] += 0.5 * (target - row[action])")
    text = text.replace("learner.play()", "learner.play(); other.play()").replace(
        "learner = Learner()", "learner, other = Learner(), Learner()"
    )
    log = watched(script_in(tmp_path, text), steps=1500)
    check_q_learning(log, "self.values", "dict-of-dicts", 0.5, 0.8)


def test_a_row_of_another_state_is_not_read(tmp_path: Path) -> None:
    update = "row = Q[place]; place = ahead; row[a] += 0.2 * (r + max(Q[place]) - row[a])"
    text = CORRIDOR.replace("{update}", update).replace("        place = ahead\n", "")
    assert watched(script_in(tmp_path, text), steps=500).recording.count == 0


@pytest.mark.parametrize(
    "update",
    [
        "gain = r; del r; Q[place, a] += 0.2 * (gain + 0.9 * Q[ahead].max() - Q[place, a])",
        "z, b = random.randrange(1, 5), random.randrange(2); Q[z, b] += 0.2 * (r + max(Q[ahead]) - Q[z, b])",
        "x, y, u, v = place, 0, ahead, 0; Q[x][y] += 0.2 * (r + Q[u][v] - Q[x][y])",
    ],
    ids=["no reward", "states drawn", "a table of grid cells"],
)
def test_assignments_that_show_no_steps_are_not_reported(update: str, tmp_path: Path) -> None:
    text = CORRIDOR.replace("{update}", update).replace("range(400)", "range(100)")
    log = watched(script_in(tmp_path, text))
    assert (log.error, log.recording.count, log.table) == (None, 0, None)


def test_a_world_that_reports_its_steps_comes_first(tmp_path: Path) -> None:
    world = """\
class World:
    def reset(self):
        self.place = 2
        return self.place
    def step(self, a):
        self.place += 1 if a else -1
        return self.place, -0.25, self.place in (0, 5)
world = World()
"""
    text = CORRIDOR.replace("    place = 2", "    place = world.reset()")
    text = text.replace("ahead = place + (1 if a else -1)", "ahead, r, done = world.step(a)")
    update = "Q[place, a] += 0.2 * (r + 0.9 * Q[ahead].max() - Q[place, a])"
    text = world + text.replace("        r = {1: 0.0, 5: 2.0}.get(ahead, -0.25)\n", "")
    log = watched(script_in(tmp_path, text.replace("{update}", update)), steps=500)
    assert [each.id for each in log.environments] == ["World"]
    assert log.recording.count == 500


NAMED = """\
import random
from collections import defaultdict
import numpy as np
class World:
    def reset(self):
        self.place = 0
        return {state}
    def step(self, action):
        self.place = max(0, self.place + (1 if action in ("right", 1) else -1))
        return {state}, -1, self.place == 4
world, names = World(), ["right", "left"]
Q = defaultdict(lambda: np.zeros(2))
for episode in range(300):
    world.reset()
    done = False
    while not done:
        s, a = world.place, random.randrange(2)
        _, reward, done = world.step({action})
        Q[s][a] += 0.3 * (reward + 0.7 * Q[world.place].max() - Q[s][a])
"""


@pytest.mark.parametrize(
    ("state", "action"),
    [("self.place", "names[a]"), ("(self.place, 7)", "a"), ("self.place / 2", "a"), ("[0] * 50", "a")],
    ids=["named actions", "rows of other states", "fractions", "large observations"],
)
def test_the_table_takes_over_where_a_world_does_not_show_its_rows(
    state: str, action: str, tmp_path: Path
) -> None:
    log = watched(
        script_in(tmp_path, NAMED.replace("{state}", state).replace("{action}", action)), steps=1500
    )
    check_q_learning(log, "Q", "dict-of-arrays", 0.3, 0.7)
    assert log.environments[0].id == "world of Q"


def test_a_first_result_that_is_a_flag_is_not_a_state(tmp_path: Path) -> None:
    text = NAMED.replace("return {state}, -1, self.place == 4", "return self.place == 4, -1, 0")
    text = text.replace("{state}", "self.place").replace("_, reward, done =", "done, reward, _ =")
    log = watched(script_in(tmp_path, text.replace("{action}", "a")), steps=1500)
    check_q_learning(log, "Q", "dict-of-arrays", 0.3, 0.7)


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
