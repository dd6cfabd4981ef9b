import math
import sys
from collections import deque

import numpy as np


def interact(env, agent, num_episodes=20000, window=100):
    """Let the agent act, and watch its average reward.

    Returns
    =======
    - avg_rewards: deque of average rewards
    - best_avg_reward: the largest of them
    - total_steps: how many steps were taken
    """
    avg_rewards = deque(maxlen=num_episodes)
    best_avg_reward = -math.inf
    samp_rewards = deque(maxlen=window)
    total_steps = 0
    for i_episode in range(1, num_episodes + 1):
        state, _ = env.reset()
        samp_reward = 0
        while True:
            action = agent.select_action(state)
            next_state, reward, terminated, truncated, _ = env.step(action)
            done = terminated or truncated
            agent.step(state, action, reward, next_state, done)
            samp_reward += reward
            total_steps += 1
            state = next_state
            if done:
                samp_rewards.append(samp_reward)
                break
        if i_episode >= 100:
            avg_reward = np.mean(samp_rewards)
            avg_rewards.append(avg_reward)
            if avg_reward > best_avg_reward:
                best_avg_reward = avg_reward
        print(f"\rEpisode {i_episode}/{num_episodes} || Best average reward {best_avg_reward}", end="")
        sys.stdout.flush()
        if best_avg_reward >= 9.7:
            print(f"\nEnvironment solved in {i_episode} episodes.", end="")
            break
        if i_episode == num_episodes:
            print("\n")
    return avg_rewards, best_avg_reward, total_steps
