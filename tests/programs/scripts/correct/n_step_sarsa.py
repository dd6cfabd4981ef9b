# expect: {"rule": "unknown", "alpha": null, "gamma": null}
# n-step SARSA after the book's box
import gymnasium as gym
import numpy as np

n, alpha, gamma, eps = 3, 0.2, 0.95, 0.1
env = gym.make("CliffWalking-v1")
Q = np.zeros((48, 4))
rng = np.random.default_rng()


def policy(s):
    return int(rng.integers(4)) if rng.random() < eps else int(rng.choice(np.flatnonzero(Q[s] == Q[s].max())))


for episode in range(40):
    s, _ = env.reset()
    S, A, R = [s], [policy(s)], [0]
    T, t = float("inf"), 0
    while True:
        if t < T:
            s, r, end, cut, _ = env.step(A[t])
            S.append(s)
            R.append(r)
            if end:
                T = t + 1
            else:
                A.append(policy(s))
        tau = t - n + 1
        if tau >= 0:
            G = sum(gamma ** (i - tau - 1) * R[i] for i in range(tau + 1, min(tau + n, T) + 1))
            if tau + n < T:
                G += gamma**n * Q[S[tau + n], A[tau + n]]
            Q[S[tau], A[tau]] += alpha * (G - Q[S[tau], A[tau]])
        if tau == T - 1:
            break
        t += 1
