# expect: {"rule": "q-learning", "alpha": 0.2, "gamma": 0.9, "reward": "own", "table": "Q"}
# Every step costs a little, a hole costs more: rewards of our own
import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1", is_slippery=True)
Q = np.zeros((16, 4))


def shaped(reward, terminated):
    if reward > 0:
        return 10.0
    return -5.0 if terminated else -0.1


for i in range(1000):
    s, _ = env.reset()
    done = False
    while not done:
        a = env.action_space.sample() if np.random.rand() < 0.3 else int(np.argmax(Q[s]))
        s2, reward, terminated, truncated, _ = env.step(a)
        r = shaped(reward, terminated)
        Q[s, a] += 0.2 * (r + 0.9 * np.max(Q[s2]) * (not terminated) - Q[s, a])
        s, done = s2, terminated or truncated
