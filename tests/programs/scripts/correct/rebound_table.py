# expect: {"rule": "q-learning", "alpha": 0.1, "gamma": 0.99, "alpha_schedule": "constant", "table": "q"}
# Functional style: every update gives a new table
import gymnasium as gym
import numpy as np


def update(q, s, a, r, s2, end, alpha=0.1, gamma=0.99):
    q = q.copy()
    q[s, a] += alpha * (r + gamma * (0 if end else np.max(q[s2])) - q[s, a])
    return q


env = gym.make("CliffWalking-v1")
q = np.zeros((48, 4))
for episode in range(50):
    s, _ = env.reset()
    end = False
    while not end:
        a = np.random.randint(4) if np.random.rand() < 0.2 else int(q[s].argmax())
        s2, r, end, cut, _ = env.step(a)
        q = update(q, s, a, r, s2, end)
        s = s2
