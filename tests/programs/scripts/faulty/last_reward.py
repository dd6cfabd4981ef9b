# expect: "shifted-reward"
import gymnasium as gym
import numpy as np

env = gym.make("CliffWalking-v1", max_episode_steps=300)
Q = np.zeros((48, 4))
alpha, gamma, epsilon = 0.1, 1.0, 0.1

for episode in range(100):
    state, _ = env.reset()
    reward = 0
    done = False
    while not done:
        action = env.action_space.sample() if np.random.rand() < epsilon else Q[state].argmax()
        next_state, new_reward, terminated, truncated, _ = env.step(action)
        Q[state, action] += alpha * (reward + gamma * Q[next_state].max() * (not terminated) - Q[state, action])  #!
        reward = new_reward
        state = next_state
        done = terminated or truncated
