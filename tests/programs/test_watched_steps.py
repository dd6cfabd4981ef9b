"""Each step and change is reported exactly."""

from __future__ import annotations

import pickle
from collections.abc import Mapping
from pathlib import Path
from textwrap import dedent, indent

import numpy as np
import pytest
from watched_scripts import script_in, watched

from rl_tui.programs.watched.program_log import ProgramLog

pytestmark = pytest.mark.process

_ENVIRONMENT = """
import pickle, sys
import numpy as np, gymnasium as gym
from gymnasium import spaces

class Shifted(gym.Env):
    "A random walk whose states count from 5 and actions from 2."
    observation_space = spaces.Discrete(4, start=5)
    action_space = spaces.Discrete(2, start=2)
    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.s = int(self.np_random.integers(5, 9))
        return self.s, {}
    def step(self, action):
        self.s = min(8, max(5, self.s + (1 if action == 3 else -1)))
        return self.s, float(self.s == 8), self.s == 8, False, {}

gym.register("Shifted-v0", entry_point=Shifted, max_episode_steps=20)
"""

_SCRIPT = """
log = []
{setup}
done = True
for t in range({steps}):
    if done:
        s, _ = env.reset()
    a = env.action_space.sample()
    log.append(["table", np.array({flat}, float)])
    s2, r, te, tr, _ = env.step(a)
    log.append(["step", {number_s}, int(a) - {first}, float(r), {number_s2}, bool(te), bool(tr)])
    best = max({get_s2})
{update}
    s, done = s2, te or tr
log.append(["table", np.array({flat}, float)])
open(sys.argv[1], "wb").write(pickle.dumps(log))
"""
_ROWS = "[[float(x) for x in row] for row in {}]"
_LAKE = "env = gym.make('FrozenLake-v1')\n"
_TAXI = "env = gym.make('Taxi-v4')\n"
_SHIFTED = "env = gym.make('Shifted-v0')\n"


def _case(
    setup: str, cell: str = "q[s, a]", flat: str = "q.tolist()", row: str = "q[s2]", update: str = "{}"
) -> tuple[str, str, str, str]:
    """Return the set-up, the flat table, the row of s2, and ``update`` with the step of ``cell`` in it."""
    shift = " - .01" if setup.startswith((_LAKE, _SHIFTED)) else ""
    return setup, flat, row, update.format(f"{cell} += .1 * (r{shift} + .9 * best - {cell})")


_LISTS, _ARRAYS = "[list(row) for row in q]", _ROWS.format("q.values()")
_CASES: Mapping[str, tuple[str, str, str, str]] = {
    "array": _case(_LAKE + "q = np.zeros((16, 4))"),
    "float32": _case(_LAKE + "q = np.zeros((16, 4), np.float32)"),
    "fortran": _case(_LAKE + "q = np.zeros((16, 4), order='F')"),
    "objects": _case(_LAKE + "q = np.zeros((16, 4), object)", flat=_ROWS.format("q")),
    "integers": _case(
        _LAKE + "q = np.zeros((16, 4), int)", update="q[s, a] += int(3 * (r + 1 + best - q[s, a]))"
    ),
    "bound anew": _case(_LAKE + "q = np.zeros((16, 4))", update="q = q.copy(); {}"),
    "reset now and then": _case(
        _LAKE + "q = np.zeros((16, 4))", update="{}\nif t % 50 == 49: q = np.zeros((16, 4))"
    ),
    "lists": _case(_LAKE + "q = [[0.0] * 4 for _ in range(16)]", "q[s][a]", _LISTS),
    "lists bound anew": _case(
        _LAKE + "q = [[0.0] * 4 for _ in range(16)]",
        "q[s][a]",
        _LISTS,
        update="q = [list(row) for row in q]; {}",
    ),
    "dict of arrays": _case(_LAKE + "q = {i: np.zeros(4) for i in range(16)}", "q[s][a]", _ARRAYS),
    "dict of lists": _case(_LAKE + "q = {i: [0.0] * 4 for i in range(16)}", "q[s][a]", _ARRAYS),
    "dict of pairs": _case(
        _LAKE + "q = {(i, b): 0.0 for i in range(16) for b in range(4)}",
        flat="[[q[i, b] for b in range(4)] for i in range(16)]",
        row="q[s2, b] for b in range(4)",
    ),
    "dict of lists and a number": _case(
        _LAKE + "q = {i: [0.0] * 4 for i in range(15)}; q[15] = 0.0",
        *("q[s][a]", "[q[i] if i < 15 else [np.nan] * 4 for i in q]", "q[s2] if s2 < 15 else [0.0]"),
    ),
    "dict of pairs and an array": _case(
        _LAKE + "q = {(i, b): 0.0 for i in range(16) for b in range(4)}; q['seen'] = np.zeros(16)",
        flat="[[q[i, b] for b in range(4)] for i in range(16)]",
        row="q[s2, b] for b in range(4)",
    ),
    "lists of tuples": _case(
        _LAKE + "q = [(0.0,) * 4 for _ in range(16)]",
        *("row[a]", _LISTS),
        update="row = list(q[s]); {}; q[s] = tuple(row)",
    ),
    "lists of arrays of one number": _case(
        _LAKE + "q = [[np.zeros(1) for b in range(4)] for _ in range(16)]",
        *("x", "[[x.item() for x in row] for row in q]"),
        update="x = q[s][a].copy(); {}; q[s][a] = x",
    ),
    "large array": _case(_TAXI + "q = np.zeros((500, 6))"),
    "large lists": _case(_TAXI + "q = [[0.0] * 6 for _ in range(500)]", "q[s][a]", _LISTS),
    "large dict of arrays": _case(_TAXI + "q = {i: np.zeros(6) for i in range(500)}", "q[s][a]", _ARRAYS),
    "large dict of pairs": _case(
        _TAXI + "q = {(i, b): 0.0 for i in range(500) for b in range(6)}",
        flat="[[q[i, b] for b in range(6)] for i in range(500)]",
        row="q[s2, b] for b in range(6)",
    ),
    "an attribute": _case(
        _LAKE + "class Agent: pass\nagent = Agent(); agent.q = np.zeros((16, 4))",
        *("agent.q[s, a]", "agent.q.tolist()", "agent.q[s2]"),
    ),
    "another agent": _case(
        _LAKE + "class Agent:\n    def __init__(self): self.q = np.zeros((16, 4))\nagent = Agent()",
        *("agent.q[s, a]", "agent.q.tolist()", "agent.q[s2]"),
        update="{}\nif t % 50 == 49: agent = Agent()",
    ),
    "several cells": _case(
        _LAKE + "q = np.zeros((16, 4)); e = np.zeros((16, 4))",
        update="e *= .8; e[s, a] += 1; q += .1 * (r - .01 + .9 * best - q[s, a]) * e",
    ),
    "several cells of lists": _case(
        _TAXI + "q = [[0.0] * 6 for _ in range(500)]; past = [(0, 0)] * 5",
        *("q[x][y]", _LISTS),
        update="past = past[1:] + [(s, a)]\nfor x, y in past: {}",
    ),
    "start": _case(_SHIFTED + "q = np.zeros((4, 2))", "q[s - 5, a - 2]", row="q[s2 - 5]"),
    "start, dict": _case(
        _SHIFTED + "q = {i: {} and 0 or [0.0, 0.0] for i in range(5, 9)}", "q[s][a - 2]", _ARRAYS
    ),
    "start, pairs": _case(
        _SHIFTED + "q = {(i, b): 0.0 for i in range(5, 9) for b in (2, 3)}",
        flat="[[q[i, b] for b in (2, 3)] for i in range(5, 9)]",
        row="q[s2, b] for b in (2, 3)",
    ),
    "blackjack": _case(
        "env = gym.make('Blackjack-v1')\nq = np.zeros((32, 11, 2, 2))", "q[s][a]", "q.reshape(-1, 2).tolist()"
    ),
    "blackjack, lists in order": _case(
        "env = gym.make('Blackjack-v1'); at = lambda s: (s[0] * 11 + s[1]) * 2 + s[2]\n"
        "q = [[0.0, 0.0] for _ in range(704)]",
        *("q[at(s)][a]", _LISTS, "q[at(s2)]"),
    ),
    "blackjack, objects in order": _case(
        "env = gym.make('Blackjack-v1'); at = lambda s: (s[0] * 11 + s[1]) * 2 + s[2]\n"
        "q = np.zeros((704, 2), object)",
        *("q[at(s), a]", _ROWS.format("q"), "q[at(s2)]"),
    ),
}


def _script(name: str, steps: int = 700) -> str:
    setup, flat, row, update = _CASES[name]
    number = "int({0})"
    first = "0"
    if "Blackjack" in setup:
        number = "int(({0}[0] * 11 + {0}[1]) * 2 + {0}[2])"
    elif "Shifted" in setup:
        number, first = "int({0}) - 5", "2"
    text = _SCRIPT.format(
        setup=setup,
        steps=steps,
        flat=flat,
        get_s2=row,
        update=indent(update, "    "),
        first=first,
        number_s=number.format("s"),
        number_s2=number.format("s2"),
    )
    return _ENVIRONMENT + text


@pytest.mark.exhaustive(
    "follows every kind of table",
    but=[
        *("array", "blackjack", "bound anew", "dict of lists", "dict of pairs", "lists"),
        *("objects", "reset now and then", "several cells"),
    ],
)
@pytest.mark.parametrize("name", list(_CASES))
def test_every_step_and_every_change_is_told_at_its_step(tmp_path: Path, name: str) -> None:
    log = watched(script_in(tmp_path, _script(name)), str(tmp_path / "log"))

    assert log.error is None
    _assert_as_written(log, _written(tmp_path))


@pytest.mark.parametrize("name", ["array", "lists", "dict of arrays", "dict of pairs"])
def test_a_table_of_a_function_is_followed_through_its_calls(tmp_path: Path, name: str) -> None:
    setup, flat, row, update = _CASES[name]
    body = _SCRIPT.format(
        setup=setup,
        steps=150,
        flat=flat,
        get_s2=row,
        update=indent(update, "    "),
        first="0",
        number_s="int(s)",
        number_s2="int(s2)",
    )
    body = body.replace("log = []\n", "").replace(
        'open(sys.argv[1], "wb").write(pickle.dumps(log))', "del log[-1]"
    )
    text = _ENVIRONMENT + "log = []\ndef learn(log):\n" + indent(body, "    ")
    text += "for _ in range(3): learn(log)\nopen(sys.argv[1], 'wb').write(pickle.dumps(log))\n"

    log = watched(script_in(tmp_path, text), str(tmp_path / "log"))

    assert log.error is None
    assert len(log.recording.rebound) == 2
    _assert_as_written(log, _written(tmp_path))


def test_two_environments_share_a_table(tmp_path: Path) -> None:
    text = _ENVIRONMENT + dedent(
        """
        env, other = gym.make("FrozenLake-v1"), gym.make("FrozenLake-v1", is_slippery=False)
        q, log = np.zeros((16, 4)), []
        for episode in range(60):
            here = other if episode % 3 == 2 else env
            s, _ = here.reset()
            done = False
            while not done:
                a = here.action_space.sample()
                log.append(["table", q.copy()])
                s2, r, te, tr, _ = here.step(a)
                log.append(["step", int(s), int(a), float(r), int(s2), te, tr])
                if here is env:
                    q[s, a] += .1 * (r - .01 + .9 * q[s2].max() - q[s, a])
                s, done = s2, te or tr
        open(sys.argv[1], "wb").write(pickle.dumps(log))
        """
    )

    log = watched(script_in(tmp_path, text), str(tmp_path / "log"))

    _assert_as_written(log, _written(tmp_path))
    steps = log.recording.steps
    assert [each.number for each in log.environments] == [0, 1]
    np.testing.assert_array_equal(steps.environment, steps.episode % 3 == 2)


@pytest.mark.parametrize(
    ("table", "flat"),
    [
        ("{i: [0.0] * 4 for i in range(48)}", "[*q.values()]"),
        ("{i: np.zeros(4) for i in range(48)}", "[row.tolist() for row in q.values()]"),
        ("[[0.0] * 4 for _ in range(48)]", "q"),
    ],
)
def test_what_changes_at_the_end_of_an_episode_belongs_to_its_last_step(
    tmp_path: Path, table: str, flat: str
) -> None:
    text = f"""
        import copy, pickle, sys, numpy as np, gymnasium as gym
        env = gym.make("CliffWalking-v1")
        q, tables = {table}, []
        for episode in range(260):  # short ones, after which nobody would look for long ones
            s, _ = env.reset()
            past = []
            for _ in range(2 if episode < 230 else 12):
                a = env.action_space.sample()
                tables.append(copy.deepcopy({flat}))
                past.append((s, a))
                s, r, *_ = env.step(a)
            for s, a in past:
                q[s][a] += .1 * (-len(past) - q[s][a])
        tables.append({flat})
        open(sys.argv[1], "wb").write(pickle.dumps([["table", np.array(each)] for each in tables]))
        """

    log = watched(script_in(tmp_path, text), str(tmp_path / "log"))

    assert log.error is None
    _assert_tables_as_written(log, _written(tmp_path))


def _written(folder: Path) -> list[list[object]]:
    written: list[list[object]] = pickle.loads((folder / "log").read_bytes())
    return written


def _assert_as_written(log: ProgramLog, written: list[list[object]]) -> None:
    steps = log.recording.steps
    own = [each[1:] for each in written if each[0] == "step"]
    told = zip(
        steps.state,
        steps.action,
        steps.reward,
        steps.next_state,
        steps.terminated,
        steps.truncated,
        strict=True,
    )
    assert [list(each) for each in told] == own
    _assert_tables_as_written(log, written)


def _assert_tables_as_written(log: ProgramLog, written: list[list[object]]) -> None:
    tables = [np.ravel(each[1]) for each in written if each[0] == "table"]
    assert log.recording.found_at == 0
    for step, table in enumerate(tables):
        np.testing.assert_array_equal(log.recording.table_at(step), table, err_msg=f"before step {step}")
