# expect: ["loses-update"]
# line: "next_state, reward, terminated, truncated, info = env.step(action)"
import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1", is_slippery=False)
Q = np.zeros((env.observation_space.n, env.action_space.n))
alpha, gamma = 0.1, 0.95

for episode in range(1500):
    state, info = env.reset()
    done = False
    while not done:
        action = env.action_space.sample()
        next_state, reward, terminated, truncated, info = env.step(action)
        target = reward if terminated else reward + gamma * np.max(Q[next_state])
        Q[state, action] == Q[state, action] + alpha * (target - Q[state, action])
        state = next_state
        done = terminated or truncated
