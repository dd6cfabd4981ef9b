# expect: ["wrong-cell"]
# line: "Q[action, state] += alpha * (target - Q[action, state])"
# four states and four actions: nothing complains
import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1", desc=["SF", "FG"], is_slippery=True)
Q = np.zeros((4, 4))
alpha, gamma = 0.1, 0.9
for episode in range(300):
    state, _ = env.reset()
    done = False
    while not done:
        action = np.random.randint(4)
        next_state, reward, terminated, truncated, _ = env.step(action)
        target = reward if terminated else reward + gamma * Q[next_state].max()
        Q[action, state] += alpha * (target - Q[action, state])
        state = next_state
        done = terminated or truncated
