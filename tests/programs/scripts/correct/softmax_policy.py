# expect: {"rule": "q-learning", "alpha": 0.15, "gamma": 0.9, "alpha_schedule": "constant", "table": "Q"}
import gymnasium as gym
import numpy as np

EPISODES = 1200


def softmax(x, temperature):
    z = np.exp((x - x.max()) / temperature)
    return z / z.sum()


def train():
    env = gym.make("FrozenLake-v1", is_slippery=True)
    Q = {s: np.zeros(4) for s in range(16)}
    for n in range(EPISODES):
        s = env.reset()[0]
        while True:
            a = np.random.choice(4, p=softmax(Q[s], 0.1))
            s2, r, term, trunc, _ = env.step(a)
            Q[s][a] += 0.15 * (r + (0.9 * Q[s2].max() if not term else 0) - Q[s][a])
            s = s2
            if term or trunc:
                break
    return Q


if __name__ == "__main__":
    print(max(row.max() for row in train().values()))
