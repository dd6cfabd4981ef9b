"""Bandits with a few arms, and their learners."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np

from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.learner import Learner
from rl_tui.common.streams import streams
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp

NO_VISITS = np.zeros(4, np.int64)


def gaussian(means: list[float], std: float = 1.0) -> TabularMDP:
    return bandit_of([[Outcome(1.0, 0, mean, True, std)] for mean in means])


def bernoulli(means: list[float]) -> TabularMDP:
    return bandit_of([[Outcome(p, 0, 1.0, True), Outcome(1.0 - p, 0, 0.0, True)] for p in means])


def certain(*rewards: float) -> TabularMDP:
    return bandit_of([[Outcome(1.0, 0, reward, True)] for reward in rewards])


def bandit_of(arms: list[list[Outcome]]) -> TabularMDP:
    transitions = [Transition(0, arm, outcomes) for arm, outcomes in enumerate(arms)]
    return tabular_mdp(["here"], [str(arm) for arm in range(len(arms))], transitions, {0: 1.0})


TESTBED = gaussian([0.2, -0.8, 1.5, 0.4])
COINS = bernoulli([0.2, 0.9, 0.5, 1.0])


def new_rule(hyperparameters: Hyperparameters, mdp: TabularMDP = TESTBED) -> Any:
    return importlib.import_module(POLICY_BY_ID[hyperparameters.policy].module).new_rule(mdp, hyperparameters)


def learner(mdp: TabularMDP, hyperparameters: Hyperparameters, seed: int = 0) -> Learner:
    return Learner(mdp, "q-learning", hyperparameters, streams(seed))


def pulls(ours: Learner, steps: int) -> list[tuple[int, float]]:
    taken = []
    for _ in range(steps):
        ours.advance(1)
        taken.append((ours.last_step.pair, ours.last_step.reward))
    return taken
