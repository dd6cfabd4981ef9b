"""Scripts written for the old Gym, in each of its forms."""

from __future__ import annotations

from pathlib import Path

import pytest
from corpus import CORRECT, FAULTY, expected
from watched_scripts import lines_of, script_in, watched

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.grading.watch_report import learned_figures

pytestmark = pytest.mark.process

NOTE = (
    "the script imports the old gym: Gymnasium answers instead, in the form that each call of reset and step "
    "expects"
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
            (f"{MADE}{part}", form, "FrozenLake-v1", 0 if part else 100)
            for form in (OLD, NEW, MIXED)
            for part in ("", ".env", ".unwrapped")
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
    log = watched(script_in(tmp_path, f"import gym\n{env}\n{LEARNING.format(**form)}"), steps=6000)
    verdict = verdict_of(log)
    assert (log.error, verdict.findings) == (None, ())
    assert NOTE in log.notes
    (made,) = log.environments
    assert (made.id, made.time_limit) == (name, limit)
    assert (verdict.update.rule, verdict.update.alpha, verdict.update.gamma) == (
        "q-learning",
        pytest.approx(0.25),
        pytest.approx(0.9),
    )


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


def test_a_state_that_the_program_sets_is_where_its_step_begins(tmp_path: Path) -> None:
    text = """\
    import gym
    env = gym.make("FrozenLake-v0", is_slippery=False)
    env.reset()
    env.env.s = 14
    env.step(2)
    """
    log = watched(script_in(tmp_path, text))
    assert (log.recording.steps.state.tolist(), log.recording.steps.next_state.tolist()) == ([14], [15])


@pytest.mark.exhaustive("watches every program", but=["correct-sarsa_cliff", "faulty-integers"])
@pytest.mark.parametrize(
    "script", [*CORRECT, *FAULTY], ids=lambda script: f"{script.parent.name}-{script.stem}"
)
def test_a_program_is_understood_under_the_old_name_too(script: Path, tmp_path: Path) -> None:
    text = script.read_text(encoding="utf-8").replace("import gymnasium as gym", "import gym")
    text = text.replace("import gymnasium", "import gym as gymnasium").replace("from gymnasium", "from gym")
    wanted, group = expected(script), CORRECT if script in CORRECT else FAULTY
    log = watched(script_in(tmp_path, text), seed=group.index(script))
    verdict = verdict_of(log)
    assert (log.error, NOTE in log.notes) == (None, True)
    faults = [each.fault.value for each in verdict.findings]
    if group is FAULTY:
        assert faults == wanted
    else:
        assert (faults, verdict.update.rule) == ([], wanted.get("rule", verdict.update.rule))


def test_an_installed_gym_is_not_used(tmp_path: Path) -> None:
    (tmp_path / "gym.py").write_text("raise RuntimeError('too old')\n")
    assert watched(script_in(tmp_path, "import gym\nprint(gym.make('Taxi-v3').nS)\n")).error is None
