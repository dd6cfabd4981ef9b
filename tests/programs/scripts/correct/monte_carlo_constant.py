# expect: {"rule": "monte-carlo", "alpha": 0.02, "gamma": 1.0, "alpha_schedule": "constant", "table": "self.Q"}
import gymnasium as gym
import numpy as np


class MonteCarlo:
    def __init__(self, alpha=0.02, gamma=1.0):
        self.env = gym.make("Blackjack-v1")
        self.Q = {}
        self.alpha, self.gamma = alpha, gamma

    def q(self, state):
        return self.Q.setdefault(state, [0.0, 0.0])

    def play(self, eps):
        path = []
        state, _ = self.env.reset()
        done = False
        while not done:
            row = self.q(state)
            action = np.random.randint(2) if np.random.random() < eps else row.index(max(row))
            new, reward, done, _, _ = self.env.step(action)
            path.append((state, action, reward))
            state = new
        return path

    def train(self, episodes):
        for i in range(episodes):
            path = self.play(max(0.1, 1 - i / episodes))
            rewards = [r for _, _, r in path]
            discounts = [self.gamma**k for k in range(len(path) + 1)]
            for i, (state, action, _) in enumerate(path):
                G = sum(d * r for d, r in zip(discounts, rewards[i:]))
                old = self.q(state)[action]
                self.Q[state][action] = old + self.alpha * (G - old)


MonteCarlo().train(1500)
