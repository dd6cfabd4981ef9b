# expect: {"rule": "unknown", "alpha": null, "gamma": null}
# The values are kept between -5 and 5: no plain update
import gymnasium as gym
import numpy as np

env = gym.make("CliffWalking-v1", max_episode_steps=200)
Q = np.zeros((48, 4))
for i in range(100):
    s, _ = env.reset()
    end = False
    cut = False
    while not (end or cut):
        a = np.random.randint(4) if np.random.rand() < 0.1 else int(np.argmax(Q[s]))
        s2, r, end, cut, _ = env.step(a)
        Q[s, a] = np.clip(Q[s, a] + 0.5 * (r + 0.99 * (not end) * Q[s2].max() - Q[s, a]), -5, 5)
        s = s2
