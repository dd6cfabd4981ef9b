"""The hyper-parameters in the form for kernels."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from rl_tui.agents.hyperparameters import SCHEDULES, Hyperparameters
from rl_tui.agents.kernels.compiled import compiled, inlined

_CONSTANT: Final = SCHEDULES.index("constant")
_LINEAR: Final = SCHEDULES.index("linear")


class Schedule(NamedTuple):
    """The change of a number from `start` towards `least` per episode. `kind` is an index of SCHEDULES."""

    kind: int
    start: float
    least: float
    decay: float


class Schedules(NamedTuple):
    """The schedules of ε and α."""

    epsilon: Schedule
    alpha: Schedule


class KernelParameters(NamedTuple):
    """Hyper-parameters of an update rule.

    `alpha` is the step size of the current episode, unless `sample_average` is true; see :func:`step_size`.
    `trace_decay` is λ, and `steps` the n of n-step methods.
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


@compiled
def scheduled(schedule: Schedule, episode: int) -> float:
    """Return the number in `episode`, counted from 0. It is not inlined, so that all loops share it."""
    if schedule.kind == _CONSTANT or schedule.decay == 0.0:
        return schedule.start
    if schedule.kind == _LINEAR and schedule.start >= schedule.least:
        return max(schedule.least, schedule.start - schedule.decay * episode)
    if schedule.kind == _LINEAR:
        return min(schedule.least, schedule.start + schedule.decay * episode)
    return schedule.least + (schedule.start - schedule.least) * math.exp(-schedule.decay * episode)


@inlined
def epsilon_in(schedules: Schedules, episode: int) -> float:
    """Return ε in `episode`, counted from 0, without a call if it is constant."""
    schedule = schedules.epsilon
    return schedule.start if schedule.decay == 0.0 else scheduled(schedule, episode)


@inlined
def alpha_in(schedules: Schedules, episode: int) -> float:
    """Return the step size in `episode`, counted from 0, without a call if it is constant."""
    schedule = schedules.alpha
    return schedule.start if schedule.decay == 0.0 else scheduled(schedule, episode)


@inlined
def with_alpha(params: KernelParameters, alpha: float) -> KernelParameters:
    """Return `params` with another step size."""
    return KernelParameters(
        alpha,
        params.sample_average,
        params.gamma,
        params.trace_decay,
        params.accumulating,
        params.steps,
        params.planning_steps,
        params.threshold,
        params.accuracy,
        params.random_ties,
    )


@inlined
def step_size(params: KernelParameters, count: int) -> float:
    """Return the step size of update number `count` of a pair, counted from 1."""
    return 1.0 / count if params.sample_average else params.alpha


def kernel_parameters(hyperparameters: Hyperparameters) -> KernelParameters:
    """Convert hyper-parameters for the update rules. Types never vary, as machine code requires."""
    return KernelParameters(
        alpha=float(hyperparameters.alpha_at(0) or 0.0),
        sample_average=hyperparameters.sample_average,
        gamma=float(hyperparameters.gamma),
        trace_decay=float(hyperparameters.lambda_),
        accumulating=hyperparameters.traces == "accumulating",
        steps=int(hyperparameters.n),
        planning_steps=int(hyperparameters.planning_steps),
        threshold=float(hyperparameters.threshold),
        accuracy=float(hyperparameters.accuracy),
        random_ties=hyperparameters.ties == "random",
    )


def schedules_of(hyperparameters: Hyperparameters) -> Schedules:
    """Return the schedules of ε and α. Types never vary, as machine code requires."""
    alpha = 0.0 if isinstance(hyperparameters.alpha, str) else hyperparameters.alpha
    step_size_kind = "constant" if hyperparameters.sample_average else hyperparameters.step_size_schedule
    return Schedules(
        Schedule(
            SCHEDULES.index(hyperparameters.epsilon_schedule),
            float(hyperparameters.epsilon),
            float(hyperparameters.epsilon_min),
            float(hyperparameters.epsilon_decay),
        ),
        Schedule(
            SCHEDULES.index(step_size_kind),
            float(alpha),
            float(hyperparameters.alpha_min),
            float(hyperparameters.alpha_decay),
        ),
    )
