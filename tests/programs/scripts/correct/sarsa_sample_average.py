# expect: {"rule": "sarsa", "alpha": null, "gamma": 0.95, "alpha_schedule": "1/N", "table": "Q"}
"""SARSA with a step size of one over the visits, Q and visits in dicts of pairs."""

import random

import gymnasium as gym

env = gym.make("CliffWalking-v1")
Q, visits = {}, {}
actions = range(4)


def q(s, a):
    return Q.get((s, a), 0.0)


def pick(s):
    if random.random() < 0.2:
        return random.choice(list(actions))
    best = max(q(s, a) for a in actions)
    return random.choice([a for a in actions if q(s, a) == best])


for episode in range(40):
    s, _ = env.reset()
    a = pick(s)
    for step in range(300):
        s2, r, end, cut, _ = env.step(a)
        a2 = pick(s2)
        visits[s, a] = visits.get((s, a), 0) + 1
        Q[s, a] = q(s, a) + (r + (0 if end else 0.95 * q(s2, a2)) - q(s, a)) / visits[s, a]
        s, a = s2, a2
        if end:
            break
