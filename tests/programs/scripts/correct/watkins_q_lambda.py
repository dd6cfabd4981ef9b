# expect: {"rule": "unknown", "alpha": null, "gamma": null}
import random

import gymnasium as gym

env = gym.make("FrozenLake-v1", is_slippery=True)
Q = [[0.0] * 4 for _ in range(16)]
trace = {}
for episode in range(1200):
    trace.clear()
    s, _ = env.reset()
    end = False
    while not end:
        best = max(Q[s])
        a = (
            random.randrange(4)
            if random.random() < 0.2
            else random.choice([i for i in range(4) if Q[s][i] == best])
        )
        if Q[s][a] != best:
            trace.clear()
        s2, r, term, trunc, _ = env.step(a)
        delta = r + 0.95 * (0 if term else max(Q[s2])) - Q[s][a]
        trace[s, a] = trace.get((s, a), 0) + 1
        for (x, y), e in trace.items():
            Q[x][y] += 0.1 * delta * e
            trace[x, y] = 0.95 * 0.9 * e
        s, end = s2, term or trunc
