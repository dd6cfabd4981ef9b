# expect: {"rule": "monte-carlo", "alpha": null, "gamma": 1.0, "alpha_schedule": "1/N", "table": "Q"}
from collections import defaultdict

import gymnasium as gym
import numpy as np

env = gym.make("Blackjack-v1", natural=False, sab=True)
Q = defaultdict(lambda: np.zeros(2))
N = defaultdict(lambda: np.zeros(2))
gamma = 1.0


def run_episode(eps):
    episode = []
    obs, _ = env.reset()
    while True:
        a = np.random.randint(2) if np.random.rand() < eps else int(np.argmax(Q[obs]))
        nxt, r, term, trunc, _ = env.step(a)
        episode.append((obs, a, r))
        if term or trunc:
            return episode
        obs = nxt


for k in range(1500):
    G = 0.0
    for s, a, r in reversed(run_episode(0.2)):
        G = r + gamma * G
        N[s][a] += 1
        Q[s][a] += (G - Q[s][a]) / N[s][a]
