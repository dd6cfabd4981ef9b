# expect: {"rule": "q-learning", "alpha": 0.6, "gamma": 0.9, "alpha_schedule": "constant", "table": "Q"}
# The mean of three runs, each with a new table
import gymnasium as gym
import numpy as np

env = gym.make("CliffWalking-v1")
curves = []
for run in range(3):
    Q = np.zeros((48, 4))
    curve = []
    for episode in range(30):
        s, _ = env.reset()
        total, end = 0, False
        while not end:
            a = np.random.randint(4) if np.random.rand() < 0.1 else int(np.argmax(Q[s]))
            s2, r, end, cut, _ = env.step(a)
            Q[s, a] += 0.6 * (r + 0.9 * (0 if end else Q[s2].max()) - Q[s, a])
            s, total = s2, total + r
        curve.append(total)
    curves.append(curve)
print(np.mean(curves, axis=0))
