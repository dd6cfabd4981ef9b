# expect: {"rule": "monte-carlo", "alpha": null, "gamma": 0.9, "alpha_schedule": "1/N", "table": "q_values"}
import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1", is_slippery=False)
rng = np.random.default_rng()
q_values = np.zeros((16, 4))
returns = {(s, a): [] for s in range(16) for a in range(4)}

for episode in range(800):
    trajectory = []
    s, _ = env.reset()
    done = False
    while not done:
        greedy = rng.choice(np.flatnonzero(q_values[s] == q_values[s].max()))
        a = int(rng.integers(4)) if rng.random() < 0.4 else int(greedy)
        s2, r, term, trunc, _ = env.step(a)
        trajectory.append((s, a, r))
        s, done = s2, term or trunc
    G = 0
    pairs = [(s, a) for s, a, _ in trajectory]
    for t in range(len(trajectory) - 1, -1, -1):
        G = trajectory[t][2] + 0.9 * G
        if pairs[t] not in pairs[:t]:
            returns[pairs[t]].append(G)
            q_values[pairs[t]] = np.mean(returns[pairs[t]])
