# expect: {"rule": "q-learning", "alpha": null, "gamma": 0.9, "alpha_schedule": "1/N", "table": "Q"}
import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1", map_name="4x4", is_slippery=True)
Q = np.zeros((16, 4))
N = np.zeros((16, 4))
rng = np.random.default_rng()
for _ in range(1500):
    s, _ = env.reset()
    done = False
    while not done:
        a = (
            int(rng.integers(4))
            if rng.random() < 0.3
            else int(rng.choice(np.flatnonzero(Q[s] == Q[s].max())))
        )
        s2, r, terminated, truncated, _ = env.step(a)
        N[s, a] += 1
        target = r + 0.9 * (0.0 if terminated else Q[s2].max())
        Q[s, a] += (target - Q[s, a]) / N[s, a]
        s = s2
        done = terminated or truncated
