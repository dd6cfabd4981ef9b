"""Every learning algorithm finds the values of small random worlds."""

from __future__ import annotations

import numpy as np
import pytest
from policy_worth import evaluate
from test_every_algorithm import written

from rl_tui.agents.exact.solve import solve
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.position import Stop
from rl_tui.agents.learner import Learner
from rl_tui.common.streams import streams
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp

GAMMA = 0.7


def small_world(seed: int, certain: bool) -> TabularMDP:
    generator = np.random.default_rng(seed)
    transitions = []
    for state in range(5):
        for action in range(3):
            targets = generator.integers(0, 6, size=1 if certain else 3).tolist()
            weights = generator.dirichlet(np.ones(len(targets))).tolist()
            outcomes = [
                Outcome(weight, target, float(generator.integers(-2, 3)), target == 5)
                for weight, target in zip(weights, targets, strict=True)
            ]
            transitions.append(Transition(state, action, outcomes))
    names = [f"s{state}" for state in range(6)]
    return tabular_mdp(names, ["a", "b", "c"], transitions, dict.fromkeys(range(5), 0.2), 20)


def error_after(mdp: TabularMDP, algorithm: str, hyperparameters: Hyperparameters, episodes: int) -> float:
    learner = Learner(mdp, algorithm, hyperparameters, streams(0))
    while learner.episodes < episodes:
        assert learner.advance(10**9, episodes - learner.episodes) in (Stop.DONE, Stop.EPISODES_FULL)
        learner.drain_episodes()
    return float(np.abs(learner.q - solve(mdp, GAMMA).q).max())


def exploration_matters(mdp: TabularMDP) -> float:
    """Return the distance of a random policy's values from the optimal ones, as a scale."""
    v = evaluate(mdp, np.full(mdp.pairs, 1 / 3), GAMMA).v
    return float(np.abs(v - solve(mdp, GAMMA).v).max())


@pytest.mark.exhaustive("trains for 300,000 episodes", but=["q-learning"])
@pytest.mark.parametrize("algorithm", written("q-learning", "double-q-learning", "q-lambda"))
def test_off_policy_whatever_is_explored(algorithm: str) -> None:
    # With α nearly 0 at the end, an estimate averages the targets of its pair over about 1/decay episodes.
    # These are several thousand targets that scatter by about 1.5: ±0.02, and 1/(1 − γ) times that after the
    # error has passed from state to state
    mdp = small_world(1, certain=False)
    hyperparameters = Hyperparameters(alpha=0.5, alpha_decay=3e-5, gamma=GAMMA, epsilon=0.5, lambda_=0.5)
    assert error_after(mdp, algorithm, hyperparameters, 300_000) < 0.1 < exploration_matters(mdp) / 5


@pytest.mark.exhaustive("trains for 300,000 episodes")
@pytest.mark.parametrize("algorithm", written("q-learning", "double-q-learning"))
def test_sample_averages(algorithm: str) -> None:
    # The initial estimates fade only as N^(γ − 1): from about 5 to 5 · 30,000^−0.3 ≈ 0.2
    mdp = small_world(1, certain=False)
    hyperparameters = Hyperparameters(alpha="sample-average", gamma=GAMMA, epsilon=1.0)
    assert error_after(mdp, algorithm, hyperparameters, 100_000) < 0.25 < exploration_matters(mdp) / 5


@pytest.mark.exhaustive("trains for 300,000 episodes")
@pytest.mark.parametrize(
    "algorithm", written("sarsa", "expected-sarsa", "n-step-sarsa", "sarsa-lambda", "monte-carlo")
)
def test_on_policy_as_exploration_fades(algorithm: str) -> None:
    # α = 0.2 ε, and both fade at the same pace. Non-greedy actions learn no more once the α still to come,
    # 0.2 ε / 3 per episode, sums to less than 1: 0.2 ε² / (6 · 2e-5) = 1 at ε = 0.025. Their estimates then
    # belong to a policy with this ε, which loses up to 4 in the states that follow: 0.025 · 4 / 0.3
    mdp = small_world(1, certain=False)
    hyperparameters = Hyperparameters(
        alpha=0.2, alpha_decay=2e-5, gamma=GAMMA, epsilon=1.0, epsilon_decay=2e-5, lambda_=0.5
    )
    assert error_after(mdp, algorithm, hyperparameters, 300_000) < 0.33 < exploration_matters(mdp) / 5


@pytest.mark.exhaustive(
    "one world says nearly all", but=["q-learning-1", "q-lambda-1", "dyna-q-1", "prioritized-sweeping-1"]
)
@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("algorithm", written("q-learning", "q-lambda", "dyna-q", "prioritized-sweeping"))
def test_where_nothing_is_left_to_chance_the_answer_is_exact(algorithm: str, seed: int) -> None:
    mdp = small_world(seed, certain=True)
    hyperparameters = Hyperparameters(alpha=0.5, gamma=GAMMA, epsilon=1.0, lambda_=0.5, threshold=0.0)
    assert error_after(mdp, algorithm, hyperparameters, 800) < 1e-9 < exploration_matters(mdp) / 5
