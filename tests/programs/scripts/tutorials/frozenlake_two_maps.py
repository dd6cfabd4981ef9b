# expect: {"rule": "q-learning", "alpha": 0.8, "gamma": 0.95, "alpha_schedule": "constant", "table": "learner.qtable"}
"""Frozen Lake: an environment, a learner and a table for each of two sizes of the map."""

import gymnasium as gym
import numpy as np
from gymnasium.envs.toy_text.frozen_lake import generate_random_map
from tqdm import tqdm

try:
    import matplotlib.pyplot as plt
    import pandas as pd
    import seaborn as sns
except ImportError:
    plt = pd = sns = None

SEED = 123
TOTAL_EPISODES = 200
rng = np.random.default_rng(SEED)


class Qlearning:
    def __init__(self, learning_rate, gamma, state_size, action_size):
        self.learning_rate = learning_rate
        self.gamma = gamma
        self.qtable = np.zeros((state_size, action_size))

    def update(self, state, action, reward, new_state):
        delta = reward + self.gamma * np.max(self.qtable[new_state, :]) - self.qtable[state, action]
        return self.qtable[state, action] + self.learning_rate * delta


class EpsilonGreedy:
    def __init__(self, epsilon):
        self.epsilon = epsilon

    def choose_action(self, action_space, state, qtable):
        if rng.uniform(0, 1) < self.epsilon:
            return action_space.sample()
        return rng.choice(np.where(qtable[state, :] == qtable[state, :].max())[0])


res_all = []
total_steps = 0
map_sizes = [4, 7]
for map_size in map_sizes:
    env = gym.make(
        "FrozenLake-v1",
        is_slippery=False,
        render_mode="rgb_array",
        desc=generate_random_map(size=map_size, p=0.9, seed=SEED),
    )
    env.action_space.seed(SEED)
    learner = Qlearning(0.8, 0.95, env.observation_space.n, env.action_space.n)
    explorer = EpsilonGreedy(epsilon=0.1)
    rewards = np.zeros(TOTAL_EPISODES)
    print(f"Map size: {map_size}x{map_size}")
    for episode in tqdm(range(TOTAL_EPISODES)):
        state = env.reset(seed=SEED)[0]
        done = False
        while not done:
            action = explorer.choose_action(env.action_space, state, learner.qtable)
            new_state, reward, terminated, truncated, info = env.step(action)
            learner.qtable[state, action] = learner.update(state, action, reward, new_state)
            rewards[episode] += reward
            total_steps += 1
            done = terminated or truncated
            state = new_state
    res_all.append(rewards)
    env.close()

if plt is not None:
    frame = pd.DataFrame({f"{size}x{size}": each for size, each in zip(map_sizes, res_all)})
    sns.lineplot(data=frame.cumsum())
    plt.show()
np.save("table.npy", learner.qtable)
print(f"episodes: {TOTAL_EPISODES * len(map_sizes)}, steps: {total_steps}")
