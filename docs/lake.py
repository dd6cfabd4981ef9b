"""Q-learning as many write it at first, with one line in the wrong place: rl-tui watch --example"""

import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1", is_slippery=False)
q = np.zeros((env.observation_space.n, env.action_space.n))
alpha, gamma, epsilon = 0.1, 0.99, 0.2

for _ in range(2_000):
    state, _ = env.reset()
    done = False
    while not done:
        if np.random.random() < epsilon:
            action = env.action_space.sample()
        else:
            action = int(np.random.choice(np.flatnonzero(q[state] == q[state].max())))
        next_state, reward, terminated, truncated, _ = env.step(action)
        done = terminated or truncated
        state = next_state
        target = reward + gamma * np.max(q[next_state]) * (not terminated)
        q[state, action] += alpha * (target - q[state, action])
