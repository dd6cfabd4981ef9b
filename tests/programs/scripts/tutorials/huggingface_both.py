# expect: {"rule": "q-learning", "alpha": 0.7, "gamma": 0.95, "alpha_schedule": "constant", "table": "Qtable", "scenario": "frozenlake"}
# -*- coding: utf-8 -*-
"""The cells of a notebook, one below the other: Frozen Lake, and then the taxi."""

!pip install -r https://raw.githubusercontent.com/somebody/course/main/requirements.txt
%%capture
!sudo apt-get update
!apt install python3-opengl ffmpeg xvfb \
    cmake
!pip3 install pyvirtualdisplay

import os
import random

import gymnasium as gym
import imageio
import numpy as np
import pickle5 as pickle
import tqdm
from tqdm.notebook import tqdm

# FrozenLake

env = gym.make("FrozenLake-v1", map_name="4x4", is_slippery=False, render_mode="rgb_array")
print("_____OBSERVATION SPACE_____ \n")
print("Observation Space", env.observation_space)
print("Sample observation", env.observation_space.sample())
state_space = env.observation_space.n
action_space = env.action_space.n
print("There are ", state_space, " possible states and ", action_space, " possible actions")


def initialize_q_table(state_space, action_space):
    Qtable = np.zeros((state_space, action_space))
    return Qtable


Qtable_frozenlake = initialize_q_table(state_space, action_space)


def greedy_policy(Qtable, state):
    action = np.argmax(Qtable[state][:])
    return action


def epsilon_greedy_policy(Qtable, state, epsilon):
    random_num = random.uniform(0, 1)
    if random_num > epsilon:
        action = greedy_policy(Qtable, state)
    else:
        action = env.action_space.sample()
    return action


# Training parameters
n_training_episodes = 1200
learning_rate = 0.7

# Evaluation parameters
n_eval_episodes = 20

# Environment parameters
env_id = "FrozenLake-v1"
max_steps = 99
gamma = 0.95
eval_seed = []

# Exploration parameters
max_epsilon = 1.0
min_epsilon = 0.05
decay_rate = 0.0015

episodes_played = 0
steps_taken = 0


def train(n_training_episodes, min_epsilon, max_epsilon, decay_rate, env, max_steps, Qtable):
    global episodes_played, steps_taken
    for episode in tqdm(range(n_training_episodes)):
        epsilon = min_epsilon + (max_epsilon - min_epsilon) * np.exp(-decay_rate * episode)
        state, info = env.reset()
        step = 0
        terminated = False
        truncated = False
        episodes_played += 1
        for step in range(max_steps):
            action = epsilon_greedy_policy(Qtable, state, epsilon)
            new_state, reward, terminated, truncated, info = env.step(action)
            steps_taken += 1
            Qtable[state][action] = Qtable[state][action] + learning_rate * (
                reward + gamma * np.max(Qtable[new_state]) - Qtable[state][action]
            )
            if terminated or truncated:
                break
            state = new_state
    return Qtable


Qtable_frozenlake = train(
    n_training_episodes, min_epsilon, max_epsilon, decay_rate, env, max_steps, Qtable_frozenlake
)
Qtable_frozenlake


def evaluate_agent(env, max_steps, n_eval_episodes, Q, seed):
    global episodes_played, steps_taken
    episode_rewards = []
    for episode in tqdm(range(n_eval_episodes)):
        if seed:
            state, info = env.reset(seed=seed[episode])
        else:
            state, info = env.reset()
        episodes_played += 1
        total_rewards_ep = 0
        for step in range(max_steps):
            action = greedy_policy(Q, state)
            new_state, reward, terminated, truncated, info = env.step(action)
            steps_taken += 1
            total_rewards_ep += reward
            if terminated or truncated:
                break
            state = new_state
        episode_rewards.append(total_rewards_ep)
    return np.mean(episode_rewards), np.std(episode_rewards)


mean_reward, std_reward = evaluate_agent(env, max_steps, n_eval_episodes, Qtable_frozenlake, eval_seed)
print(f"Mean_reward={mean_reward:.2f} +/- {std_reward:.2f}")


# Taxi

env = gym.make("Taxi-v3", render_mode="rgb_array")
state_space = env.observation_space.n
action_space = env.action_space.n
Qtable_taxi = initialize_q_table(state_space, action_space)
n_training_episodes = 300
eval_seed = [16, 54, 165, 177, 191, 191, 120, 80, 149, 178]
Qtable_taxi = train(n_training_episodes, min_epsilon, max_epsilon, decay_rate, env, max_steps, Qtable_taxi)
mean_reward, std_reward = evaluate_agent(env, max_steps, len(eval_seed), Qtable_taxi, eval_seed)
print(f"Mean_reward={mean_reward:.2f} +/- {std_reward:.2f}")
np.save("table.npy", Qtable_taxi)
print(f"episodes: {episodes_played}, steps: {steps_taken}")
