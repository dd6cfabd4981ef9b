# expect: {"rule": "unknown", "table": "q"}
"""Plays with a table of zeros, because training is switched off."""

import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1", is_slippery=False)
rng = np.random.default_rng(4)
q = np.zeros((16, 4))
training = False

for _ in range(600):
    s, _ = env.reset()
    done = False
    while not done:
        a = int(rng.integers(4))
        s2, r, terminated, truncated, _ = env.step(a)
        if training and not terminated:
            q[s, a] += 0.1 * (r + 0.9 * q[s2].max() - q[s, a])
        s, done = s2, terminated or truncated
