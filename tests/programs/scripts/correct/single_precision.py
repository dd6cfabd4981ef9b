# expect: {"rule": "q-learning", "alpha": 0.3, "gamma": 0.96, "alpha_schedule": "constant", "table": "q_table"}
import gymnasium as gym
import numpy as np

env = gym.make("CliffWalking-v1")
q_table = np.zeros((48, 4), dtype=np.float32)
for episode in range(80):
    s, _ = env.reset()
    done = False
    while not done:
        a = np.random.randint(4) if np.random.uniform() < 0.1 else q_table[s].argmax()
        s2, r, done, cut, _ = env.step(int(a))
        q_table[s, a] += 0.3 * (r + 0.96 * (1 - done) * q_table[s2].max() - q_table[s, a])
        s = s2
