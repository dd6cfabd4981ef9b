# expect: ["bootstraps-after-end"]
# line: "Q[state, action] += alpha * (reward + gamma * np.max(Q[next_state]) - Q[state, action])"
import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1", is_slippery=True)
Q = np.random.rand(env.observation_space.n, env.action_space.n)

alpha = 0.1
gamma = 0.99
epsilon = 0.2

for episode in range(400):
    state, info = env.reset()
    done = False
    while not done:
        if np.random.random() < epsilon:
            action = env.action_space.sample()
        else:
            action = np.argmax(Q[state])
        next_state, reward, terminated, truncated, info = env.step(action)
        Q[state, action] += alpha * (reward + gamma * np.max(Q[next_state]) - Q[state, action])
        state = next_state
        done = terminated or truncated

print(Q)
