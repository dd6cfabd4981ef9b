from collections import defaultdict

import numpy as np


class Agent:
    def __init__(self, nA=6):
        """Initialize agent.

        Params
        ======
        - nA: number of actions available to the agent
        """
        self.nA = nA
        self.Q = defaultdict(lambda: np.zeros(self.nA))
        self.alpha = 0.2
        self.gamma = 0.9
        self.epsilon = 0.05

    def get_probs(self, Q_s):
        policy_s = np.ones(self.nA) * self.epsilon / self.nA
        best = np.argmax(Q_s)
        policy_s[best] = 1 - self.epsilon + self.epsilon / self.nA
        return policy_s

    def select_action(self, state):
        if state in self.Q:
            return np.random.choice(np.arange(self.nA), p=self.get_probs(self.Q[state]))
        return np.random.choice(self.nA)

    def step(self, state, action, reward, next_state, done):
        if not done:
            expected = np.dot(self.Q[next_state], self.get_probs(self.Q[next_state]))
            self.Q[state][action] += self.alpha * (reward + self.gamma * expected - self.Q[state][action])
        else:
            self.Q[state][action] += self.alpha * (reward - self.Q[state][action])
