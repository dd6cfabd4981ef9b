# expect: {"rule": "sarsa", "alpha": 0.2, "gamma": 0.9, "alpha_schedule": "constant", "table": "agent.Q"}
# SARSA that learns about a step when the next one was made: s, a, r, s', a'
import gymnasium as gym
import numpy as np


class Agent:
    def __init__(self):
        self.Q = np.zeros((48, 4))
        self.last = None

    def policy(self, s):
        return np.random.randint(4) if np.random.rand() < 0.15 else int(np.argmax(self.Q[s]))

    def observe(self, s, a, r, s2, terminal):
        if self.last is not None:
            ps, pa, pr = self.last
            self.Q[ps, pa] += 0.2 * (pr + 0.9 * self.Q[s, a] - self.Q[ps, pa])
        self.last = (s, a, r)
        if terminal:
            self.Q[s, a] += 0.2 * (r - self.Q[s, a])
            self.last = None


env, agent = gym.make("CliffWalking-v1"), Agent()
for _ in range(60):
    s, _ = env.reset()
    agent.last = None
    done = False
    while not done:
        a = agent.policy(s)
        s2, r, done, cut, _ = env.step(a)
        agent.observe(s, a, r, s2, done)
        s = s2
