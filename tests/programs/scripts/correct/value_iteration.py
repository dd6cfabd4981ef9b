# expect: {"rule": "unknown", "alpha": null, "gamma": null}
# Value iteration with the model, then a few episodes with what came of it
import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1", is_slippery=True)
P = env.unwrapped.P
Q = np.zeros((16, 4))
for sweep in range(200):
    for s in range(16):
        for a in range(4):
            Q[s, a] = sum(p * (r + 0.99 * (not end) * Q[s2].max()) for p, s2, r, end in P[s][a])
for _ in range(50):
    s, _ = env.reset()
    done = False
    while not done:
        s, r, term, trunc, _ = env.step(int(Q[s].argmax()))
        done = term or trunc
