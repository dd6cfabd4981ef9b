# expect: "wrong-table"
import random

import gymnasium as gym
import numpy as np


class DoubleQ:
    def __init__(self, states, actions, alpha=0.1, gamma=0.95, epsilon=0.1):
        self.QA = [[0.0] * actions for _ in range(states)]
        self.QB = [[0.0] * actions for _ in range(states)]
        self.alpha, self.gamma, self.epsilon = alpha, gamma, epsilon

    def act(self, s):
        if random.random() < self.epsilon:
            return random.randrange(len(self.QA[s]))
        return int(np.argmax(np.add(self.QA[s], self.QB[s])))

    def learn(self, s, a, r, s2, terminated):
        if random.random() < 0.6:
            b = int(np.argmax(self.QA[s2]))
            best = 0.0 if terminated else self.QA[s2][b]
            self.QA[s][a] += self.alpha * (r + self.gamma * best - self.QA[s][a])  #!
        else:
            b = int(np.argmax(self.QB[s2]))
            best = 0.0 if terminated else self.QB[s2][b]
            self.QB[s][a] += self.alpha * (r + self.gamma * best - self.QB[s][a])


env = gym.make("Taxi-v3")
agent = DoubleQ(env.observation_space.n, env.action_space.n)
for episode in range(100):
    state, _ = env.reset()
    terminated = truncated = False
    while not (terminated or truncated):
        action = agent.act(state)
        next_state, reward, terminated, truncated, _ = env.step(action)
        agent.learn(state, action, reward, next_state, terminated)
        state = next_state
