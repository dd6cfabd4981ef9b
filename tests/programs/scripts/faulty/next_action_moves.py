# expect: "wrong-cell"
# SARSA in which the action is overwritten too early
import gymnasium as gym
import numpy as np

env = gym.make("CliffWalking-v1", max_episode_steps=200)
Q = np.zeros((48, 4))
alpha, gamma, epsilon = 0.2, 0.9, 0.2


def pick(s):
    if np.random.rand() < epsilon:
        return np.random.randint(4)
    return int(np.argmax(Q[s]))


for episode in range(100):
    s, _ = env.reset()
    a = pick(s)
    done = False
    while not done:
        s2, r, terminated, truncated, _ = env.step(a)
        a = pick(s2)
        target = r if terminated else r + gamma * Q[s2, a]
        Q[s, a] += alpha * (target - Q[s, a])  #!
        s = s2
        done = terminated or truncated
