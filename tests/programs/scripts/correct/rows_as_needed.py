# expect: {"rule": "q-learning", "alpha": 0.25, "gamma": 0.9, "alpha_schedule": "constant", "table": "Q"}
# A dict whose rows are made, with small random numbers, when a state is seen for the first time
import random

import gymnasium as gym

env = gym.make("Taxi-v4")
Q = {}


def row(s):
    if s not in Q:
        Q[s] = [random.uniform(0, 0.001) for _ in range(6)]
    return Q[s]


for episode in range(40):
    s, _ = env.reset()
    done = False
    while not done:
        a = random.randrange(6) if random.random() < 0.1 else row(s).index(max(row(s)))
        s2, r, term, trunc, _ = env.step(a)
        best = 0 if term else max(row(s2))
        row(s)[a] += 0.25 * (r + 0.9 * best - row(s)[a])
        s = s2
        done = term or trunc
