# expect: {"rule": "unknown", "alpha": null, "gamma": null, "table": null}
import gymnasium as gym

env = gym.make("FrozenLake-v1", render_mode=None)
wins = 0
for _ in range(300):
    env.reset()
    done = False
    while not done:
        _, reward, terminated, truncated, _ = env.step(env.action_space.sample())
        done = terminated or truncated
        wins += reward
print(wins)
