# expect: {"rule": "expected-sarsa", "alpha": 0.25, "gamma": 0.98, "epsilon": 0.15, "table": "agent.Q"}
import gymnasium as gym
import numpy as np


class ExpectedSarsa:
    def __init__(self, nS, nA, alpha=0.25, gamma=0.98, epsilon=0.15):
        self.Q = np.zeros((nS, nA))
        self.nA, self.alpha, self.gamma, self.epsilon = nA, alpha, gamma, epsilon

    def probs(self, s):
        p = np.full(self.nA, self.epsilon / self.nA)
        best = np.flatnonzero(self.Q[s] == self.Q[s].max())
        p[best] += (1 - self.epsilon) / len(best)
        return p

    def act(self, s):
        return np.random.choice(self.nA, p=self.probs(s))

    def learn(self, s, a, r, s2, terminal):
        expected = 0.0 if terminal else np.dot(self.probs(s2), self.Q[s2])
        self.Q[s, a] += self.alpha * (r + self.gamma * expected - self.Q[s, a])


env = gym.make("CliffWalking-v1")
agent = ExpectedSarsa(48, 4)
for ep in range(60):
    s, _ = env.reset()
    for t in range(500):
        a = agent.act(s)
        s2, r, term, trunc, _ = env.step(a)
        agent.learn(s, a, r, s2, term)
        s = s2
        if term:
            break
