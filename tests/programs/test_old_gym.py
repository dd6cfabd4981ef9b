"""Scripts for the old Gym."""

from __future__ import annotations

from pathlib import Path

import pytest
from watched_scripts import check_q_learning, lines_of, script_in, watched

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.grading.watch_report import learned_figures

pytestmark = pytest.mark.process

NOTE = (
    "the script imports the old gym: Gymnasium replaces it, and reset and step return as many values as the "
    "script expects"
)
LEARNING = """
import numpy as np
rng = np.random.default_rng()
Q = np.zeros((env.observation_space.n, env.action_space.n))
for episode in range(1500):
    {reset}
    done = False
    for _ in range(80):
        best = np.flatnonzero(Q[s] == Q[s].max())
        a = env.action_space.sample() if rng.random() < 0.6 else int(rng.choice(best))
        {step}
        Q[s, a] += 0.25 * (r + 0.9 * Q[s2].max() * (1 - done) - Q[s, a])
        s = s2
        if done:
            break
"""
OLD = {"reset": "s = env.reset()", "step": "s2, r, done, _ = env.step(a)"}
NEW = {"reset": "s, _ = env.reset()", "step": "s2, r, done, cut, _ = env.step(a)"}
MIXED = {"reset": "s = env.reset()[0]", "step": "s2, r, done, info = env.step(a)"}
WRAPPED = """\
class Doubled(gym.ObservationWrapper):
    def observation(self, observation):
        return observation
class Paid(gym.Wrapper):
    def step(self, action):
        observation, reward, done, info = self.env.step(action)
        return observation, reward, done, info
env = Paid(Doubled(gym.make("FrozenLake-v1", is_slippery=False)))
"""
OWN = """\
from gym import spaces
from gym.utils import seeding
class Corridor(gym.Env):
    metadata = {"render.modes": ["human"]}
    def __init__(self):
        self.observation_space, self.action_space = spaces.Discrete(8), spaces.Discrete(2)
        self.seed()
    def seed(self, seed=None):
        self.np_random, seed = seeding.np_random(seed)
        return [seed]
    def reset(self):
        self.cell = self.np_random.randint(3)
        return self.cell
    def step(self, action):
        self.cell = max(0, self.cell + (1 if action else -1))
        return self.cell, 5.0 if self.cell == 7 else -1.0, self.cell == 7, {}
    def render(self, mode="human", close=False):
        return mode
"""
TABLE = """\
from gym.envs.toy_text import discrete
class Corridor(discrete.DiscreteEnv):
    def __init__(self):
        P = {s: {a: [(0.8, min(7, s + 1) if a else max(0, s - 1), float(s == 6), s == 6),
                     (0.2, s, 0.0, False)] for a in range(2)} for s in range(8)}
        super().__init__(8, 2, P, [1.0] + [0.0] * 7)
env = Corridor()
env.seed(3)
"""


MADE = "env = gym.make('FrozenLake-v0', is_slippery=False)"
REGISTERED = f"""{OWN}
from gym.envs.registration import register
register(id="C-v0", entry_point=Corridor, max_episode_steps=200)
env = gym.make("C-v0")
"""


@pytest.mark.parametrize(
    ("env", "form", "name", "limit"),
    [
        *(
            pytest.param(
                f"{MADE}{part}",
                form,
                "FrozenLake-v1",
                0 if part else 100,
                marks=() if place == other else pytest.mark.exhaustive("watches each form of each part"),
            )
            for place, form in enumerate((OLD, NEW, MIXED))
            for other, part in enumerate(("", ".env", ".unwrapped"))
        ),
        (f"{MADE}\nenv.seed(1)\nenv.render()", OLD, "FrozenLake-v1", 100),
        (WRAPPED, OLD, "FrozenLake-v1", 100),
        (f"{OWN}env = Corridor()", OLD, "Corridor", 0),
        (REGISTERED, OLD, "C-v0", 200),
        (TABLE, OLD, "Corridor", 0),
    ],
    ids=lambda value: value[-40:].strip() if isinstance(value, str) else None,
)
def test_a_script_learns_as_it_was_written(
    env: str, form: dict[str, str], name: str, limit: int, tmp_path: Path
) -> None:
    log = watched(script_in(tmp_path, f"import gym\n{env}\n{LEARNING.format(**form)}"), steps=2500)
    assert NOTE in log.notes
    (made,) = log.environments
    assert (made.id, made.time_limit) == (name, limit)
    check_q_learning(log, "Q", "array", 0.25, 0.9)


def test_a_world_by_its_table_has_exact_values(tmp_path: Path) -> None:
    log = watched(script_in(tmp_path, f"import gym\n{TABLE}\n{LEARNING.format(**OLD)}"), steps=500)
    assert learned_figures(log, 0.9).best_expected_return == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("text", "printed"),
    [
        (
            "print(env.nS, env.env.nA, len(env.unwrapped.P), env.P is env.env.P, env.isd[0])",
            "16 4 16 True 1.0",
        ),
        (
            "print(env.render(mode='rgb_array').shape, repr(env.render('ansi')), env.render())",
            "(64, 64, 3) '' None",
        ),
        ("env.reset(); env.env.s = 14; print(env.step(2)[0])", "15"),
        ("print(gym.__version__); s, r, d, i = env.step(env.reset() * 0)", "0.18.0"),
        ("print(gym.__version__); env.reset(seed=1); s, r, d, t, i = env.step(0)", "0.26.2"),
        ("print('Taxi-v4' in [each.id for each in gym.envs.registry.all()])", "True"),
        ("import gym.spaces as s; print(s.Discrete(3).n, gym.spaces.Discrete is s.Discrete)", "3 True"),
        ("from gym.wrappers import Monitor; print(Monitor(env, 'x', force=True) is env)", "True"),
        ("with env as e: print(e is env); env.close(); env.reset()", "True"),
        (
            "from gym.envs.toy_text import FrozenLakeEnv as F\ne = F(); print(e.reset(), len(e.step(0)))",
            "0 4",
        ),
        ("import gym.nothing", None),
        ("env.nothing", None),
    ],
)
def test_old_names_work(text: str, printed: str | None, tmp_path: Path) -> None:
    log = watched(
        script_in(tmp_path, f"import gym\nenv = gym.make('FrozenLake-v0', is_slippery=False)\n{text}\n")
    )
    if printed is None:
        assert (log.error.type, log.error.line) in {("ModuleNotFoundError", 3), ("AttributeError", 3)}
    else:
        assert (log.error, lines_of(log)) == (None, [printed])


def test_an_installed_gym_is_not_used(tmp_path: Path) -> None:
    (tmp_path / "gym.py").write_text("raise RuntimeError('too old')\n")
    assert watched(script_in(tmp_path, "import gym\nprint(gym.make('Taxi-v3').nS)\n")).error is None


@pytest.mark.parametrize(
    ("made", "begin"),
    [
        ("gym.make('Taxi-v3')", "env.env.s"),
        ("gym.make('FrozenLake-v0')", "env.unwrapped.s"),
        ("gym.make('Blackjack-v0')", "env.player, env.dealer"),
        ("BlackjackEnv()", "env.player, env.dealer"),
    ],
)
def test_an_episode_begins_where_an_environment_is_made(made: str, begin: str, tmp_path: Path) -> None:
    text = f"""\
    import gym
    from gym.envs.toy_text.blackjack import BlackjackEnv
    env = {made}
    print({begin})
    if env is not env.unwrapped:
        env.reset()
    for _ in range(3):
        s, r, done, _ = env.step(0)
        if done:
            env.reset()
    """
    log = watched(script_in(tmp_path, text))
    assert (log.error, log.recording.count) == (None, 3)


def test_an_attribute_that_an_environment_does_not_have_is_missing(tmp_path: Path) -> None:
    text = """\
    import gym
    env = gym.make("Blackjack-v0")
    print(hasattr(env, "s"), hasattr(env.unwrapped, "lastaction"), hasattr(env, "player"))
    env.reset()
    hand = env.player
    print(hasattr(env, "s"), env.player is hand)
    """
    log = watched(script_in(tmp_path, text))
    assert (log.error, lines_of(log)) == (None, ["False False True", "False True"])


@pytest.mark.parametrize("made", ["env.seed({}); env = env.unwrapped", "env = env.unwrapped; env.seed({})"])
def test_a_first_state_is_drawn_with_the_seed_of_the_program(made: str, tmp_path: Path) -> None:
    text = "import gym; env = gym.make('FrozenLake-v0'); {}; env.s; print([env.step(2)[0] for _ in range(9)])"

    def seen(by: str, seed: int) -> list[str]:
        log = watched(script_in(tmp_path, text.replace("{}", by)), seed=seed)
        assert log.error is None
        return lines_of(log)

    assert seen(made.format(1), 0) == seen(made.format(1), 5) != seen(made.format(2), 0)
    unseeded = "env = env.unwrapped"
    assert seen(unseeded, 5) == seen(unseeded, 5) != seen(unseeded, 0)


def test_the_state_of_an_environment_without_observations_is_the_index(tmp_path: Path) -> None:
    own = OWN.replace(
        "self.observation_space, self.action_space = spaces.Discrete(8), ", "self.action_space = "
    )
    own = own.replace("return self.cell", "return Seen(self.cell)")
    text = f"""\
import gym
from collections import defaultdict
class Seen:
    def __init__(self, cell):
        self.cell = cell
{own}
gym.envs.registration.register(id="Corridor-v0", entry_point=Corridor)
env = gym.make("Corridor-v0")
class Learner:
    Q = defaultdict(lambda: [0.0, 0.0])
    def row(self, seen):
        return (seen.cell, 1), (2, seen.cell % 3)
    def learn(self):
        s, done = self.row(env.reset()), False
        while not done:
            a = env.action_space.sample()
            seen, r, done, _ = env.step(a)
            s2 = self.row(seen)
            self.Q[s][a] += 0.25 * (r + 0.9 * max(self.Q[s2]) * (1 - done) - self.Q[s][a])
            s = s2
for _ in range(200):
    Learner().learn()
"""
    log = watched(script_in(tmp_path, text), steps=4_000)
    update = verdict_of(log).update
    assert (log.error, update.rule) == (None, "q-learning")
    assert (update.alpha, update.gamma) == (pytest.approx(0.25), pytest.approx(0.9))
