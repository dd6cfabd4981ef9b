# expect: "gamma-twice"
import random
from collections import defaultdict

import gymnasium as gym


class Agent:
    def __init__(self, n_actions, lr=0.3, gamma=0.9, epsilon=0.2):
        self.n_actions, self.lr, self.gamma, self.epsilon = n_actions, lr, gamma, epsilon
        self.Q = defaultdict(lambda: [0.0] * n_actions)

    def policy(self, s):
        if random.random() < self.epsilon:
            return random.randrange(self.n_actions)
        best = max(self.Q[s])
        return random.choice([a for a in range(self.n_actions) if self.Q[s][a] == best])

    def update(self, s, a, r, s2, terminated):
        future = 0 if terminated else self.gamma * max(self.Q[s2])
        old = self.Q[s][a]
        self.Q[s][a] = old + self.lr * (r + self.gamma * future - old)  #!


env = gym.make("Taxi-v3")
agent = Agent(6)
for _ in range(120):
    s, _ = env.reset()
    while True:
        a = agent.policy(s)
        s2, r, terminated, truncated, _ = env.step(a)
        agent.update(s, a, r, s2, terminated)
        s = s2
        if terminated or truncated:
            break
