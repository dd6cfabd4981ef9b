# expect: ["rounding-table"]
# line: "Q = np.zeros((env.observation_space.n, env.action_space.n), dtype=int)"
import gymnasium as gym
import numpy as np

env = gym.make("CliffWalking-v1", max_episode_steps=200)
Q = np.zeros((env.observation_space.n, env.action_space.n), dtype=int)
alpha = 0.1
gamma = 0.9
epsilon = 0.1

for episode in range(50):
    state, info = env.reset()
    done = False
    while not done:
        if np.random.random() < epsilon:
            action = env.action_space.sample()
        else:
            action = np.argmax(Q[state])
        next_state, reward, terminated, truncated, info = env.step(action)
        future = 0 if terminated else np.max(Q[next_state])
        Q[state, action] = Q[state, action] + alpha * (reward + gamma * future - Q[state, action])
        state = next_state
        done = terminated or truncated
