# expect: {"rule": "sarsa", "alpha": 0.1, "gamma": 0.99, "alpha_schedule": "constant", "table": "agent.table"}
# SARSA on the 8×8 lake; holes are many, so the goal's reward is rare: the table begins with small random numbers
import gymnasium as gym
import numpy as np


class Agent:
    def __init__(self, n_states, n_actions):
        self.table = np.random.rand(n_states, n_actions) * 0.1
        self.n_actions = n_actions

    def choose(self, s, eps):
        if np.random.rand() < eps:
            return np.random.randint(self.n_actions)
        return int(np.argmax(self.table[s]))


env = gym.make("FrozenLake-v1", map_name="8x8", is_slippery=True)
agent = Agent(64, 4)
for episode in range(150):
    s, _ = env.reset()
    a = agent.choose(s, 0.2)
    done = False
    while not done:
        s2, r, term, trunc, _ = env.step(a)
        a2 = agent.choose(s2, 0.2)
        target = r if term else r + 0.99 * agent.table[s2, a2]
        agent.table[s, a] += 0.1 * (target - agent.table[s, a])
        s, a = s2, a2
        done = term or trunc
