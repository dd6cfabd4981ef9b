"""Exact figures: values and returns of policies, flip points, and the first update."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rl_tui.agents.exact.exact_model import exact_model
from rl_tui.agents.exact.first_update import Wait, first_wait
from rl_tui.agents.exact.flips import Flip
from rl_tui.agents.exact.flips import flips as flips_of
from rl_tui.agents.exact.policy_figures import (
    Choice,
    PolicyFigures,
    figures,
    greedy_policy,
    policy_of_choices,
    softened,
    uniform_over,
    uniform_policy,
)
from rl_tui.common.findings import near, shown
from rl_tui.lessons.figures.expression import FigureError
from rl_tui.lessons.figures.subject import FigureSubject, name_of, share, whole
from rl_tui.runs.training.learned_length import best_actions

if TYPE_CHECKING:
    from rl_tui.worlds.mdp.space import FloatArray
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

POLICIES: Final = ("uniform", "optimal", "soft", "first")
ELSEWHERE: Final = "else"
_PolicyText = Any
"""A name in `POLICIES`, or a table from states to actions."""


def optimal_value(subject: FigureSubject, state: object = None) -> float:
    """Return V*(state) for the γ of the setup, without a time limit, or at the start without a state."""
    solution = subject.solution
    return solution.value_at_start if state is None else float(solution.v[subject.state(state)])


def optimal_q(subject: FigureSubject, state: object, action: object) -> float:
    """Return Q*(state, action) for the γ of the setup, without a time limit."""
    return float(subject.solution.q[subject.pair(state, action)])


def optimal_return(subject: FigureSubject) -> float:
    """Return the undiscounted return of the optimal policy for γ, within the time limit."""
    return _there(subject.returns.expected_return, "optimal_return")


def best_return(subject: FigureSubject) -> float:
    """Return the undiscounted return, within the time limit, of the best time-dependent policy."""
    return _there(subject.returns.best_expected_return, "best_return")


def unlimited_return(subject: FigureSubject) -> float:
    """Return the undiscounted return of the optimal policy for γ, without a time limit."""
    return policy_unlimited_return(subject, "optimal")


def policy_value(
    subject: FigureSubject, state: object = None, policy: _PolicyText = "uniform", epsilon: object = 0
) -> float:
    """Return V of a policy in a state, or at the start, with exploration ε and no time limit."""
    found = _figures(subject, subject.mdp, policy, epsilon)
    if state is None:
        return _there(found.value_at_start, "policy_value")
    return _there(None if found.v is None else float(found.v[subject.state(state)]), "policy_value")


def policy_return(subject: FigureSubject, policy: _PolicyText, epsilon: object = 0) -> float:
    """Return the return of a policy with a random action ε of the time, within the time limit."""
    return _there(_figures(subject, subject.mdp, policy, epsilon).expected_return, "policy_return")


def policy_steps(subject: FigureSubject, policy: _PolicyText, epsilon: object = 0) -> float:
    """Return the mean steps of an episode of a policy with a random action ε of the time."""
    return _there(_figures(subject, subject.mdp, policy, epsilon).steps, "policy_steps")


def policy_ends(subject: FigureSubject, policy: _PolicyText, epsilon: object = 0) -> float:
    """Return the probability that an episode of a policy ends, within the time limit if there is one."""
    return _there(_figures(subject, subject.mdp, policy, epsilon).ends, "policy_ends")


def policy_unlimited_return(subject: FigureSubject, policy: _PolicyText, epsilon: object = 0) -> float:
    """Return the return of a policy with a random action ε of the time, without a time limit."""
    found = _figures(subject, subject.unlimited, policy, epsilon).expected_return
    return _there(found, "policy_unlimited_return")


def soft_return(subject: FigureSubject, planned: object, epsilon: object) -> float:
    """Return what the best policy for exploration `planned` returns while exploring with ε."""
    found = _figures(subject, subject.mdp, "soft", epsilon, planned)
    return _there(found.expected_return, "soft_return")


def soft_steps(subject: FigureSubject, planned: object, epsilon: object) -> float:
    """Return the mean steps of the best policy for exploration `planned` while exploring with ε."""
    return _there(_figures(subject, subject.mdp, "soft", epsilon, planned).steps, "soft_steps")


def flip(subject: FigureSubject, n: object) -> float:
    """Return the n-th γ, counted from 1, at which the optimal actions change in some state."""
    return _nth(_flips(subject), n)


def way_flip(subject: FigureSubject, n: object) -> float:
    """Return the n-th γ, counted from 1, at which the optimal path from the start changes."""
    return _nth(tuple(each for each in _flips(subject) if each.turns_the_way), n)


def _nth(found: tuple[Flip, ...], n: object) -> float:
    if not found:
        raise FigureError("this world has no flip point; choose another world")
    return found[whole(n, "n", 1, len(found)) - 1].gamma


def flips(subject: FigureSubject) -> int:
    """Return the number of γ between 0 and 1 at which the optimal actions change."""
    return len(_flips(subject))


def first_update_chance(subject: FigureSubject) -> float:
    """Return the probability that an episode changes an estimate while all are equal, as in `rl-tui why`."""
    return _wait(subject).chance


def mean_episodes(subject: FigureSubject) -> float:
    """Return the mean number of episodes until an estimate changes for the first time."""
    return _there(_wait(subject).mean_episodes, "mean_episodes")


def median_episodes(subject: FigureSubject) -> int:
    """Return the median number of episodes until an estimate changes for the first time."""
    return int(_there(_wait(subject).median_episodes, "median_episodes"))


def _there(value: float | None, name: str) -> float:
    if value is None or not np.isfinite(value):
        raise FigureError(f"{name} has no exact value here; choose another world or γ")
    return value


def _flips(subject: FigureSubject) -> tuple[Flip, ...]:
    key = "flips", id(subject.mdp)
    if key not in subject.known:
        subject.known[key] = flips_of(subject.mdp)
    found: tuple[Flip, ...] = subject.known[key]
    return found


def _wait(subject: FigureSubject) -> Wait:
    return first_wait(subject.mdp, subject.recipe.algorithm, subject.values)


def _figures(
    subject: FigureSubject, mdp: TabularMDP, policy: _PolicyText, epsilon: object, planned: object = None
) -> PolicyFigures:
    often = share(epsilon, "epsilon")
    aware = often if planned is None else share(planned, "planned")
    key = "policy", id(mdp), subject.values.gamma, repr(policy), often, aware
    if key not in subject.known:
        # the cached world keeps its id from being reused
        chances = softened(mdp, _policy(subject, policy, aware), often)
        subject.known[key] = mdp, figures(mdp, chances, subject.values.gamma)
    found: PolicyFigures = subject.known[key][1]
    return found


def _policy(subject: FigureSubject, policy: _PolicyText, planned: float) -> FloatArray:
    mdp = subject.mdp
    if isinstance(policy, dict):
        return _drawn(subject, policy)
    if policy == "uniform":
        return uniform_policy(mdp)
    if policy == "first":
        return greedy_policy(mdp, np.zeros(mdp.pairs), "first")
    if policy == "optimal":
        return uniform_over(mdp, subject.solution.greedy)
    if policy == "soft":
        return uniform_over(mdp, best_actions(exact_model(mdp), subject.values.gamma, planned))
    raise FigureError(
        f"policy {shown(policy)}",
        f'{", ".join(POLICIES)}, or a table {{"STATE": "ACTION"}}{near(str(policy), POLICIES)}',
    )


def _drawn(subject: FigureSubject, table: dict[Any, Any]) -> FloatArray:
    mdp = subject.mdp
    named = {name_of(state): name_of(action) for state, action in table.items()}
    elsewhere = named.pop(ELSEWHERE, None)
    choices: dict[int, Choice] = {}
    if elsewhere is not None:
        action = subject.action(elsewhere)
        pairs = ((state, mdp.pair_of(state, action)) for state in range(mdp.states))
        choices = {state: pair for state, pair in pairs if pair is not None}
    for state, name in named.items():
        choices[subject.state(state)] = subject.pair(state, name)
    return policy_of_choices(mdp, choices)
