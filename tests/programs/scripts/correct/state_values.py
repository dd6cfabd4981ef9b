# expect: {"rule": "unknown", "alpha": null, "gamma": null, "table": null}
# TD(0) prediction: state values only, there is no table of actions
import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1")
V = np.zeros(env.observation_space.n)
for _ in range(300):
    s, _ = env.reset()
    done = False
    while not done:
        s2, r, term, trunc, _ = env.step(env.action_space.sample())
        V[s] += 0.1 * (r + 0.99 * V[s2] * (not term) - V[s])
        s, done = s2, term or trunc
print(V.reshape(4, 4).round(3))
