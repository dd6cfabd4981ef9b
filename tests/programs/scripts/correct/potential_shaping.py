# expect: {"rule": "sarsa", "alpha": 0.1, "gamma": 0.99, "reward": "own", "table": "learner.q"}
import gymnasium as gym
import numpy as np


class Shaped(gym.Wrapper):
    """Adds γΦ(s′) − Φ(s), Φ being minus the distance to the goal."""

    def potential(self, s):
        return -(abs(3 - s // 12) + abs(11 - s % 12))

    def reset(self, **kwargs):
        self.s, info = self.env.reset(**kwargs)
        return self.s, info

    def step(self, action):
        s2, r, term, trunc, info = self.env.step(action)
        r += 0.99 * self.potential(s2) - self.potential(self.s)
        self.s = s2
        return s2, r, term, trunc, info


class Sarsa:
    def __init__(self):
        self.q = np.zeros((48, 4))

    def pick(self, s):
        return np.random.randint(4) if np.random.rand() < 0.15 else int(np.argmax(self.q[s]))


env = Shaped(gym.make("CliffWalking-v1"))
learner = Sarsa()
for _ in range(60):
    s, _ = env.reset()
    a = learner.pick(s)
    end = False
    while not end:
        s2, r, end, cut, _ = env.step(a)
        a2 = learner.pick(s2)
        value = 0.0 if end else learner.q[s2][a2]
        learner.q[s][a] += 0.1 * (r + 0.99 * value - learner.q[s][a])
        s, a = s2, a2
