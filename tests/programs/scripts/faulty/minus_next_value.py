# expect: "wrong-formula"
import random

import gymnasium as gym

env = gym.make("CliffWalking-v1")
q = [[0.0] * 4 for _ in range(48)]
alpha, gamma, epsilon = 0.25, 0.95, 0.2


def choose(s):
    if random.random() < epsilon:
        return random.randrange(4)
    best = max(q[s])
    return random.choice([a for a in range(4) if q[s][a] == best])


for _ in range(100):
    s, _ = env.reset()
    a = choose(s)
    for _ in range(200):
        s2, r, terminated, truncated, _ = env.step(a)
        a2 = choose(s2)
        future = 0.0 if terminated else q[s2][a2]
        q[s][a] += alpha * (r + gamma - future - q[s][a])  #!
        s, a = s2, a2
        if terminated or truncated:
            break
