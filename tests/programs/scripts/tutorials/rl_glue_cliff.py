# expect: {"rule": "q-learning", "alpha": 0.5, "gamma": 1.0, "alpha_schedule": "constant", "table": "rl_glue.agent.q", "scenario": "cliff"}
"""A cliff with agent, environment and what glues them together, each in a class of its own."""

import gymnasium as gym
import numpy as np
from tqdm import tqdm


class CliffEnvironment:
    def env_init(self, env_info={}):
        self.env = gym.make("CliffWalking-v0")

    def env_start(self):
        observation, _ = self.env.reset()
        return observation

    def env_step(self, action):
        observation, reward, terminated, truncated, _ = self.env.step(action)
        return reward, observation, terminated


class QLearningAgent:
    def agent_init(self, agent_init_info):
        self.num_actions = agent_init_info["num_actions"]
        self.num_states = agent_init_info["num_states"]
        self.epsilon = agent_init_info["epsilon"]
        self.step_size = agent_init_info["step_size"]
        self.discount = agent_init_info["discount"]
        self.rand_generator = np.random.RandomState(agent_init_info["seed"])
        self.q = np.zeros((self.num_states, self.num_actions))

    def choose(self, state):
        current_q = self.q[state, :]
        if self.rand_generator.rand() < self.epsilon:
            return self.rand_generator.randint(self.num_actions)
        return self.argmax(current_q)

    def agent_start(self, observation):
        self.prev_state = observation
        self.prev_action = self.choose(observation)
        return self.prev_action

    def agent_step(self, reward, observation):
        target = reward + self.discount * np.max(self.q[observation, :])
        self.q[self.prev_state, self.prev_action] += self.step_size * (
            target - self.q[self.prev_state, self.prev_action]
        )
        action = self.choose(observation)
        self.prev_state = observation
        self.prev_action = action
        return action

    def agent_end(self, reward):
        self.q[self.prev_state, self.prev_action] += self.step_size * (
            reward - self.q[self.prev_state, self.prev_action]
        )

    def argmax(self, q_values):
        top = float("-inf")
        ties = []
        for i in range(len(q_values)):
            if q_values[i] > top:
                top = q_values[i]
                ties = []
            if q_values[i] == top:
                ties.append(i)
        return self.rand_generator.choice(ties)


class RLGlue:
    def __init__(self, env_class, agent_class):
        self.environment = env_class()
        self.agent = agent_class()
        self.num_steps = 0
        self.num_episodes = 0

    def rl_init(self, agent_init_info={}, env_init_info={}):
        self.environment.env_init(env_init_info)
        self.agent.agent_init(agent_init_info)

    def rl_start(self):
        self.total_reward = 0.0
        observation = self.environment.env_start()
        self.last_action = self.agent.agent_start(observation)

    def rl_step(self):
        reward, observation, term = self.environment.env_step(self.last_action)
        self.total_reward += reward
        self.num_steps += 1
        if term:
            self.num_episodes += 1
            self.agent.agent_end(reward)
        else:
            self.last_action = self.agent.agent_step(reward, observation)
        return term

    def rl_episode(self, max_steps_this_episode):
        is_terminal = False
        self.rl_start()
        count = 0
        while not is_terminal and (max_steps_this_episode == 0 or count < max_steps_this_episode):
            is_terminal = self.rl_step()
            count += 1
        return is_terminal


agent_info = {"num_actions": 4, "num_states": 48, "epsilon": 0.1, "step_size": 0.5, "discount": 1.0}
num_runs = 2
num_episodes = 120
all_reward_sums = []
all_steps = 0
for run in tqdm(range(num_runs)):
    agent_info["seed"] = run
    rl_glue = RLGlue(CliffEnvironment, QLearningAgent)
    rl_glue.rl_init(agent_info, {})
    for episode in range(num_episodes):
        rl_glue.rl_episode(0)
        all_reward_sums.append(rl_glue.total_reward)
    all_steps += rl_glue.num_steps
np.save("table.npy", rl_glue.agent.q)
print(f"episodes: {num_runs * num_episodes}, steps: {all_steps}")
