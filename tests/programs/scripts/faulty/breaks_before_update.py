# expect: ["loses-update"]
# line: "s2, r, terminated, truncated, _ = env.step(a)"
import gymnasium as gym
import numpy as np

env = gym.make("CliffWalking-v1", max_episode_steps=500)
Q = np.zeros((48, 4))
alpha, gamma, epsilon = 0.5, 0.9, 0.1

for episode in range(100):
    s, _ = env.reset()
    while True:
        if np.random.rand() < epsilon:
            a = np.random.randint(4)
        else:
            a = int(np.argmax(Q[s]))
        s2, r, terminated, truncated, _ = env.step(a)
        if terminated or truncated:
            break
        Q[s, a] += alpha * (r + gamma * np.max(Q[s2]) - Q[s, a])
        s = s2
