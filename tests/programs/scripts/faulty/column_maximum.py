# expect: ["wrong-axis"]
# line: "Q[state, action] += alpha * (reward + gamma * best_next - Q[state, action])"
import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1", is_slippery=False)
n_states, n_actions = env.observation_space.n, env.action_space.n
Q = np.zeros((n_states, n_actions))
alpha, gamma, epsilon = 0.1, 0.9, 0.3

for episode in range(900):
    state, _ = env.reset()
    terminated = truncated = False
    while not (terminated or truncated):
        if np.random.rand() < epsilon:
            action = np.random.choice(n_actions)
        else:
            action = np.random.choice(np.flatnonzero(Q[state] == Q[state].max()))
        next_state, reward, terminated, truncated, _ = env.step(action)
        best_next = 0.0 if terminated else np.max(Q[:, action])
        Q[state, action] += alpha * (reward + gamma * best_next - Q[state, action])
        state = next_state
