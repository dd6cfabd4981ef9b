# expect: {"rule": "q-learning", "alpha": 0.01, "gamma": 0.95, "alpha_schedule": "constant", "table": "agent.q_values"}
from collections import defaultdict

import gymnasium as gym
import numpy as np


class BlackjackAgent:
    def __init__(
        self, env, learning_rate, initial_epsilon, epsilon_decay, final_epsilon, discount_factor=0.95
    ):
        self.env = env
        self.q_values = defaultdict(lambda: np.zeros(env.action_space.n))
        self.lr = learning_rate
        self.discount_factor = discount_factor
        self.epsilon = initial_epsilon
        self.epsilon_decay = epsilon_decay
        self.final_epsilon = final_epsilon
        self.training_error = []

    def get_action(self, obs):
        if np.random.random() < self.epsilon:
            return self.env.action_space.sample()
        return int(np.argmax(self.q_values[obs]))

    def update(self, obs, action, reward, terminated, next_obs):
        future_q_value = (not terminated) * np.max(self.q_values[next_obs])
        target = reward + self.discount_factor * future_q_value
        temporal_difference = target - self.q_values[obs][action]
        self.q_values[obs][action] = self.q_values[obs][action] + self.lr * temporal_difference
        self.training_error.append(temporal_difference)

    def decay_epsilon(self):
        self.epsilon = max(self.final_epsilon, self.epsilon - self.epsilon_decay)


n_episodes = 1500
env = gym.make("Blackjack-v1", sab=False)
agent = BlackjackAgent(env, 0.01, 1.0, 1.0 / (n_episodes / 2), 0.1)
for episode in range(n_episodes):
    obs, info = env.reset()
    done = False
    while not done:
        action = agent.get_action(obs)
        next_obs, reward, terminated, truncated, info = env.step(action)
        agent.update(obs, action, reward, terminated, next_obs)
        done = terminated or truncated
        obs = next_obs
    agent.decay_epsilon()
