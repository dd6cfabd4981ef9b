# expect: {"rule": "q-learning", "alpha": 0.1, "gamma": 0.9, "alpha_schedule": "constant", "table": "Q"}
# Optimistic values in lists of lists, greedy among random ties, a little exploration
import random

import gymnasium as gym

env = gym.make("FrozenLake-v1", is_slippery=False)
Q = [[1.0 for _ in range(4)] for _ in range(16)]
for episode in range(600):
    s, _ = env.reset()
    terminated = truncated = False
    while not (terminated or truncated):
        if random.random() < 0.1:
            a = random.randint(0, 3)
        else:
            a = random.choice([i for i, q in enumerate(Q[s]) if q == max(Q[s])])
        s2, r, terminated, truncated, _ = env.step(a)
        if terminated:
            Q[s][a] += 0.1 * (r - Q[s][a])
        else:
            Q[s][a] += 0.1 * (r + 0.9 * max(Q[s2]) - Q[s][a])
        s = s2
