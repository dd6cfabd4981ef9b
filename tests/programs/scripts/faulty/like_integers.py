# expect: "rounding-table"
import gymnasium as gym
import numpy as np


def make_table(states, actions):
    counts = np.array([[0] * actions for _ in range(states)])
    q_values = np.zeros_like(counts)  #!
    return q_values


def main(alpha=0.3, gamma=0.95):
    env = gym.make("FrozenLake-v1", is_slippery=False)
    q_values = make_table(16, 4)
    for episode in range(1500):
        obs, _ = env.reset()
        done = False
        while not done:
            action = env.action_space.sample()
            next_obs, reward, terminated, truncated, _ = env.step(action)
            future = (not terminated) * np.max(q_values[next_obs])
            error = reward + gamma * future - q_values[obs, action]
            q_values[obs, action] += alpha * error
            obs = next_obs
            done = terminated or truncated


main()
