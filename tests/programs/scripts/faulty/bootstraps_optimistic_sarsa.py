# expect: "bootstraps-after-end"
"""SARSA on the cliff, with optimistic values for everything (the goal too)."""

import random

import gymnasium

ALPHA, GAMMA, EPSILON = 0.5, 0.9, 0.1


def choose(q, s):
    if random.random() < EPSILON:
        return random.randrange(4)
    return max(range(4), key=lambda a: (q[s][a], random.random()))


def main():
    env = gymnasium.make("CliffWalking-v1", max_episode_steps=300)
    q = [[5.0] * 4 for _ in range(48)]
    for _ in range(150):
        s, _ = env.reset()
        a = choose(q, s)
        while True:
            s2, r, terminated, truncated, _ = env.step(a)
            a2 = choose(q, s2)
            q[s][a] = q[s][a] + ALPHA * (r + GAMMA * q[s2][a2] - q[s][a])  #!
            s, a = s2, a2
            if terminated or truncated:
                break


if __name__ == "__main__":
    main()
