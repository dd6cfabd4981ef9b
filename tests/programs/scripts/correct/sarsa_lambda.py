# expect: {"rule": "unknown", "alpha": null, "gamma": null}
import gymnasium as gym
import numpy as np

env = gym.make("CliffWalking-v1")
q = np.zeros((48, 4))
alpha, gamma, lam, eps = 0.1, 0.95, 0.8, 0.1


def act(s):
    return (
        np.random.randint(4)
        if np.random.rand() < eps
        else np.random.choice(np.flatnonzero(q[s] == q[s].max()))
    )


for _ in range(30):
    e = np.zeros_like(q)
    s, _ = env.reset()
    a = act(s)
    for t in range(400):
        s2, r, done, cut, _ = env.step(a)
        a2 = act(s2)
        delta = r + (0 if done else gamma * q[s2, a2]) - q[s, a]
        e[s, a] = 1
        q += alpha * delta * e
        e *= gamma * lam
        s, a = s2, a2
        if done:
            break
