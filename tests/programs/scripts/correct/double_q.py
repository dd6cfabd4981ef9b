# expect: {"rule": "double-q-learning", "alpha": 0.2, "gamma": 0.95, "table": "Q1"}
import random

import gymnasium as gym
import numpy as np

env = gym.make("CliffWalking-v1", max_episode_steps=300)
Q1 = np.zeros((48, 4))
Q2 = np.zeros((48, 4))
for i in range(100):
    s, _ = env.reset()
    done = cut = False
    while not (done or cut):
        total = Q1[s] + Q2[s]
        a = random.randrange(4) if random.random() < 0.1 else int(np.argmax(total))
        s2, r, done, cut, _ = env.step(a)
        if random.random() < 0.5:
            v = 0 if done else Q2[s2, np.argmax(Q1[s2])]
            Q1[s, a] += 0.2 * (r + 0.95 * v - Q1[s, a])
        else:
            v = 0 if done else Q1[s2, np.argmax(Q2[s2])]
            Q2[s, a] += 0.2 * (r + 0.95 * v - Q2[s, a])
        s = s2
