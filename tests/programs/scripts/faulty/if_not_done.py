# expect: ["loses-update"]
# line: "s_next, r, term, trunc, _ = env.step(a)"
import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1", is_slippery=False)
rng = np.random.default_rng(4)
Q = np.zeros((16, 4))
alpha, gamma = 0.1, 0.9

for _ in range(600):
    s, _ = env.reset()
    over = False
    while not over:
        a = int(rng.integers(4))
        s_next, r, term, trunc, _ = env.step(a)
        over = term or trunc
        if not over:
            Q[s, a] += alpha * (r + gamma * Q[s_next].max() - Q[s, a])
        s = s_next
