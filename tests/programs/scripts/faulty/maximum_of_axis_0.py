# expect: "wrong-axis"
import argparse

import gymnasium as gym
import numpy as np

parser = argparse.ArgumentParser()
parser.add_argument("--episodes", type=int, default=1500)
args = parser.parse_args()

LEARNING_RATE = 0.25
DISCOUNT = 0.97


def learn(env, values, episodes):
    for _ in range(episodes):
        s, _ = env.reset()
        over = False
        while not over:
            a = env.action_space.sample()
            s_next, r, term, trunc, _ = env.step(a)
            target = r if term else r + DISCOUNT * values.max(axis=0)[a]
            values[s, a] = (1 - LEARNING_RATE) * values[s, a] + LEARNING_RATE * target  #!
            s = s_next
            over = term or trunc
    return values


world = gym.make("FrozenLake-v1", is_slippery=True)
table = learn(world, np.zeros((16, 4)), args.episodes)
