# expect: "steps-after-end"
import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1", is_slippery=False)
dice = np.random.default_rng(3)
values = np.zeros((16, 4))

for episode in range(120):
    state, _ = env.reset()
    for _ in range(30):
        action = int(dice.integers(4))
        following, reward, ended, cut, _ = env.step(action)  #!
        future = 0.0 if ended else values[following].max()
        values[state, action] += 0.1 * (reward + 0.9 * future - values[state, action])
        state = following
