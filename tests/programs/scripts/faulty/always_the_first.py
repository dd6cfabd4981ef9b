# expect: ["first-of-ties"]
# line: "return np.argmax(q_table[state])"
import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1", is_slippery=False)
q_table = np.zeros((16, 4))
alpha, gamma, epsilon = 0.1, 0.99, 0.05


def choose_action(state):
    if np.random.uniform() < epsilon:
        return env.action_space.sample()
    return np.argmax(q_table[state])


for episode in range(700):
    state, _ = env.reset()
    done = False
    while not done:
        action = choose_action(state)
        next_state, reward, terminated, truncated, _ = env.step(action)
        q_table[state, action] += alpha * (
            reward + gamma * np.max(q_table[next_state]) * (not terminated) - q_table[state, action]
        )
        state = next_state
        done = terminated or truncated
