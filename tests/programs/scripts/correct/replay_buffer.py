# expect: {"rule": "unknown", "alpha": null, "gamma": null}
import random
from collections import deque

import gymnasium as gym
import numpy as np

BATCH = 8
env = gym.make("FrozenLake-v1", is_slippery=False)
table = np.zeros((16, 4))
buffer = deque(maxlen=2000)
for episode in range(300):
    obs, _ = env.reset()
    while True:
        action = env.action_space.sample() if random.random() < 0.9 else int(table[obs].argmax())
        nxt, reward, terminated, truncated, _ = env.step(action)
        buffer.append((obs, action, reward, nxt, terminated))
        if len(buffer) >= BATCH:
            for s, a, r, s2, d in random.sample(buffer, BATCH):
                table[s, a] += 0.1 * (r + 0.99 * (1 - d) * table[s2].max() - table[s, a])
        obs = nxt
        if terminated or truncated:
            break
