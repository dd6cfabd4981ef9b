# expect: ["step-size-out-of-range"]
# line: "Q[s, a] += alpha * (target - Q[s, a])"
import gymnasium as gym
import numpy as np

env = gym.make("CliffWalking-v1", max_episode_steps=100)
Q = np.zeros((48, 4))
alpha = 1.1
gamma = 0.9
for episode in range(60):
    s, _ = env.reset()
    terminated = truncated = False
    while not (terminated or truncated):
        a = env.action_space.sample()
        s2, r, terminated, truncated, _ = env.step(a)
        target = r if terminated else r + gamma * np.max(Q[s2])
        Q[s, a] += alpha * (target - Q[s, a])
        s = s2
