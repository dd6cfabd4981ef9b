# expect: {"rule": "unknown", "alpha": null, "gamma": null}
import random

import gymnasium as gym
import numpy as np

env = gym.make("CliffWalking-v1")
Q = np.zeros((48, 4))
model = {}
for episode in range(12):
    s, _ = env.reset()
    done = False
    while not done:
        a = env.action_space.sample() if random.random() < 0.1 else int(np.argmax(Q[s]))
        s2, r, done, cut, _ = env.step(a)
        Q[s, a] += 0.5 * (r + 0.95 * (0 if done else Q[s2].max()) - Q[s, a])
        model[s, a] = (r, s2, done)
        for _ in range(5):
            (ms, ma), (mr, ms2, md) = random.choice(list(model.items()))
            Q[ms, ma] += 0.5 * (mr + 0.95 * (0 if md else Q[ms2].max()) - Q[ms, ma])
        s = s2
