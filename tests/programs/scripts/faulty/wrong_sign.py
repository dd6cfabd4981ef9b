# expect: ["step-size-out-of-range"]
# line: "q_table[state, action] -= alpha * (target - q_table[state, action])"
import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1", is_slippery=False)
q_table = np.zeros((16, 4))
alpha, gamma = 0.05, 0.9

for episode in range(2000):
    state, _ = env.reset()
    done = False
    while not done:
        action = np.random.randint(4)
        new_state, reward, terminated, truncated, _ = env.step(action)
        target = reward + gamma * np.max(q_table[new_state]) * (1 - int(terminated))
        q_table[state, action] -= alpha * (target - q_table[state, action])
        state = new_state
        done = terminated or truncated
