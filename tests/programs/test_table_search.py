"""The variable chosen as a program's table."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from watched_scripts import script_in, watched

from rl_tui.programs.watched.program_log import ProgramLog

pytestmark = pytest.mark.process

_LOOP = """
import gymnasium as gym, numpy as np, random
from collections import defaultdict
{before}
env = gym.make("FrozenLake-v1")
s, _ = env.reset()
for t in range(40):
    a = env.action_space.sample()
    s2, r, te, tr, _ = env.step(a)
    {update}
    s = s2
    if te or tr:
        s, _ = env.reset()
"""


def _log(folder: Path, before: str, update: str, table: str | None = None) -> ProgramLog:
    return watched(script_in(folder, _LOOP.format(before=before, update=update)), table=table)


@pytest.mark.parametrize(
    ("before", "name", "others"),
    [
        ("counts = np.zeros((16, 4)); table = np.zeros((16, 4))", "table", ()),
        ("visits = np.zeros((16, 4)); E = np.zeros((16, 4)); x = np.zeros((16, 4))", "x", ()),
        ("pi = np.full((16, 4), .25); chances = np.full((16, 4), .25); w = np.zeros((16, 4))", "w", ()),
        ("x = np.zeros((16, 4)); Q = np.zeros((16, 4))", "Q", ("x",)),
        ("Q1 = np.zeros((16, 4)); Q2 = np.zeros((16, 4))", "Q1", ("Q2",)),
        ("best_q = np.zeros((16, 4)); q = np.zeros((16, 4))", "q", ("best_q",)),
        ("q = np.zeros((16, 4)); same = q", "q", ()),
        ("class A: pass\nme = A(); me.own = A(); me.own.q_values = np.zeros((16, 4))", "me.own.q_values", ()),
        ("class A: Q = np.zeros((16, 4))\nme = A()", "me.Q", ()),
        ("class A: Q = {i: [0.0] * 4 for i in range(16)}\nclass B(A): pass\nme = B()", "me.Q", ()),
        ("q = np.zeros((4, 16)); table = np.zeros((16, 4))", "table", ()),
    ],
)
def test_the_table_is_found_by_its_shape_and_its_name(
    tmp_path: Path, before: str, name: str, others: tuple[str, ...]
) -> None:
    log = _log(tmp_path, before, "pass")

    assert log.error is None
    assert (log.table.name, log.table.others) == (name, others)


@pytest.mark.parametrize(("wanted", "name"), [("counts", "counts"), ("agent.w", "agent.w"), ("w", "agent.w")])
def test_a_person_can_choose_the_table(tmp_path: Path, wanted: str, name: str) -> None:
    before = (
        "counts = np.zeros((16, 4)); q = np.zeros((16, 4))\nclass A: pass\nagent = A(); agent.w = q.copy()"
    )

    log = _log(tmp_path, before, "pass", wanted)

    assert log.table.name == name
    assert "q" in log.table.others


def test_a_table_that_is_not_there_is_said(tmp_path: Path) -> None:
    log = _log(tmp_path, "q = np.zeros((16, 4))", "pass", "theta")

    assert log.table is None
    assert any("theta" in note for note in log.notes)


def test_an_attribute_of_an_environment_is_not_a_table(tmp_path: Path) -> None:
    text = """\
    import gymnasium as gym, numpy as np
    class Grid(gym.Env):
        bonus = np.zeros((6, 2))
        observation_space, action_space = gym.spaces.Discrete(6), gym.spaces.Discrete(2)
        def reset(self, seed=None, options=None):
            return 0, {}
        def step(self, a):
            self.bonus[0, a] += 1
            return 1, 0.0, True, False, {}
    env = Grid()
    def learn():
        w = np.zeros((6, 2))
        for episode in range(9):
            env.reset()
            w[0, 1] += env.step(1)[1] + 1
    learn()
    """
    log = watched(script_in(tmp_path, text))
    assert log.error is None
    assert (log.table.name, log.table.others) == ("w", ())


def test_looking_calls_nothing_of_the_program(tmp_path: Path) -> None:
    before = """
class Touchy:
    def __init__(self): object.__setattr__(self, "q", np.zeros((16, 4)))
    @property
    def values(self): raise SystemExit("the property was called")
    def __getattr__(self, name): raise SystemExit("__getattr__ was called")
    def __getattribute__(self, name): raise SystemExit("__getattribute__ was called")
    def __eq__(self, other): raise SystemExit("__eq__ was called")
    def __len__(self): raise SystemExit("__len__ was called")
class Rows(dict):
    def __getitem__(self, key): raise SystemExit("__getitem__ was called")
    def items(self): raise SystemExit("items was called")
    def __getattr__(self, name): raise SystemExit("__getattr__ was called")
    def __iter__(self): raise SystemExit("__iter__ was called")
    def __len__(self): raise SystemExit("__len__ was called")
    def __eq__(self, other): raise SystemExit("__eq__ was called")
    def keys(self): raise SystemExit("keys was called")
    def get(self, key): raise SystemExit("get was called")
touchy, rows = Touchy(), Rows({i: [0.0] * 4 for i in range(16)})
"""
    for wanted in ("q", "rows"):
        log = _log(tmp_path, before, "dict.get(rows, s)[a] -= 1", wanted)

        assert log.recording.count == 40
        assert log.notes == []
        assert {log.table.name, *log.table.others} == {"touchy.q", "rows"}
        assert len(log.recording.changes.cell) == (40 if wanted == "rows" else 0)


def test_looking_adds_nothing_to_a_dict(tmp_path: Path) -> None:
    log = _log(tmp_path, "q = defaultdict(lambda: np.zeros(4)); q[3][1] = .5", "print(len(q))")

    assert {line.text for line in log.output} == {"1"}
    assert log.table is not None
    assert int(np.isfinite(log.recording.table_at(0)).sum()) == 4


def test_rows_that_are_one_object_are_told(tmp_path: Path) -> None:
    log = _log(tmp_path, "q = [[0.0] * 4] * 16", "q[s][a] += 1")

    assert log.shared_at == 0


def test_an_array_of_whole_numbers_says_so(tmp_path: Path) -> None:
    log = _log(tmp_path, "q = np.zeros((16, 4), dtype=np.int32)", "q[s, a] += 1")

    assert log.table.dtype == "int32"


@pytest.mark.parametrize(
    ("text", "refused"),
    [
        ("gym.make_vec('FrozenLake-v1', num_envs=2)", "vector"),
        ("from gymnasium.vector import SyncVectorEnv\nSyncVectorEnv([lambda: env])", "vector"),
        ("import threading\nstep()\nt = threading.Thread(target=step); t.start(); t.join()", "thread"),
        ("import os\nstep()\nif os.fork() == 0: step()\nos.wait()", "fork"),
    ],
)
def test_what_cannot_be_watched_is_refused(tmp_path: Path, text: str, refused: str) -> None:
    head = "import gymnasium as gym\nenv = gym.make('FrozenLake-v1')\n"
    head += "def step():\n    env.reset(); env.step(0)\n"

    log = watched(script_in(tmp_path, head + text))

    assert refused in log.refused


@pytest.mark.parametrize(
    ("text", "note"),
    [
        ("print('nothing')", "nothing to watch"),
        ("import copy; env = copy.deepcopy(gym.make('FrozenLake-v1')); env.reset(); env.step(0)", "copies"),
        ("env = gym.make('CartPole-v1'); env.reset()", "reads the state from the index of your table"),
    ],
)
def test_a_program_of_which_nothing_was_seen_is_told_why(tmp_path: Path, text: str, note: str) -> None:
    log = watched(script_in(tmp_path, f"import gymnasium as gym\n{text}\n"))

    assert (log.recording.count, log.error, len(log.notes)) == (0, None, 1)
    assert note in log.notes[0]


@pytest.mark.parametrize(
    ("make", "made"),
    [
        ("gym.make('Taxi-v3')", "Taxi-v4"),
        ("gym.make(id='CliffWalking-v0')", "CliffWalking-v1"),
        ("gym.make('FrozenLake-v1', render_mode='human')", "FrozenLake-v1"),
    ],
)
def test_what_had_to_be_made_otherwise_is_said(tmp_path: Path, make: str, made: str) -> None:
    log = watched(script_in(tmp_path, f"import gymnasium as gym\nenv = {make}\nenv.reset()\nenv.step(0)\n"))

    assert log.error is None
    assert [each.id for each in log.environments] == [made]
    assert len(log.notes) == 1


@pytest.mark.parametrize(
    "make",
    ["gymnasium.make('FrozenLake-v1')", "make('FrozenLake-v1')", "registration.make(spec('FrozenLake-v1'))"],
)
def test_each_way_of_making_is_watched(tmp_path: Path, make: str) -> None:
    head = "import gymnasium\nfrom gymnasium import make, spec\nfrom gymnasium.envs import registration\n"

    log = watched(script_in(tmp_path, f"{head}env = {make}\nenv.reset()\nenv.step(0)\n"))

    assert log.recording.count == 1
    assert log.called["step"][1] == 6


def test_a_table_of_transitions_that_only_the_program_has_is_told(tmp_path: Path) -> None:
    text = """\
    import gymnasium as gym
    class Coin(gym.Env):
        observation_space, action_space = gym.spaces.Discrete(2), gym.spaces.Discrete(1)
        P = None
        def __init__(self):
            self.P = {s: {0: [(0.5, 0, 0.0, False), (0.5, 1, 1.0, True)]} for s in range(2)}
        def reset(self, *, seed=None, options=None):
            super().reset(seed=seed)
            return 0, {}
        def step(self, action):
            return 1, 1.0, True, False, {}
    gym.register("Coin-v0", entry_point=Coin)
    env = gym.make("Coin-v0")
    env.reset()
    env.step(0)
    """
    log = watched(script_in(tmp_path, text))

    assert log.environments[0].transitions[0][0] == [[0.5, 0, 0.0, False], [0.5, 1, 1.0, True]]


def test_the_same_seed_gives_the_same_steps_and_another_gives_others(tmp_path: Path) -> None:
    update = "x = random.random() + np.random.rand() + np.random.default_rng().random(); print(x)"

    first, again, other = (
        watched(script_in(tmp_path, _LOOP.format(before="", update=update)), seed=seed) for seed in (1, 1, 2)
    )

    assert first.recording.steps.state.tolist() == again.recording.steps.state.tolist()
    assert [line.text for line in first.output] == [line.text for line in again.output]
    assert first.recording.steps.action.tolist() != other.recording.steps.action.tolist()


def test_a_watched_process_loads_nothing_heavy(tmp_path: Path) -> None:
    heavy = "print(sorted({'numba', 'scipy', 'pydantic', 'textual'} & set(sys.modules)))"

    log = _log(tmp_path, f"import sys\n{heavy}", "pass")

    assert [line.text for line in log.output] == ["[]"]
