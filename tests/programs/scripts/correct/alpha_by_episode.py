# expect: {"rule": "q-learning", "alpha": null, "gamma": 0.97, "alpha_schedule": "by-episode", "table": "Q"}
import gymnasium as gym
import numpy as np

env = gym.make("CliffWalking-v1")
Q = np.random.uniform(-0.01, 0.01, (48, 4))
Q[47] = 0
lr, lr_decay, discount = 0.8, 0.97, 0.97
for episode in range(80):
    state, _ = env.reset()
    terminated = False
    while not terminated:
        action = np.random.randint(4) if np.random.rand() < 0.1 else np.argmax(Q[state])
        new_state, reward, terminated, truncated, _ = env.step(action)
        future = 0 if terminated else np.max(Q[new_state])
        Q[state, action] = Q[state, action] * (1 - lr) + lr * (reward + discount * future)
        state = new_state
    lr = max(0.05, lr * lr_decay)
