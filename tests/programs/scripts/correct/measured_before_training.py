# expect: {"rule": "q-learning", "alpha": 0.5, "gamma": 0.9}
# How good it is untrained is measured first, over many episodes
import gymnasium as gym
import numpy as np

env = gym.make("CliffWalking-v1", max_episode_steps=30)
Q = np.zeros((48, 4))
alpha = 0.5
gamma = 0.9


def play(episodes, epsilon, learn):
    returns = []
    for _ in range(episodes):
        state, _ = env.reset()
        total, over = 0, False
        while not over:
            explores = np.random.rand() < epsilon
            action = env.action_space.sample() if explores else int(np.argmax(Q[state]))
            next_state, reward, terminated, truncated, _ = env.step(action)
            if learn:
                future = 0 if terminated else np.max(Q[next_state])
                Q[state, action] += alpha * (reward + gamma * future - Q[state, action])
            state, total = next_state, total + reward
            over = terminated or truncated
        returns.append(total)
    return np.mean(returns)


print("before:", play(120, 0.0, learn=False))
play(120, 0.3, learn=True)
print("after:", play(20, 0.0, learn=False))
