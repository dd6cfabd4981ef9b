"""Exact evaluation of a policy: the document of `evaluate --json`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from rl_tui.agents.exact.policy_figures import (
    Choice,
    figures,
    greedy_policy,
    policy_of_choices,
    softened,
    uniform_over,
    uniform_policy,
)
from rl_tui.agents.exact.solve import solve
from rl_tui.common.errors import UserError
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.exact_answers import NO_TABLE
from rl_tui.runs.figures import finite
from rl_tui.runs.policy_file import read_policy
from rl_tui.runs.recipe import Beginning, Recipe
from rl_tui.runs.run import Run
from rl_tui.runs.training.seeded_runs import Goal, OnProgress, no_progress, train
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


class FollowedPolicy(NamedTuple):
    """A policy and its world.

    `chances` are π(a|s), `[P]`. `not_given` counts states without a given action.
    """

    mdp: TabularMDP
    chances: FloatArray
    not_given: int | None = None


def table_of(recipe: Recipe, beginning: Beginning) -> TabularMDP:
    """Return the table of the world. Raises UserError."""
    mdp = beginning.world.mdp
    if mdp is None:
        raise UserError(f"{recipe.scenario.id} has no exact values: {NO_TABLE}")
    return mdp


def policy_named(
    name: str, recipe: Recipe, beginning: Beginning, goal: Goal, on_progress: OnProgress = no_progress
) -> FollowedPolicy:
    """Return the policy of the kind `name`, or in that file. Raises UserError.

    The greedy one is trained to `goal`. The optimal one is uniform over optimal actions.
    """
    mdp = table_of(recipe, beginning)
    if name == PolicyKind.UNIFORM:
        return FollowedPolicy(mdp, uniform_policy(mdp))
    if name == PolicyKind.OPTIMAL:
        return FollowedPolicy(mdp, uniform_over(mdp, solve(mdp, recipe.hyperparameters.gamma).greedy))
    if name == PolicyKind.GREEDY:
        return _learned(recipe, beginning, goal, on_progress)
    return policy_of(mdp, read_policy(name, mdp))


def policy_of(mdp: TabularMDP, choices: Mapping[int, Choice]) -> FollowedPolicy:
    """Return the policy with `choices`, uniform in other states."""
    live = sum(bool(mdp.pairs_of(state)) for state in range(mdp.states))
    return FollowedPolicy(mdp, policy_of_choices(mdp, choices), live - len(choices))


def evaluation_of(
    recipe: Recipe, name: str, followed: FollowedPolicy, epsilon: float
) -> tuple[FloatArray, dict[str, Any]]:
    """Evaluate a policy exactly, with a share `epsilon` of random actions.

    Returns π(a|s), `[P]`, and the document.
    """
    mdp, gamma = followed.mdp, recipe.hyperparameters.gamma
    policy = softened(mdp, followed.chances, epsilon)
    worth = figures(mdp, policy, gamma)
    v = [None] * mdp.states if worth.v is None else finite(worth.v.tolist())
    return policy, {
        "scenario": recipe.scenario.id,
        "gamma": gamma,
        "policy": name,
        "epsilon": epsilon,
        "value_at_start": worth.value_at_start,
        "expected_return": worth.expected_return,
        "steps": worth.steps,
        "V": dict(zip(mdp.state_names, v, strict=True)),
        "ends": worth.ends,
        "not_given": followed.not_given,
    }


def _learned(recipe: Recipe, beginning: Beginning, goal: Goal, on_progress: OnProgress) -> FollowedPolicy:
    run = Run(recipe, beginning, evaluate=False)
    train(run, goal, on_progress)
    mdp = run.learner.mdp
    assert mdp is not None  # the world has a table, checked before
    return FollowedPolicy(mdp, greedy_policy(mdp, run.learner.q, run.learner.hyperparameters.ties))
