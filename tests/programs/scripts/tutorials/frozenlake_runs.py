# expect: {"rule": "q-learning", "alpha": 0.8, "gamma": 0.95, "alpha_schedule": "constant", "table": "learner.qtable"}
"""Frozen Lake: several runs on one map, averaged and plotted at the end."""

from pathlib import Path
from typing import NamedTuple

import gymnasium as gym
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import seaborn as sns
from gymnasium.envs.toy_text.frozen_lake import generate_random_map
from tqdm import tqdm

sns.set_theme()


class Params(NamedTuple):
    total_episodes: int
    learning_rate: float
    gamma: float
    epsilon: float
    map_size: int
    seed: int
    is_slippery: bool
    n_runs: int
    action_size: int
    state_size: int
    proba_frozen: float
    savefig_folder: Path


params = Params(
    total_episodes=150,
    learning_rate=0.8,
    gamma=0.95,
    epsilon=0.1,
    map_size=4,
    seed=123,
    is_slippery=False,
    n_runs=3,
    action_size=None,
    state_size=None,
    proba_frozen=0.9,
    savefig_folder=Path("img"),
)
rng = np.random.default_rng(params.seed)
params.savefig_folder.mkdir(parents=True, exist_ok=True)

env = gym.make(
    "FrozenLake-v1",
    is_slippery=params.is_slippery,
    render_mode="rgb_array",
    desc=generate_random_map(size=params.map_size, p=params.proba_frozen, seed=params.seed),
)
params = params._replace(action_size=env.action_space.n)
params = params._replace(state_size=env.observation_space.n)
env.action_space.seed(params.seed)


class Qlearning:
    def __init__(self, learning_rate, gamma, state_size, action_size):
        self.state_size = state_size
        self.action_size = action_size
        self.learning_rate = learning_rate
        self.gamma = gamma
        self.reset_qtable()

    def update(self, state, action, reward, new_state):
        """Return the new value; whoever calls this stores it."""
        best_next = np.max(self.qtable[new_state, :])
        error = reward + self.gamma * best_next - self.qtable[state, action]
        return self.qtable[state, action] + self.learning_rate * error

    def reset_qtable(self):
        self.qtable = np.zeros((self.state_size, self.action_size))


class EpsilonGreedy:
    def __init__(self, epsilon):
        self.epsilon = epsilon

    def choose_action(self, action_space, state, qtable):
        if rng.uniform(0, 1) < self.epsilon:
            return action_space.sample()
        ids_of_best = np.where(qtable[state, :] == max(qtable[state, :]))[0]
        return rng.choice(ids_of_best)


learner = Qlearning(params.learning_rate, params.gamma, params.state_size, params.action_size)
explorer = EpsilonGreedy(epsilon=params.epsilon)


def run_env():
    rewards = np.zeros((params.total_episodes, params.n_runs))
    steps = np.zeros((params.total_episodes, params.n_runs))
    episodes = np.arange(params.total_episodes)
    qtables = np.zeros((params.n_runs, params.state_size, params.action_size))
    all_states = []
    all_actions = []

    for run in range(params.n_runs):
        learner.reset_qtable()
        for episode in tqdm(episodes, desc=f"Run {run}/{params.n_runs} - Episodes", leave=False):
            state = env.reset(seed=params.seed)[0]
            step = 0
            done = False
            total_rewards = 0
            while not done:
                action = explorer.choose_action(env.action_space, state=state, qtable=learner.qtable)
                all_states.append(state)
                all_actions.append(action)
                new_state, reward, terminated, truncated, info = env.step(action)
                done = terminated or truncated
                learner.qtable[state, action] = learner.update(state, action, reward, new_state)
                total_rewards += reward
                step += 1
                state = new_state
            rewards[episode, run] = total_rewards
            steps[episode, run] = step
        qtables[run, :, :] = learner.qtable
    return rewards, steps, episodes, qtables, all_states, all_actions


def postprocess(episodes, params, rewards, steps, map_size):
    res = pd.DataFrame(
        data={
            "Episodes": np.tile(episodes, reps=params.n_runs),
            "Rewards": rewards.flatten(order="F"),
            "Steps": steps.flatten(order="F"),
        }
    )
    res["cum_rewards"] = rewards.cumsum(axis=0).flatten(order="F")
    res["map_size"] = np.repeat(f"{map_size}x{map_size}", res.shape[0])
    return res


def plot_q_values_map(qtable, map_size):
    fig, ax = plt.subplots(nrows=1, ncols=2, figsize=(15, 5))
    ax[0].imshow(qtable)
    ax[0].set_title("Values")
    sns.heatmap(qtable.max(axis=1).reshape(map_size, map_size), annot=True, fmt=".2f", ax=ax[1])
    fig.savefig(params.savefig_folder / f"frozenlake_q_values_{map_size}.png", bbox_inches="tight")
    plt.show()


print(f"Map size: {params.map_size}x{params.map_size}")
rewards, steps, episodes, qtables, all_states, all_actions = run_env()
res = postprocess(episodes, params, rewards, steps, params.map_size)
qtable = qtables.mean(axis=0)
plot_q_values_map(qtable, params.map_size)
env.close()
np.save("table.npy", learner.qtable)
print(f"episodes: {rewards.size}, steps: {int(steps.sum())}")
