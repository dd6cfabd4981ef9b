"""Train DQN of Stable-Baselines3 in a world of rl-tui, and compare its values with the exact optimal ones.

pip install rl-tui stable-baselines3
python dqn_against_exact_values.py [STEPS]
"""

import sys

import gymnasium
import numpy as np
import torch
from stable_baselines3 import DQN

import rl_tui

SCENARIO = "student"


def learned_values(scenario: str, gamma: float, steps: int) -> np.ndarray:
    """Train DQN for `steps` and return its Q of every state and action, [S, A]."""
    env = gymnasium.make(f"rl_tui/{scenario}-v0")
    model = DQN(
        "MlpPolicy",
        env,
        gamma=gamma,
        learning_rate=2e-3,
        learning_starts=200,
        train_freq=2,
        target_update_interval=200,
        exploration_fraction=1.0,
        exploration_final_eps=0.3,
        policy_kwargs={"net_arch": [32]},
        seed=0,
        device="cpu",
    )
    torch.set_num_threads(1)  # the network is tiny
    model.learn(steps)
    states = torch.arange(env.observation_space.n).unsqueeze(1)
    with torch.no_grad():
        return model.q_net(states).numpy()


def main(steps: int = 3_000) -> None:
    """Print V* and DQN's value of each state, and the exact return of DQN's greedy policy."""
    exact = rl_tui.solve(SCENARIO)
    q = np.where(np.isnan(exact.q), np.nan, learned_values(SCENARIO, exact.gamma, steps))
    print(f"{'state':16}{'V*':>8}{'DQN':>8}")
    live = ~np.isnan(q).all(axis=1)  # terminal states have no action
    for state in np.flatnonzero(live):
        print(f"{exact.states[state]:16}{exact.v[state]:8.2f}{np.nanmax(q[state]):8.2f}")
    greedy = np.zeros(len(q), dtype=int)
    greedy[live] = np.nanargmax(q[live], axis=1)
    worth = rl_tui.evaluate(SCENARIO, greedy)
    print(f"expected return of its greedy policy: {worth.expected_return:.2f}", end=" ")
    print(f"of {exact.best_expected_return:.2f}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
