# expect: {"rule": "unknown"}
"""Real-time dynamic programming: backs up the cell of the action that it takes next, from the known table."""

import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1", is_slippery=False)
rng = np.random.default_rng(4)
q = np.ones((16, 4))
model = env.unwrapped.P

for _ in range(200):
    s, _ = env.reset()
    done = False
    while not done:
        a = int(rng.choice(np.flatnonzero(q[s] == q[s].max())))
        q[s, a] = sum(p * (r + 0.9 * q[s2].max() * (not end)) for p, s2, r, end in model[s][a])
        s, _, terminated, truncated, _ = env.step(a)
        done = terminated or truncated
