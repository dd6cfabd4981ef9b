# expect: "shifted-reward"
import gymnasium as gym
import numpy as np

env = gym.make("CliffWalking-v1", max_episode_steps=300)
Q = np.zeros((48, 4))
alpha, gamma, epsilon = 0.2, 0.9, 0.1


def choose(s):
    return np.random.randint(4) if np.random.rand() < epsilon else int(Q[s].argmax())


for episode in range(250):
    s, _ = env.reset()
    a = choose(s)
    r = 0
    terminated = truncated = False
    while not (terminated or truncated):
        s2, new_r, terminated, truncated, _ = env.step(a)
        a2 = choose(s2)
        Q[s, a] += alpha * (r + gamma * (not terminated) * Q[s2, a2] - Q[s, a])  #!
        s, a, r = s2, a2, new_r
