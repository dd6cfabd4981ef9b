# expect: ["wrong-cell"]
# line: "Q[s][0] += lr * (r + gamma * max(Q[s2]) * (not terminated) - Q[s][0])"
import random

import gymnasium as gym

env = gym.make("Taxi-v3")
Q = [[0.0] * 6 for _ in range(500)]
lr, gamma = 0.1, 0.95
for episode in range(40):
    s, _ = env.reset()
    done = False
    while not done:
        a = random.randrange(6)
        s2, r, terminated, truncated, _ = env.step(a)
        Q[s][0] += lr * (r + gamma * max(Q[s2]) * (not terminated) - Q[s][0])
        s = s2
        done = terminated or truncated
