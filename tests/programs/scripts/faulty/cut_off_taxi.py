# expect: "no-bootstrap-after-truncation"
import gymnasium as gym
import numpy as np

learning_rate = 0.7
gamma = 0.95
max_epsilon, min_epsilon, decay_rate = 1.0, 0.05, 0.01

env = gym.make("Taxi-v3")
qtable = np.zeros((env.observation_space.n, env.action_space.n))


def epsilon_greedy_policy(table, state, epsilon):
    if np.random.uniform(0, 1) > epsilon:
        return np.argmax(table[state][:])
    return env.action_space.sample()


def train(n_episodes, max_steps):
    for episode in range(n_episodes):
        epsilon = min_epsilon + (max_epsilon - min_epsilon) * np.exp(-decay_rate * episode)
        state, info = env.reset()
        for step in range(max_steps):
            action = epsilon_greedy_policy(qtable, state, epsilon)
            new_state, reward, terminated, truncated, info = env.step(action)
            done = terminated or truncated
            delta = reward + (1 - done) * gamma * np.max(qtable[new_state]) - qtable[state][action]
            qtable[state][action] += learning_rate * delta  #!
            if done:
                break
            state = new_state


train(150, 500)
