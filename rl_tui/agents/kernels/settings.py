"""The hyper-parameters as the kernels take them."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from rl_tui.agents.hyperparameters import SCHEDULES, Hyperparameters
from rl_tui.agents.kernels.compiled import inlined

_CONSTANT: Final = SCHEDULES.index("constant")
_LINEAR: Final = SCHEDULES.index("linear")


class Schedule(NamedTuple):
    """How a number goes from ``start`` towards ``least`` from episode to episode; ``kind`` of SCHEDULES."""

    kind: int
    start: float
    least: float
    decay: float


class Schedules(NamedTuple):
    """What changes from episode to episode."""

    epsilon: Schedule
    alpha: Schedule


class Settings(NamedTuple):
    """What an update rule is told; ``alpha`` is the step size of the episode under way.

    ``alpha`` does not count where ``sample_average`` is true: see :func:`step_size`. ``trace_decay`` is λ and
    ``steps`` the n of n-step methods.
    """

    alpha: float
    sample_average: bool
    gamma: float
    trace_decay: float
    accumulating: bool
    steps: int
    planning_steps: int
    threshold: float
    accuracy: float
    random_ties: bool


@inlined
def scheduled(schedule: Schedule, episode: int) -> float:
    """Return the number in force in ``episode``, counted from 0."""
    if schedule.kind == _CONSTANT or schedule.decay == 0.0:
        return schedule.start
    if schedule.kind == _LINEAR and schedule.start >= schedule.least:
        return max(schedule.least, schedule.start - schedule.decay * episode)
    if schedule.kind == _LINEAR:
        return min(schedule.least, schedule.start + schedule.decay * episode)
    return schedule.least + (schedule.start - schedule.least) * math.exp(-schedule.decay * episode)


@inlined
def with_alpha(settings: Settings, alpha: float) -> Settings:
    """Return ``settings`` with the step size of another episode."""
    return Settings(
        alpha,
        settings.sample_average,
        settings.gamma,
        settings.trace_decay,
        settings.accumulating,
        settings.steps,
        settings.planning_steps,
        settings.threshold,
        settings.accuracy,
        settings.random_ties,
    )


@inlined
def step_size(settings: Settings, count: int) -> float:
    """Return the step size of the ``count``-th update of a pair (from 1)."""
    return 1.0 / count if settings.sample_average else settings.alpha


def settings_of(told: Hyperparameters) -> Settings:
    """Return the part that the update rule uses."""
    return Settings(
        alpha=told.alpha_at(0) or 0.0,
        sample_average=told.sample_average,
        gamma=told.gamma,
        trace_decay=told.lambda_,
        accumulating=told.traces == "accumulating",
        steps=told.n,
        planning_steps=told.planning_steps,
        threshold=told.threshold,
        accuracy=told.accuracy,
        random_ties=told.ties == "random",
    )


def schedules_of(told: Hyperparameters) -> Schedules:
    """Return what changes from episode to episode."""
    alpha = 0.0 if isinstance(told.alpha, str) else told.alpha
    step_size_kind = "constant" if told.sample_average else told.step_size_schedule
    return Schedules(
        Schedule(SCHEDULES.index(told.epsilon_schedule), told.epsilon, told.epsilon_min, told.epsilon_decay),
        Schedule(SCHEDULES.index(step_size_kind), alpha, told.alpha_min, told.alpha_decay),
    )
