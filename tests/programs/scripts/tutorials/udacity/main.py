# expect: {"rule": "expected-sarsa", "alpha": 0.2, "gamma": 0.9, "epsilon": 0.05, "table": "agent.Q", "scenario": "taxi", "findings": ["no-bootstrap-after-truncation"]}
import gymnasium as gym
from agent import Agent
from monitor import interact

EPISODES = 300
env = gym.make("Taxi-v3")
agent = Agent()
avg_rewards, best_avg_reward, total_steps = interact(env, agent, num_episodes=EPISODES)
print(f"episodes: {EPISODES}, steps: {total_steps}")
