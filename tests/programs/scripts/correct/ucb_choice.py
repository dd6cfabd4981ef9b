# expect: {"rule": "q-learning", "alpha": 0.2, "gamma": 0.95, "alpha_schedule": "constant", "table": "Q"}
import gymnasium as gym
import numpy as np

env = gym.make("CliffWalking-v1")
Q, counts = np.zeros((48, 4)), np.ones((48, 4))
for episode in range(40):
    s, _ = env.reset()
    for t in range(200):
        bonus = 2 * np.sqrt(np.log(counts[s].sum() + 1) / counts[s])
        a = int(np.argmax(Q[s] + bonus))
        s2, r, end, cut, _ = env.step(a)
        counts[s, a] += 1
        Q[s, a] += 0.2 * (r + 0.95 * Q[s2].max() - Q[s, a])
        if end:
            break
        s = s2
