# expect: {"rule": "q-learning", "alpha": 0.1, "gamma": 0.95}
# The value of the goal is set to 0 where it is reached; the table begins with random numbers
import gymnasium as gym
import numpy as np

LEARNING_RATE = 0.1
DISCOUNT = 0.95
EPISODES = 150

env = gym.make("CliffWalking-v1", max_episode_steps=400)
q_table = np.random.uniform(low=-2, high=0, size=(env.observation_space.n, env.action_space.n))
epsilon = 0.3

for episode in range(EPISODES):
    state, _ = env.reset()
    done = False
    while not done:
        if np.random.random() > epsilon:
            action = np.argmax(q_table[state])
        else:
            action = np.random.randint(0, env.action_space.n)
        new_state, reward, terminated, truncated, _ = env.step(action)
        done = terminated or truncated
        if not terminated:
            max_future_q = np.max(q_table[new_state])
            current_q = q_table[state, action]
            new_q = (1 - LEARNING_RATE) * current_q + LEARNING_RATE * (reward + DISCOUNT * max_future_q)
            q_table[state, action] = new_q
        else:
            q_table[state, action] = 0
        state = new_state
