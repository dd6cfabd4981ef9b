# expect: {"rule": "q-learning", "alpha": 0.9, "gamma": 0.9, "alpha_schedule": "constant", "table": "q", "scenario": "taxi"}
"""Taxi: a run that trains and saves its table, and one that loads it and only plays."""

import argparse
import pickle

import gymnasium as gym
import matplotlib.pyplot as plt
import numpy as np

TABLE = "taxi.pkl"


def run(episodes, is_training=True, render=False):
    env = gym.make("Taxi-v3", render_mode="human" if render else None)
    if is_training:
        q = np.zeros((env.observation_space.n, env.action_space.n))  # 500 x 6
    else:
        with open(TABLE, "rb") as f:
            q = pickle.load(f)

    learning_rate_a = 0.9
    discount_factor_g = 0.9
    epsilon = 1
    epsilon_decay_rate = 1 / (0.8 * episodes)
    rng = np.random.default_rng()
    rewards_per_episode = np.zeros(episodes)
    steps = 0

    for i in range(episodes):
        state = env.reset()[0]
        terminated = False
        truncated = False
        rewards = 0
        while not terminated and not truncated:
            if is_training and rng.random() < epsilon:
                action = env.action_space.sample()
            else:
                action = np.argmax(q[state, :])
            new_state, reward, terminated, truncated, _ = env.step(action)
            steps += 1
            rewards += reward
            if is_training:
                q[state, action] = q[state, action] + learning_rate_a * (
                    reward + discount_factor_g * np.max(q[new_state, :]) - q[state, action]
                )
            state = new_state
        epsilon = max(epsilon - epsilon_decay_rate, 0)
        rewards_per_episode[i] = rewards

    env.close()
    if is_training:
        sum_rewards = np.zeros(episodes)
        for t in range(episodes):
            sum_rewards[t] = np.sum(rewards_per_episode[max(0, t - 100) : (t + 1)])
        plt.plot(sum_rewards)
        plt.savefig("taxi.png")
        with open(TABLE, "wb") as f:
            pickle.dump(q, f)
    return steps


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Train a taxi, and let it drive.")
    parser.add_argument("--episodes", type=int, default=400)
    parser.add_argument("--test-episodes", type=int, default=5)
    parser.add_argument("--render", action="store_true")
    args = parser.parse_args()
    steps = run(args.episodes)
    steps += run(args.test_episodes, is_training=False, render=args.render)
    print(f"episodes: {args.episodes + args.test_episodes}, steps: {steps}")
