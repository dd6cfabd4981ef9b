"""Environments made without wrappers."""

from __future__ import annotations

from pathlib import Path

import pytest
from watched_scripts import check_q_learning, lines_of, script_in, watched

from rl_tui.programs.grading.watch_report import learned_figures

pytestmark = pytest.mark.process

CORRIDOR = """\
import gymnasium as gym
import numpy as np
from gymnasium import spaces
class Corridor(gym.Env):
    def __init__(self, length=8):
        self.observation_space, self.action_space = spaces.Discrete(length), spaces.Discrete(2)
        self.length = length
        self.reset()
    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.cell = int(self.np_random.integers(3))
        return self.cell, {}
    def step(self, action):
        self.cell = max(0, self.cell + (1 if action else -1))
        ended = self.cell == self.length - 1
        return self.cell, 5.0 if ended else -1.0, ended, False, {}
"""
LEARNING = """
Q = np.zeros((env.observation_space.n, env.action_space.n))
for episode in range(1000):
    s, _ = env.reset()
    done = False
    while not done:
        best = np.flatnonzero(Q[s] == Q[s].max())
        a = env.action_space.sample() if rng.random() < 0.6 else int(rng.choice(best))
        s2, r, ended, cut, _ = env.step(a)
        Q[s, a] += 0.25 * (r + 0.9 * Q[s2].max() * (not ended) - Q[s, a])
        s, done = s2, ended or cut
"""


def learning(env: str) -> str:
    return f"{CORRIDOR}rng = np.random.default_rng()\nenv = {env}\n{LEARNING}"


@pytest.mark.parametrize(
    ("env", "name", "states", "limit"),
    [
        ("Corridor()", "Corridor", 8, 0),
        ("gym.wrappers.TimeLimit(Corridor(), 50)", "Corridor", 8, 0),
        ("gym.make('FrozenLake-v1', is_slippery=False).env", "FrozenLake-v1", 16, 0),
        ("gym.make('FrozenLake-v1').unwrapped", "FrozenLake-v1", 16, 0),
        ("gym.make('FrozenLake-v1').env.env", "FrozenLake-v1", 16, 0),
        ("__import__('gymnasium.envs.toy_text').envs.toy_text.FrozenLakeEnv()", "FrozenLakeEnv", 16, 0),
    ],
)
def test_its_steps_are_seen(env: str, name: str, states: int, limit: int, tmp_path: Path) -> None:
    log = watched(script_in(tmp_path, learning(env)), steps=3000)
    assert log.notes == []
    (made,) = log.environments
    assert (made.id, made.states, made.time_limit) == (name, states, limit)
    check_q_learning(log, "Q", "array", 0.25, 0.9)


def test_its_own_table_gives_exact_values(tmp_path: Path) -> None:
    env = "__import__('gymnasium.envs.toy_text').envs.toy_text.FrozenLakeEnv(is_slippery=False)"
    found = learned_figures(watched(script_in(tmp_path, learning(env)), steps=100), 0.9)
    assert found.best_expected_return == pytest.approx(1.0)


def test_the_limit_stays_if_only_the_model_is_read(tmp_path: Path) -> None:
    env = "gym.make('FrozenLake-v1'); P = env.unwrapped.P, env.env.spec"
    log = watched(script_in(tmp_path, learning(env)), steps=500)
    assert log.environments[0].time_limit == 100
    assert log.recording.count == 500


def test_a_run_repeats_with_its_seed(tmp_path: Path) -> None:
    path = script_in(tmp_path, learning("Corridor()"))
    first, second = (watched(path, seed=3, steps=500).recording for _ in range(2))
    assert first.steps.state.tolist() == second.steps.state.tolist()
    assert len(set(first.steps.state[first.steps.episode_step == 0])) == 3


def test_its_methods_keep_their_names(tmp_path: Path) -> None:
    text = f"{CORRIDOR}env = Corridor()\nprint(env.step.__name__, env.reset.__name__)\n"
    assert lines_of(watched(script_in(tmp_path, text))) == ["step reset"]


def test_a_state_that_the_program_sets_is_where_its_step_begins(tmp_path: Path) -> None:
    text = """\
    import gymnasium as gym
    env = gym.make("FrozenLake-v1", is_slippery=False).unwrapped
    env.reset()
    for state in (3, 14, 6):
        env.s = state
        env.step(2)
    """
    log = watched(script_in(tmp_path, text))
    assert log.recording.steps.state.tolist() == [3, 14, 6]
    assert log.recording.steps.next_state.tolist() == [3, 15, 7]


@pytest.mark.parametrize(
    "trial",
    [
        "import copy; other = copy.deepcopy(env)",
        "import copy; other = copy.copy(env)",
        "import pickle; other = pickle.loads(pickle.dumps(env))",
    ],
)
def test_a_copy_is_only_tried_out(trial: str, tmp_path: Path) -> None:
    text = f"""{CORRIDOR}
env = Corridor()
env.reset()
env.step(0)
{trial}
for _ in range(20):
    other.step(1)
print(type(env) is Corridor, isinstance(env, Corridor), type(other) is Corridor, env.cell < other.cell)
env.step(1)
"""
    log = watched(script_in(tmp_path, text))
    assert log.error is None
    assert log.recording.count == 2
    assert lines_of(log) == ["False True True True"]


def test_an_environment_in_another_reports_alone(tmp_path: Path) -> None:
    text = f"""{CORRIDOR}
class Outer(Corridor):
    def __init__(self):
        self.inner = gym.make("FrozenLake-v1")
        super().__init__()
    def reset(self, **more):
        return self.inner.reset(**more)
    def step(self, action):
        return self.inner.step(action)
env = Outer()
env.reset()
for _ in range(3):
    env.step(1)
"""
    log = watched(script_in(tmp_path, text))
    assert log.recording.count == 3
    assert set(log.recording.steps.environment) == {0}
    assert log.environments[0].id == "FrozenLake-v1"


def test_a_class_without_finite_spaces_is_left_as_it_is(tmp_path: Path) -> None:
    text = """\
    import gymnasium as gym
    from gymnasium.envs.classic_control import CartPoleEnv
    env = CartPoleEnv()
    env.reset(seed=1)
    print(len(env.step(0)), type(env).__name__)
    """
    log = watched(script_in(tmp_path, text))
    assert (log.error, log.recording.count, lines_of(log)) == (None, 0, ["5 CartPoleEnv"])
