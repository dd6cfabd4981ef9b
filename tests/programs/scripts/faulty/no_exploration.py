# expect: ["never-explores"]
# line: "a = Q[s].index(max(Q[s]))"
import gymnasium as gym

env = gym.make("FrozenLake-v1", is_slippery=False)
Q = [[0.0, 0.0, 0.0, 0.0] for _ in range(16)]
alpha, gamma = 0.1, 0.99

for episode in range(700):
    s, _ = env.reset()
    done = False
    while not done:
        a = Q[s].index(max(Q[s]))
        s2, r, terminated, truncated, _ = env.step(a)
        Q[s][a] += alpha * (r + gamma * max(Q[s2]) - Q[s][a])
        s = s2
        done = terminated or truncated
