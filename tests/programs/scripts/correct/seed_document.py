# expect: {"rule": "q-learning", "alpha": 0.1, "gamma": 0.99, "alpha_schedule": "constant", "table": "Q"}
import gymnasium as gym
import numpy as np

EPISODES = 1500
env = gym.make("FrozenLake-v1", is_slippery=True)
Q = np.zeros((env.observation_space.n, env.action_space.n))
alpha = 0.1
gamma = 0.99
epsilon = 1.0

for episode in range(EPISODES):
    state, info = env.reset()
    done = False
    while not done:
        if np.random.random() < epsilon:
            action = env.action_space.sample()
        else:
            action = np.argmax(Q[state])
        next_state, reward, terminated, truncated, info = env.step(action)
        best = 0 if terminated else np.max(Q[next_state])
        Q[state, action] += alpha * (reward + gamma * best - Q[state, action])
        state = next_state
        done = terminated or truncated
    epsilon = max(0.05, epsilon * 0.999)
print("done", Q.max())
