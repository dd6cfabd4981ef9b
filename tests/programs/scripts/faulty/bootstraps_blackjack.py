# expect: "bootstraps-after-end"
from collections import defaultdict

import gymnasium as gym
import numpy as np


class BlackjackAgent:
    def __init__(self, env, learning_rate=0.05, discount_factor=0.95, epsilon=0.3):
        self.env = env
        self.q = defaultdict(lambda: np.zeros(env.action_space.n))
        self.lr = learning_rate
        self.discount_factor = discount_factor
        self.epsilon = epsilon

    def get_action(self, obs):
        if np.random.random() < self.epsilon:
            return self.env.action_space.sample()
        return int(np.argmax(self.q[obs]))

    def update(self, obs, action, reward, next_obs):
        target = reward + self.discount_factor * np.max(self.q[next_obs])
        self.q[obs][action] += self.lr * (target - self.q[obs][action])  #!


env = gym.make("Blackjack-v1", sab=True)
agent = BlackjackAgent(env)
for episode in range(4000):
    obs, info = env.reset()
    done = False
    while not done:
        action = agent.get_action(obs)
        next_obs, reward, terminated, truncated, info = env.step(action)
        agent.update(obs, action, reward, next_obs)
        done = terminated or truncated
        obs = next_obs
