# expect: {"rule": "q-learning", "alpha": 0.3, "gamma": 0.9, "alpha_schedule": "constant", "table": "Q"}
# A short time limit: what was cut off still bootstraps, only a terminal state does not
import gymnasium as gym
import numpy as np

env = gym.make("CliffWalking-v1", max_episode_steps=30)
Q = np.full((48, 4), -1.0)
for episode in range(100):
    s, _ = env.reset()
    while True:
        a = np.random.randint(4) if np.random.rand() < 0.2 else int(np.argmax(Q[s]))
        s2, r, terminated, truncated, _ = env.step(a)
        target = r + 0.9 * np.max(Q[s2]) * (1 - terminated)
        Q[s, a] += 0.3 * (target - Q[s, a])
        s = s2
        if terminated or truncated:
            break
