# expect: {"rule": "q-learning", "alpha": 0.7, "gamma": 0.95, "alpha_schedule": "constant", "table": "qtable"}
"""Functions, as in a well-known course: a table, two policies, train, then evaluate without learning."""

import random

import gymnasium as gym
import numpy as np

EPISODES = 1500
EVALUATION = 30


def initialize_q_table(state_space, action_space):
    return np.zeros((state_space, action_space))


def greedy_policy(qtable, state):
    return np.argmax(qtable[state][:])


def epsilon_greedy_policy(qtable, state, epsilon, env):
    if random.uniform(0, 1) > epsilon:
        return greedy_policy(qtable, state)
    return env.action_space.sample()


def train(episodes, env, qtable, learning_rate=0.7, gamma=0.95, max_steps=99):
    for episode in range(episodes):
        epsilon = 0.05 + 0.95 * np.exp(-0.0005 * episode)
        state, info = env.reset()
        for step in range(max_steps):
            action = epsilon_greedy_policy(qtable, state, epsilon, env)
            new_state, reward, terminated, truncated, info = env.step(action)
            qtable[state][action] = qtable[state][action] + learning_rate * (
                reward + gamma * np.max(qtable[new_state]) - qtable[state][action]
            )
            if terminated or truncated:
                break
            state = new_state
    return qtable


def evaluate(env, qtable, episodes):
    rewards = []
    for _ in range(episodes):
        state, info = env.reset()
        total = 0
        done = False
        while not done:
            state, reward, terminated, truncated, info = env.step(greedy_policy(qtable, state))
            total += reward
            done = terminated or truncated
        rewards.append(total)
    return np.mean(rewards), np.std(rewards)


env = gym.make("FrozenLake-v1", map_name="4x4", is_slippery=False)
qtable = initialize_q_table(env.observation_space.n, env.action_space.n)
qtable = train(EPISODES, env, qtable)
print(evaluate(env, qtable, EVALUATION))
