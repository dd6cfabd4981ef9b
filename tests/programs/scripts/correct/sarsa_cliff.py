# expect: {"rule": "sarsa", "alpha": 0.5, "gamma": 1.0, "alpha_schedule": "constant", "table": "Q"}
import gymnasium as gym
import numpy as np


def choose(Q, s, eps):
    if np.random.rand() < eps:
        return np.random.randint(Q.shape[1])
    return np.random.choice(np.flatnonzero(Q[s] == Q[s].max()))


def sarsa(env, episodes, alpha=0.5, gamma=1.0, eps=0.1):
    Q = np.zeros((env.observation_space.n, env.action_space.n))
    for _ in range(episodes):
        s, _ = env.reset()
        a = choose(Q, s, eps)
        done = False
        while not done:
            s2, r, done, truncated, _ = env.step(a)
            a2 = choose(Q, s2, eps)
            if done:
                Q[s, a] += alpha * (r - Q[s, a])
            else:
                Q[s, a] += alpha * (r + gamma * Q[s2, a2] - Q[s, a])
            s, a = s2, a2
            if truncated:
                break
    return Q


print(sarsa(gym.make("CliffWalking-v1"), 100).max(axis=1).reshape(4, 12).round(1))
