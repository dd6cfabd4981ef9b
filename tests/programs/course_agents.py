"""Agents as in courses, and in other styles."""

from __future__ import annotations

from pathlib import Path
from typing import Final

GYMNASIUM: Final = """
from collections import defaultdict

import gymnasium as gym
import numpy as np


class LakeAgent:
    def __init__(self, env: gym.Env, learning_rate: float, initial_epsilon: float, epsilon_decay: float,
                 final_epsilon: float, discount_factor: float = 0.95):
        self.env = env
        self.q_values = defaultdict(lambda: np.zeros(env.action_space.n))
        self.lr = learning_rate
        self.discount_factor = discount_factor
        self.epsilon = initial_epsilon
        self.epsilon_decay = epsilon_decay
        self.final_epsilon = final_epsilon
        self.training_error = []

    def get_action(self, obs: int) -> int:
        if np.random.random() < self.epsilon:
            return self.env.action_space.sample()
        row = self.q_values[obs]
        return int(np.random.choice(np.flatnonzero(row == row.max())))

    def update(self, obs, action, reward, terminated, next_obs):
        future = (not terminated) * np.max(self.q_values[next_obs])
        error = reward + self.discount_factor * future - self.q_values[obs][action]
        self.q_values[obs][action] += self.lr * error
        self.training_error.append(error)

    def decay_epsilon(self):
        self.epsilon = max(self.final_epsilon, self.epsilon - self.epsilon_decay)


if __name__ == "__main__":
    raise SystemExit("the loop of the tutorial is not run")
"""

UDACITY: Final = """
import numpy as np
from collections import defaultdict


class Agent:
    def __init__(self, nA=6):
        self.nA = nA
        self.Q = defaultdict(lambda: np.zeros(self.nA))
        self.eps, self.alpha, self.gamma = 0.1, 0.2, 0.9

    def select_action(self, state):
        if np.random.rand() < self.eps:
            return np.random.choice(self.nA)
        return np.random.choice(np.flatnonzero(self.Q[state] == self.Q[state].max()))

    def step(self, state, action, reward, next_state, done):
        goal = reward if done else reward + self.gamma * np.max(self.Q[next_state])
        self.Q[state][action] += self.alpha * (goal - self.Q[state][action])
"""

BERKELEY: Final = """
from game import *
from learningAgents import ReinforcementAgent
from featureExtractors import *

import random, util, math


class QLearningAgent(ReinforcementAgent):
    def __init__(self, **args):
        ReinforcementAgent.__init__(self, **args)
        self.qvalues = util.Counter()

    def getQValue(self, state, action):
        return self.qvalues[(state, action)]

    def computeValueFromQValues(self, state):
        actions = self.getLegalActions(state)
        return max([self.getQValue(state, action) for action in actions]) if actions else 0.0

    def computeActionFromQValues(self, state):
        best = self.computeValueFromQValues(state)
        actions = [a for a in self.getLegalActions(state) if self.getQValue(state, a) == best]
        return random.choice(actions) if actions else None

    def getAction(self, state):
        legalActions = self.getLegalActions(state)
        if util.flipCoin(self.epsilon):
            return random.choice(legalActions)
        return self.computeActionFromQValues(state)

    def update(self, state, action, nextState, reward):
        sample = reward + self.discount * self.computeValueFromQValues(nextState)
        old = self.getQValue(state, action)
        self.qvalues[(state, action)] = (1 - self.alpha) * old + self.alpha * sample

    def getPolicy(self, state):
        return self.computeActionFromQValues(state)

    def getValue(self, state):
        return self.computeValueFromQValues(state)
"""

RL_GLUE: Final = """
import numpy as np
from rl_glue.agent import BaseAgent


class QLearningAgent(BaseAgent):
    def agent_init(self, agent_init_info):
        self.num_actions = agent_init_info["num_actions"]
        self.num_states = agent_init_info["num_states"]
        self.epsilon = agent_init_info["epsilon"]
        self.step_size = agent_init_info["step_size"]
        self.discount = agent_init_info["discount"]
        self.rand_generator = np.random.RandomState(agent_init_info["seed"])
        self.q = np.zeros((self.num_states, self.num_actions))

    def policy(self, state):
        if self.rand_generator.rand() < self.epsilon:
            return self.rand_generator.randint(self.num_actions)
        row = self.q[state, :]
        return self.rand_generator.choice(np.nonzero(row == np.max(row))[0])

    def agent_start(self, observation):
        self.prev_state, self.prev_action = observation, self.policy(observation)
        return self.prev_action

    def agent_step(self, reward, observation):
        error = reward + self.discount * np.max(self.q[observation])
        error -= self.q[self.prev_state, self.prev_action]
        self.q[self.prev_state, self.prev_action] += self.step_size * error
        self.prev_state, self.prev_action = observation, self.policy(observation)
        return self.prev_action

    def agent_end(self, reward):
        error = reward - self.q[self.prev_state, self.prev_action]
        self.q[self.prev_state, self.prev_action] += self.step_size * error
"""

FUNCTION: Final = """
import numpy as np

def update(q, s, a, r, s_next, alpha=0.2, gamma=0.9):
    q[s, a] += alpha * (r + gamma * np.max(q[s_next]) - q[s, a])
"""

RETURNING_FUNCTION: Final = """
import numpy as np

def q_update(next_state, reward, action, state, Q, done, learning_rate, discount):
    Q = Q.copy()
    goal = reward + (not done) * discount * Q[next_state].max()
    Q[state, action] += learning_rate * (goal - Q[state, action])
    return Q
"""

SARSA_FUNCTION: Final = """
def update(q, s, a, r, s_next, a_next, terminated, alpha, gamma):
    q[s, a] += alpha * (r + (not terminated) * gamma * q[s_next, a_next] - q[s, a])
"""

GIVEN_THE_ENVIRONMENT: Final = """
import numpy as np

class Agent:
    def __init__(self, n_states, n_actions, lr, gamma, epsilon):
        self.table = np.zeros((n_states, n_actions))
        self.settings = lr, gamma, epsilon

    def get_action(self, env, obs):
        if np.random.random() < self.settings[2]:
            return env.action_space.sample()
        return int(np.random.choice(np.flatnonzero(self.table[obs] == self.table[obs].max())))

    def update(self, *, next_obs, obs, terminated, reward, action):
        lr, gamma, _ = self.settings
        goal = reward + gamma * self.table[next_obs].max() * (1 - terminated)
        self.table[obs, action] += lr * (goal - self.table[obs, action])
"""

OF_STYLE: Final = {
    "gymnasium": GYMNASIUM,
    "udacity": UDACITY,
    "berkeley": BERKELEY,
    "rl-glue": RL_GLUE,
    "function": FUNCTION,
}
OTHERS: Final = {
    "returning": RETURNING_FUNCTION,
    "sarsa": SARSA_FUNCTION,
    "given-the-environment": GIVEN_THE_ENVIRONMENT,
}
UPDATES: Final = {
    "gymnasium": "        self.q_values[obs][action] += self.lr * "
    "(reward + self.discount_factor * best_next - self.q_values[obs][action])",
    "udacity": "        self.Q[state][action] += self.alpha * "
    "(reward + self.gamma * best_next - self.Q[state][action])",
    "berkeley": "        self.qValues[(state, action)] = self.getQValue(state, action) + self.alpha * "
    "(reward + self.discount * best_next - self.getQValue(state, action))",
    "rl-glue": "        self.q[state, action] += self.step_size * "
    "(reward + self.discount * best_next - self.q[state, action])",
    "function": "    q[s, a] += alpha * (r + gamma * best_next - q[s, a])",
}
"""The missing line in the skeleton of each style."""


def agent_in(folder: Path, text: str, name: str = "mine.py") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path
