"""Agents in the shapes of courses."""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import pytest
from programs.course_agents import BERKELEY, FUNCTION, GYMNASIUM, OF_STYLE, OTHERS, RL_GLUE, UDACITY, agent_in

from rl_tui.common.errors import UserError
from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.evidence.verdict import Rule
from rl_tui.programs.grading.agent_training import agent_request
from rl_tui.programs.own_agents.binding import Style
from rl_tui.programs.own_agents.loading import AgentName, agents_in, the_agent
from rl_tui.programs.watched.program_log import ProgramLog
from rl_tui.programs.watched.program_process import watched_to_the_end
from rl_tui.runs.library import recipe_named
from rl_tui.runs.recipe import begin
from rl_tui.runs.training.seeded_runs import Goal

pytestmark = pytest.mark.process

PATIENCE = 120.0
TEXTS = {**OF_STYLE, **OTHERS}


def learned(
    path: Path, scenario: str = "frozenlake", episodes: int = 300, seed: int = 0, **given: float
) -> ProgramLog:
    recipe = recipe_named(scenario, {}, seed)
    request = agent_request(AgentName.read(str(path)), recipe, given, Goal(episodes=episodes))
    return watched_to_the_end(request, seconds=PATIENCE)


def style_in(text: str, folder: Path) -> list[tuple[str, str]]:
    return [(each.name, each.style.value) for each in agents_in(ast.parse(text), folder)]


@pytest.mark.parametrize("style", OF_STYLE)
def test_a_shape_is_told_by_its_methods(style: str, tmp_path: Path) -> None:
    assert [found for _, found in style_in(OF_STYLE[style], tmp_path)] == [style]


@pytest.mark.exhaustive("learns in every style", but=["function", "berkeley"])
@pytest.mark.parametrize("name", TEXTS)
def test_an_agent_of_a_course_learns_and_is_understood(name: str, tmp_path: Path) -> None:
    log = learned(agent_in(tmp_path, TEXTS[name]))
    assert log.error is None, log.error
    steps, verdict = log.recording.steps, verdict_of(log)
    assert int(steps.episode.max()) == 299
    assert verdict.update.rule == (Rule.SARSA if name == "sarsa" else Rule.Q_LEARNING)
    assert verdict.findings == ()
    own = {"gymnasium": (0.1, 0.95), "udacity": (0.2, 0.9), "function": (0.2, 0.9)}
    assert (verdict.update.alpha, verdict.update.gamma) == pytest.approx(own.get(name, (0.1, 0.99)))
    assert np.nanmax(log.recording.table_at(log.recording.count)) > 0.5


OTHER_NAMES = """
import random

class Learner:
    def __init__(self, n_states, n_actions, alpha=0.1, gamma=0.95, epsilon=0.2):
        self.n_actions, self.alpha, self.gamma, self.epsilon = n_actions, alpha, gamma, epsilon
        self.q_table = [[0.0] * n_actions for _ in range(n_states)]

    def {choose}(self, state):
        if random.random() < self.epsilon:
            return random.randrange(self.n_actions)
        row = self.q_table[state]
        return random.choice([each for each in range(self.n_actions) if row[each] == max(row)])

    def update(self):
        raise RuntimeError("this is something else")

    def {learn}:
        ahead = 0.0 if done else max(self.q_table[{after}])
        self.q_table[{before}][{action}] += self.alpha * (
            reward + self.gamma * ahead - self.q_table[{before}][{action}]
        )
"""


@pytest.mark.parametrize(
    ("choose", "learn", "before", "action", "after"),
    [
        (
            "choose_action",
            "learn(self, state, action, reward, next_state, done)",
            "state",
            "action",
            "next_state",
        ),
        ("act", "train(self, s0, a0, reward, new_state, done)", "s0", "a0", "new_state"),
        (
            "sample_action",
            "update_q(self, state1, reward, done, action1, state2)",
            "state1",
            "action1",
            "state2",
        ),
    ],
)
def test_methods_may_have_other_names(
    choose: str, learn: str, before: str, action: str, after: str, tmp_path: Path
) -> None:
    text = OTHER_NAMES.format(choose=choose, learn=learn, before=before, action=action, after=after)
    path = agent_in(tmp_path, text)
    assert style_in(text, tmp_path) == [("Learner", "gymnasium")]
    log = learned(path)
    verdict = verdict_of(log)
    assert (log.error, verdict.findings, verdict.update.rule) == (None, (), Rule.Q_LEARNING)
    assert (verdict.update.alpha, verdict.update.gamma) == pytest.approx((0.1, 0.95))


def test_a_method_that_learns_from_a_memory_is_no_agent(tmp_path: Path) -> None:
    text = (
        "class A:\n    def act(self, state):\n        return 0\n    def train(self, memory):\n        pass\n"
    )
    assert style_in(text, tmp_path) == []


def test_what_is_given_by_name_is_what_it_learns_with(tmp_path: Path) -> None:
    log = learned(agent_in(tmp_path, FUNCTION), alpha=0.5, gamma=0.8)
    update = verdict_of(log).update
    assert (update.alpha, update.gamma) == pytest.approx((0.5, 0.8))


BY_CHANCE = """
import random
import numpy as np

class Agent:
    def __init__(self, env, rng, seed):
        own = np.random.RandomState(seed), rng, np.random.default_rng()
        self.draw = [random.random, np.random.rand, own[0].rand, own[1].random, own[2].random]
        self.env, self.q = env, np.zeros((16, 4))

    def get_action(self, obs):
        return (self.env.action_space.sample() + int(sum(draw() for draw in self.draw) * 4)) % 4

    def update(self, obs, action, reward, terminated, next_obs):
        self.q[obs, action] += reward
"""


@pytest.mark.parametrize("text", [BY_CHANCE, FUNCTION], ids=["every source of chance", "function"])
def test_the_same_seed_is_the_same_run(text: str, tmp_path: Path) -> None:
    path = agent_in(tmp_path, text)
    first, again, other = (
        learned(path, "frozenlake-slippery", 20, seed).recording.steps for seed in (2**40, 2**40, 6)
    )
    for one, two in zip(first, again, strict=True):
        np.testing.assert_array_equal(one, two)
    assert not np.array_equal(first.state, other.state)


CUT_OFF = """
title = "A corridor"
[grid]
map = '''
S....G
'''
time_limit = 3
[defaults]
episodes = 5
"""


def cut_off(folder: Path) -> str:
    path = folder / "corridor.toml"
    path.write_text(CUT_OFF)
    return str(path)


def printed(log: ProgramLog) -> list[str]:
    assert log.error is None, log.error
    return [line.text for line in log.output if line.stream == "out"]


def test_udacitys_done_is_true_at_a_truncation_and_that_is_no_fault(tmp_path: Path) -> None:
    text = UDACITY.replace("goal = reward", "print(done)\n        goal = reward", 1)
    log = learned(agent_in(tmp_path, text), cut_off(tmp_path), 2)
    assert printed(log) == ["False", "False", "True"] * 2
    assert log.agent.done_is_either


def test_gymnasiums_terminated_is_false_at_a_truncation(tmp_path: Path) -> None:
    text = GYMNASIUM.replace("future =", "print(terminated)\n        future =", 1)
    assert printed(learned(agent_in(tmp_path, text), cut_off(tmp_path), 1)) == ["False"] * 3


def test_rl_glues_end_comes_only_where_the_world_ends_the_episode(tmp_path: Path) -> None:
    text = RL_GLUE.replace("        error = reward +", '        print("step")\n        error = reward +', 1)
    text = text.replace("        error = reward -", '        print("end")\n        error = reward -', 1)
    path = agent_in(tmp_path, text)
    assert printed(learned(path, cut_off(tmp_path), 1)) == ["step"] * 3
    assert printed(learned(path, "bandit", 3)) == ["end"] * 3


def test_berkeleys_legal_actions_are_none_after_the_end_only(tmp_path: Path) -> None:
    text = BERKELEY.replace(
        "        sample =", "        print(len(self.getLegalActions(nextState)))\n        sample ="
    )
    path = agent_in(tmp_path, text)
    assert printed(learned(path, cut_off(tmp_path), 1)) == ["4"] * 3
    log = learned(path, "frozenlake", 5)
    ended = log.recording.steps.terminated
    assert printed(log) == ["0" if each else "4" for each in ended]


def test_epsilon_decays_after_each_episode(tmp_path: Path) -> None:
    text = GYMNASIUM.replace(
        "self.epsilon - self.epsilon_decay)", "self.epsilon - 0.25); print(self.epsilon)"
    )
    log = learned(agent_in(tmp_path, text), episodes=3, epsilon=1.0, epsilon_min=0.5)
    assert printed(log) == ["0.75", "0.5", "0.5"]


def test_of_several_agents_one_is_to_be_named(tmp_path: Path) -> None:
    text = UDACITY + UDACITY.replace("class Agent", "class Better")
    path = agent_in(tmp_path, text)
    assert [name for name, _ in style_in(text, tmp_path)] == ["Agent", "Better"]
    with pytest.raises(UserError, match=r"several agents \(Agent, Better\).*mine\.py:Agent"):
        the_agent(ast.parse(text), path)
    assert the_agent(ast.parse(text), path, "Better").name == "Better"
    assert learned(Path(f"{path}:Better"), episodes=2).error is None


@pytest.mark.parametrize(
    ("name", "said"),
    [("Agnet", r'there is no "Agnet" \(did you mean "Agent"\?\)'), ("helper", "is not an agent")],
)
def test_a_name_that_is_no_agent(name: str, said: str, tmp_path: Path) -> None:
    tree = ast.parse(f"{UDACITY}\ndef helper(x):\n    return x\n")
    with pytest.raises(UserError, match=said):
        the_agent(tree, tmp_path / "mine.py", name)


def test_methods_of_base_classes_count_also_of_those_in_a_neighbouring_file(tmp_path: Path) -> None:
    agent_in(tmp_path, UDACITY.replace("class Agent", "class Base"), "base.py")
    text = (
        "from base import Base\n\nclass Mine(Base):\n    def select_action(self, state):\n        return 1\n"
    )
    path = agent_in(tmp_path, text)
    assert style_in(text, tmp_path) == [("Mine", Style.UDACITY.value)]
    assert set(learned(path, episodes=3).recording.steps.action.tolist()) == {1}


def test_an_abstract_class_is_no_agent(tmp_path: Path) -> None:
    text = """
from abc import ABC, abstractmethod
class Base(ABC):
    @abstractmethod
    def get_action(self, obs): ...
    @abstractmethod
    def update(self, obs, action, reward, terminated, next_obs): ...
class Other:
    def get_action(self, obs):
        raise NotImplementedError
    def update(self, obs, action, reward, terminated, next_obs):
        raise NotImplementedError("later")
"""
    assert style_in(text, tmp_path) == []


def test_the_update_function_of_a_script_is_no_agent(tmp_path: Path) -> None:
    text = f"import gymnasium as gym\nenv = gym.make('FrozenLake-v1')\n{FUNCTION}"
    assert style_in(text, tmp_path) == []


@pytest.mark.parametrize(
    ("text", "place", "said"),
    [
        (UDACITY.replace("goal = reward if", "goal = 1 / 0 if"), 18, "division by zero"),
        (UDACITY.replace("self.nA = nA", "self.nA = None + nA"), 8, "unsupported operand"),
        (
            UDACITY.replace("return np.random.choice(np.flat", "return None and (np.flat"),
            None,
            "returned None",
        ),
        (UDACITY.replace("nA=6", "colour, nA=6"), None, "colour"),
        (f"import nothing_like_that\n{UDACITY}", 1, "No module named"),
    ],
    ids=["in a method", "in the constructor", "no action", "cannot be bound", "missing import"],
)
def test_what_an_agent_does_wrong_is_told_with_its_place(
    text: str, place: int | None, said: str, tmp_path: Path
) -> None:
    path = agent_in(tmp_path, text)
    error = learned(path, episodes=50).error
    assert said in error.text
    assert error.line == place
    assert place is None or error.file == str(path)


def test_a_table_that_has_come_to_no_numbers_still_lives(tmp_path: Path) -> None:
    log = learned(
        agent_in(tmp_path, "def update(q, s, a, r, s_next):\n    q[s] = float('nan')\n"), episodes=5
    )
    assert log.error is None
    assert log.recording.steps.episode[-1] == 4


def test_what_berkeleys_course_has_is_there_without_its_files(tmp_path: Path) -> None:
    text = """
import random, util
from game import *
from learningAgents import ReinforcementAgent
from featureExtractors import *

class QLearningAgent(ReinforcementAgent):
    def __init__(self, **args):
        ReinforcementAgent.__init__(self, **args)
        self.values = util.Counter()

    def getAction(self, state):
        legal = self.getLegalActions(state)
        if util.flipCoin(self.epsilon):
            return random.choice(legal)
        counts = util.Counter()
        for action in legal:
            counts[action] = self.values[(state, action)]
        return counts.argMax()

    def update(self, state, action, nextState, reward):
        ahead = [self.values[(nextState, each)] for each in self.getLegalActions(nextState)]
        target = reward + self.discount * max(ahead, default=0.0)
        self.values[(state, action)] += self.alpha * (target - self.values[(state, action)])
"""
    log = learned(agent_in(tmp_path, text), "student", 100)
    assert log.error is None, log.error
    assert verdict_of(log).update.rule == Rule.Q_LEARNING


def test_a_file_called_as_its_base_class_s_is_not_its_own_base(tmp_path: Path) -> None:
    text = RL_GLUE.replace("from rl_glue.agent", "from agent")
    log = learned(agent_in(tmp_path, text, "agent.py"), episodes=2)
    assert log.error is None, log.error


def test_where_not_all_actions_are_legal(tmp_path: Path) -> None:
    log = learned(agent_in(tmp_path, FUNCTION), "student", 20)
    assert log.error is None
    space = begin(recipe_named("student")).world.space
    steps = log.recording.steps
    pairs = set(zip(steps.state.tolist(), steps.action.tolist(), strict=True))
    assert pairs <= set(zip(space.pair_state.tolist(), space.pair_action.tolist(), strict=True))
