# expect: ["shared-table"]
# line: "Q = [[0.0] * 4] * 16"
import random

import gymnasium as gym

env = gym.make("FrozenLake-v1", is_slippery=False)
Q = [[0.0] * 4] * 16
alpha, gamma = 0.1, 0.9
for episode in range(400):
    s, _ = env.reset()
    done = False
    while not done:
        a = random.randrange(4)
        s2, r, terminated, truncated, _ = env.step(a)
        target = r if terminated else r + gamma * max(Q[s2])
        Q[s][a] += alpha * (target - Q[s][a])
        s = s2
        done = terminated or truncated
