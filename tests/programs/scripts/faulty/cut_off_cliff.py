# expect: ["no-bootstrap-after-truncation"]
# line: "Q[s, a] = Q[s, a] + lr * (target - Q[s, a])"
import gymnasium as gym
import numpy as np

rng = np.random.default_rng()
env = gym.make("CliffWalking-v1", max_episode_steps=40)
Q = np.zeros((48, 4))
lr, gamma, eps = 0.2, 0.95, 0.1

for ep in range(300):
    s, _ = env.reset()
    done = False
    while not done:
        a = int(rng.integers(4)) if rng.random() < eps else int(Q[s].argmax())
        s2, r, terminated, truncated, _ = env.step(a)
        done = terminated or truncated
        if done:
            target = r
        else:
            target = r + gamma * Q[s2].max()
        Q[s, a] = Q[s, a] + lr * (target - Q[s, a])
        s = s2
