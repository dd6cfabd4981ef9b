# expect: ["loses-update"]
# line: "s2, r, terminated, truncated, _ = env.step(a)"
import copy

import gymnasium as gym
import numpy as np


def update(q, s, a, r, s2, terminated, alpha=0.1, gamma=0.9):
    q = copy.deepcopy(q)
    target = r + (0 if terminated else gamma * max(q[s2]))
    q[s][a] += alpha * (target - q[s][a])
    return q


env = gym.make("CliffWalking-v1", max_episode_steps=50)
q_table = np.zeros((48, 4))
for episode in range(40):
    s, _ = env.reset()
    terminated = truncated = False
    while not (terminated or truncated):
        a = np.random.randint(4)
        s2, r, terminated, truncated, _ = env.step(a)
        update(q_table, s, a, r, s2, terminated)
        s = s2
