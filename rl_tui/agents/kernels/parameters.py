"""The hyperparameters in the form for kernels."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from rl_tui.agents.hyperparameters import SCHEDULES, Hyperparameters
from rl_tui.agents.kernels.compiled import compiled, inlined

_CONSTANT: Final = SCHEDULES.index("constant")
_LINEAR: Final = SCHEDULES.index("linear")


class Schedule(NamedTuple):
    """The change of a number towards `least` per episode. `kind` is an index of SCHEDULES."""

    kind: int
    start: float
    least: float
    decay: float


class Schedules(NamedTuple):
    """The schedules of ε and α."""

    epsilon: Schedule
    alpha: Schedule


class KernelParameters(NamedTuple):
    """Hyperparameters of an update rule in the current episode.

    The step size is `alpha`, unless `sample_average` is true. Traces decay by `trace_decay`, λ. The n of
    n-step methods is `steps`.
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
    """Return the number in `episode`, from 0. Not inlined, so that all loops share it."""
    if schedule.kind == _CONSTANT or schedule.decay == 0.0:
        return schedule.start
    if schedule.kind == _LINEAR and schedule.start >= schedule.least:
        return max(schedule.least, schedule.start - schedule.decay * episode)
    if schedule.kind == _LINEAR:
        return min(schedule.least, schedule.start + schedule.decay * episode)
    return schedule.least + (schedule.start - schedule.least) * math.exp(-schedule.decay * episode)


@inlined
def epsilon_in(schedules: Schedules, episode: int) -> float:
    """Return ε in `episode`, from 0, without a call if it is constant."""
    schedule = schedules.epsilon
    return schedule.start if schedule.decay == 0.0 else scheduled(schedule, episode)


@inlined
def alpha_in(schedules: Schedules, episode: int) -> float:
    """Return α in `episode`, from 0, without a call if it is constant."""
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
    """Return the step size of update `count` of a pair, from 1."""
    return 1.0 / count if params.sample_average else params.alpha


def kernel_parameters(hyperparameters: Hyperparameters) -> KernelParameters:
    """Convert hyperparameters, always to the same types, as machine code requires."""
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
    """Return the schedules of ε and α, always of the same types."""
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
