# expect: "updates-after-moving"
# Taxi with dicts; the state is overwritten by env.step
import random

import gymnasium as gym

env = gym.make("Taxi-v3")
Q = {s: [0.0 for _ in range(6)] for s in range(500)}
eps = 0.3
for i in range(100):
    s = env.reset()[0]
    while True:
        a = random.randrange(6) if random.random() < eps else Q[s].index(max(Q[s]))
        s, r, done, cut, _ = env.step(a)
        Q[s][a] += 0.2 * (r + 0.95 * max(Q[s]) - Q[s][a])  #!
        if done or cut:
            break
