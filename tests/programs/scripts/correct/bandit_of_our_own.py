# expect: {"rule": "unknown", "alpha": null, "gamma": null}
# A bandit as an environment of our own: one state, every episode is one step
import gymnasium as gym
import numpy as np


class Bandit(gym.Env):
    observation_space = gym.spaces.Discrete(1)
    action_space = gym.spaces.Discrete(5)

    def __init__(self):
        self.means = np.linspace(-1, 1, 5)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return 0, {}

    def step(self, action):
        return 0, float(self.np_random.normal(self.means[action])), True, False, {}


gym.register("OurBandit-v0", entry_point=Bandit)
env = gym.make("OurBandit-v0")
Q, N = np.zeros((1, 5)), np.zeros((1, 5))
for t in range(1500):
    env.reset()
    a = np.random.randint(5) if np.random.rand() < 0.1 else int(np.argmax(Q[0]))
    _, r, *_ = env.step(a)
    N[0, a] += 1
    Q[0, a] += (r - Q[0, a]) / N[0, a]
