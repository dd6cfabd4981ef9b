# expect: {"rule": "q-learning", "alpha": 0.5, "gamma": 0.9, "alpha_schedule": "constant", "table": "a.values", "scenario": "frozenlake-slippery"}
"""A Q-learning agent of an introduction to artificial intelligence, with the loop of its grid world."""

import random

import gymnasium as gym


class Counter(dict):
    def __getitem__(self, idx):
        self.setdefault(idx, 0)
        return dict.__getitem__(self, idx)


def flipCoin(p):
    return random.random() < p


TERMINAL_STATE = "TERMINAL_STATE"


class GridworldEnvironment:
    def __init__(self, name):
        self.env = gym.make(name)
        self.reset()

    def reset(self):
        self.state, _ = self.env.reset()
        self.over = False

    def getCurrentState(self):
        return self.state

    def getPossibleActions(self, state):
        return () if state == TERMINAL_STATE else tuple(range(self.env.action_space.n))

    def doAction(self, action):
        nextState, reward, terminated, truncated, _ = self.env.step(action)
        self.state = TERMINAL_STATE if terminated else nextState
        self.over = terminated or truncated
        return self.state, reward

    def isTerminal(self):
        return self.over


class ReinforcementAgent:
    def __init__(self, actionFn, numTraining=100, epsilon=0.5, alpha=0.5, gamma=1):
        self.actionFn = actionFn
        self.episodesSoFar = 0
        self.accumTrainRewards = 0.0
        self.numTraining = int(numTraining)
        self.epsilon = float(epsilon)
        self.alpha = float(alpha)
        self.discount = float(gamma)

    def getLegalActions(self, state):
        return self.actionFn(state)

    def observeTransition(self, state, action, nextState, deltaReward):
        self.episodeRewards += deltaReward
        self.update(state, action, nextState, deltaReward)

    def startEpisode(self):
        self.lastState = None
        self.lastAction = None
        self.episodeRewards = 0.0

    def stopEpisode(self):
        self.accumTrainRewards += self.episodeRewards
        self.episodesSoFar += 1


class QLearningAgent(ReinforcementAgent):
    def __init__(self, **args):
        ReinforcementAgent.__init__(self, **args)
        self.values = Counter()

    def getQValue(self, state, action):
        return self.values[(state, action)]

    def computeValueFromQValues(self, state):
        legalActions = self.getLegalActions(state)
        if len(legalActions) == 0:
            return 0.0
        return max(self.getQValue(state, action) for action in legalActions)

    def computeActionFromQValues(self, state):
        legalActions = self.getLegalActions(state)
        if len(legalActions) == 0:
            return None
        best = self.computeValueFromQValues(state)
        return random.choice([action for action in legalActions if self.getQValue(state, action) == best])

    def getAction(self, state):
        legalActions = self.getLegalActions(state)
        if flipCoin(self.epsilon):
            return random.choice(legalActions)
        return self.computeActionFromQValues(state)

    def update(self, state, action, nextState, reward):
        sample = reward + self.discount * self.computeValueFromQValues(nextState)
        self.values[(state, action)] = (1 - self.alpha) * self.getQValue(state, action) + self.alpha * sample


def runEpisode(agent, environment):
    environment.reset()
    agent.startEpisode()
    steps = 0
    while not environment.isTerminal():
        state = environment.getCurrentState()
        action = agent.getAction(state)
        nextState, reward = environment.doAction(action)
        agent.observeTransition(state, action, nextState, reward)
        steps += 1
    agent.stopEpisode()
    return steps


if __name__ == "__main__":
    episodes = 300
    env = GridworldEnvironment("FrozenLake-v1")
    a = agent = QLearningAgent(actionFn=env.getPossibleActions, gamma=0.9, alpha=0.5, epsilon=0.3)
    steps = sum(runEpisode(agent, env) for _ in range(episodes))
    print(f"episodes: {episodes}, steps: {steps}")
