# expect: ["shared-table"]
# line: "Q = dict.fromkeys(range(48), np.zeros(4))"
import gymnasium as gym
import numpy as np

env = gym.make("CliffWalking-v1", max_episode_steps=200)
Q = dict.fromkeys(range(48), np.zeros(4))
alpha, gamma, epsilon = 0.5, 0.9, 0.1
for episode in range(60):
    s, _ = env.reset()
    terminated = truncated = False
    while not (terminated or truncated):
        a = np.random.randint(4) if np.random.rand() < epsilon else np.argmax(Q[s])
        s2, r, terminated, truncated, _ = env.step(a)
        Q[s][a] += alpha * (r + gamma * np.max(Q[s2]) * (1 - terminated) - Q[s][a])
        s = s2
