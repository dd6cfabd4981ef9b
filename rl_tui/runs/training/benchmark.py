"""The speed of learning, compared with plain loops."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from statistics import median
from typing import Any, Final

import numpy as np
from numpy.random import Generator, default_rng

from rl_tui.agents.batches.batch import UNLIMITED
from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.common.errors import UserError
from rl_tui.common.interrupts import is_interrupt
from rl_tui.common.packages import missing_package
from rl_tui.runs.recipe import Recipe
from rl_tui.runs.run import Run
from rl_tui.runs.training.batched_runs import BatchedRuns
from rl_tui.runs.training.compile_or_interpret import cores
from rl_tui.runs.training.seeded_runs import Goal, SeededRuns
from rl_tui.worlds.gym.env_call import ENVIRONMENT_CALL
from rl_tui.worlds.gym.registered import reason_of
from rl_tui.worlds.gym.section import GymnasiumSection
from rl_tui.worlds.mdp.space import FloatArray

KERNEL_STEPS: Final = 5_000_000
PLAIN_STEPS: Final = 20_000
ROUNDS: Final = 5
RUNS: Final = 64


class PlainLoop:
    """Q-learning in plain Python."""

    def __init__(self, recipe: Recipe, random_ties: bool) -> None:
        import gymnasium

        section = recipe.scenario.section
        if not isinstance(section, GymnasiumSection):
            raise UserError(
                f"{recipe.scenario.id} is not a Gymnasium environment: choose one for the benchmark"
            )
        if recipe.hyperparameters.sample_average:
            raise UserError("the benchmark needs a constant step size: give a number for alpha")
        self._name = section.id
        with self._asked():
            self._env: Any = gymnasium.make(section.id, **section.kwargs)
        if not all(
            isinstance(space, gymnasium.spaces.Discrete)
            for space in (self._env.observation_space, self._env.action_space)
        ):
            raise UserError(
                f"{recipe.scenario.id} has observations of several numbers, and the benchmark needs one: "
                f"choose a scenario such as frozenlake"
            )
        self._alpha = float(recipe.hyperparameters.alpha)
        self._gamma = recipe.hyperparameters.gamma
        self._epsilon_at = recipe.hyperparameters.epsilon_at
        self.episodes = 0
        self._random_ties = random_ties
        self._generator: Generator = default_rng(recipe.seed)
        shape = (self._env.observation_space.n, self._env.action_space.n)
        self.q: FloatArray = np.full(shape, recipe.hyperparameters.initial_q)
        with self._asked():
            self._state, _ = self._env.reset(seed=recipe.seed)

    @contextmanager
    def _asked(self) -> Iterator[None]:
        try:
            with ENVIRONMENT_CALL:
                yield
        except BaseException as error:  # an environment may raise anything
            if is_interrupt(error):
                raise
            raise UserError(f"{self._name} failed in the plain loop: {reason_of(error)}") from error

    def take_steps(self, steps: int) -> None:
        """Take `steps` steps. Raises UserError if the environment fails."""
        with self._asked():
            self._take(steps)

    def _take(self, steps: int) -> None:
        env, q, generator = self._env, self.q, self._generator
        alpha, gamma, epsilon = self._alpha, self._gamma, self._epsilon_at(self.episodes)
        actions, random_ties, state = q.shape[1], self._random_ties, self._state
        for _ in range(steps):
            if generator.random() < epsilon:
                action = generator.integers(actions)
            elif random_ties:
                action = generator.choice(np.flatnonzero(q[state] == q[state].max()))
            else:
                action = np.argmax(q[state])
            next_state, reward, terminated, truncated, _ = env.step(int(action))
            bootstrap = 0.0 if terminated else np.max(q[next_state])
            q[state, action] += alpha * (reward + gamma * bootstrap - q[state, action])
            if terminated or truncated:
                next_state, _ = env.reset()
                self.episodes += 1
                epsilon = self._epsilon_at(self.episodes)
            state = next_state
        self._state = state


class Together:
    """64 runs with different seeds on all cores, as in `train --runs`."""

    def __init__(self, recipe: Recipe) -> None:
        seeded, seeds = SeededRuns(recipe), range(recipe.seed, recipe.seed + RUNS)
        self._parts: list[Callable[[int], object]]
        if seeded.batched_loop is not None and BACKGROUND.get(seeded.batched_loop):
            shares = [seeds[core :: cores()] for core in range(cores())]
            goal = Goal(steps=UNLIMITED)
            self._parts = [BatchedRuns(seeded, share, goal).batch.advance for share in shares if share]
        else:
            self._parts = [seeded.new_run(seed).advance for seed in seeds]

    def take_steps(self, steps: int) -> None:
        """Take about `steps` steps in all."""
        with ThreadPoolExecutor(cores()) as pool:
            for done in [pool.submit(advance, steps // len(self._parts)) for advance in self._parts]:
                done.result()


def benchmark(recipe: Recipe, rounds: int = ROUNDS) -> dict[str, Any]:
    """Time the kernel (one and 64 runs) and the plain loop (first and random ties), in turns.

    Returns the document of `bench --json`, with median steps per second. Raises UserError without a Gymnasium
    environment, or for a planner.
    """
    if BY_ID[recipe.algorithm].planner:
        raise UserError(f"{recipe.algorithm} takes no steps in the world: choose an algorithm that learns")
    first, random = PlainLoop(recipe, random_ties=False), PlainLoop(recipe, random_ties=True)
    run, together = Run(recipe, evaluate=False), Together(recipe)
    if not BACKGROUND.get(run.learner.loop):
        failure = BACKGROUND.failed[run.learner.loop]
        raise UserError(f"no machine code: {missing_package(failure) or failure}")
    run.advance(KERNEL_STEPS // 10)
    together.take_steps(KERNEL_STEPS)
    turns: list[tuple[Callable[[int], None], int]] = [
        (run.advance, KERNEL_STEPS),
        (together.take_steps, 4 * KERNEL_STEPS),
        (first.take_steps, PLAIN_STEPS),
        (random.take_steps, PLAIN_STEPS),
    ]
    speeds = [[_speed(take_steps, steps) for take_steps, steps in turns] for _ in range(rounds)]
    kernel, many, plain, plain_random = (median(column) for column in zip(*speeds, strict=True))
    return {
        "scenario": recipe.scenario.id,
        "kernel_steps_per_second": kernel,
        "gymnasium_steps_per_second": plain,
        "ratio": kernel / plain,
        "gymnasium_random_ties_steps_per_second": plain_random,
        "ratio_random_ties": kernel / plain_random,
        "many_runs_steps_per_second": many,
        "ratio_many_runs": many / plain,
    }


def _speed(take_steps: Callable[[int], None], steps: int) -> float:
    start = time.perf_counter()
    take_steps(steps)
    return steps / (time.perf_counter() - start)
