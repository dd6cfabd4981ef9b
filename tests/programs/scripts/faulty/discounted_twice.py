# expect: ["gamma-twice"]
# line: "Q[state, action] += alpha * (target - Q[state, action])"
import gymnasium as gym
import numpy as np

alpha = 0.1
gamma = 0.99
epsilon = 0.1


def discounted_value(Q, state):
    return gamma * np.max(Q[state])


env = gym.make("CliffWalking-v1", max_episode_steps=300)
Q = np.zeros((48, 4))
for episode in range(80):
    state, _ = env.reset()
    done = False
    while not done:
        action = env.action_space.sample() if np.random.rand() < epsilon else int(np.argmax(Q[state]))
        next_state, reward, terminated, truncated, _ = env.step(action)
        target = reward
        if not terminated:
            target += gamma * discounted_value(Q, next_state)
        Q[state, action] += alpha * (target - Q[state, action])
        state = next_state
        done = terminated or truncated
