# expect: "shifted-reward"
import gymnasium as gym
import numpy as np


class Learner:
    def __init__(self, states, actions):
        self.table = np.zeros((states, actions))
        self.step_size = 0.2
        self.discount = 0.9
        self.last_reward = 0.0

    def act(self, state):
        if np.random.random() < 0.3:
            return np.random.randint(self.table.shape[1])
        row = self.table[state]
        return np.random.choice(np.flatnonzero(row == row.max()))

    def learn(self, state, action, next_state, terminated):
        future = 0.0 if terminated else self.discount * self.table[next_state].max()
        target = self.last_reward + future
        self.table[state, action] += self.step_size * (target - self.table[state, action])  #!

    def observe(self, reward):
        self.last_reward = reward


env = gym.make("FrozenLake-v1", is_slippery=False)
learner = Learner(16, 4)
for episode in range(1500):
    state, _ = env.reset()
    done = False
    while not done:
        action = learner.act(state)
        next_state, reward, terminated, truncated, _ = env.step(action)
        learner.learn(state, action, next_state, terminated)
        learner.observe(reward)
        state, done = next_state, terminated or truncated
