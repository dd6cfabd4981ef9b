# expect: {"rule": "q-learning", "alpha": 0.2, "gamma": 0.95, "alpha_schedule": "constant", "table": "Q"}
# Learns in one environment and is tested in another one every now and then
import gymnasium as gym
import numpy as np

train_env = gym.make("FrozenLake-v1", is_slippery=True)
test_env = gym.make("FrozenLake-v1", is_slippery=True)
Q = np.zeros((16, 4))


def test(n=5):
    wins = 0
    for _ in range(n):
        s, _ = test_env.reset()
        done = False
        while not done:
            s, r, term, trunc, _ = test_env.step(int(np.argmax(Q[s])))
            done = term or trunc
            wins += r
    return wins / n


for episode in range(1200):
    s, _ = train_env.reset()
    done = False
    eps = max(0.1, 1 - episode / 800)
    while not done:
        a = train_env.action_space.sample() if np.random.rand() < eps else int(np.argmax(Q[s]))
        s2, r, term, trunc, _ = train_env.step(a)
        Q[s, a] += 0.2 * (r + 0.95 * np.max(Q[s2]) - Q[s, a])
        s, done = s2, term or trunc
    if episode % 100 == 99:
        print(episode, test())
