"""Recordings without a real program: a learner in a small random world, step by step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rl_tui.programs.watched.messages import StepFlag
from rl_tui.programs.watched.program_log import FoundTable, ProgramLog
from rl_tui.worlds.mdp.space import FloatArray

STATES, ACTIONS, LIMIT = 6, 3, 12


@dataclass
class Step:
    """A step as reported to a learner."""

    state: int
    action: int
    reward: float
    next_state: int
    terminated: bool
    truncated: bool
    next_action: int
    reward_before: float
    """The reward of the program's previous step."""
    first: bool
    """Whether the step begins an episode."""
    number: int
    episode: int


Learner = Callable[[FloatArray, Step], None]
"""Changes the table, [S, A], as a program does after a step."""


def recorded(
    learner: Learner,
    seed: int = 0,
    *,
    steps: int = 1500,
    initial: str = "random",
    dtype: str = "float64",
    greedy: float = 0.0,
    rewards: tuple[float, ...] = (-1.0, 0.0, 0.0, 1.0, 2.0),
) -> ProgramLog:
    """Return the messages of a program that learns by ``learner`` and acts greedily with a given chance."""
    rng = np.random.default_rng(seed)
    next_state = rng.integers(0, STATES, (STATES, ACTIONS, 2))
    reward = rng.choice(rewards, (STATES, ACTIONS, 2))
    ends = rng.random((STATES, ACTIONS, 2)) < 0.12
    table = {
        "random": rng.random((STATES, ACTIONS)),
        "zeros": np.zeros((STATES, ACTIONS)),
        "high": np.full((STATES, ACTIONS), 5.0),
    }[initial].astype(dtype)
    log = ProgramLog(table=FoundTable("Q", "array", table.shape, dtype))
    log.recording.find_table(0, ACTIONS, table.astype(np.float64).ravel())

    rows: list[list[float]] = []
    changes: list[tuple[float, float, float, float]] = []

    def chosen(state: int) -> int:
        return int(table[state].argmax()) if rng.random() < greedy else int(rng.integers(ACTIONS))

    state, action, place, episode, before = 0, chosen(0), 0, 0, 0.0
    for number in range(steps):
        which = int(rng.integers(2))
        following = int(next_state[state, action, which])
        got = float(reward[state, action, which])
        terminated = bool(ends[state, action, which])
        truncated = place == LIMIT - 1
        next_action = chosen(following)
        step = Step(
            state,
            action,
            got,
            following,
            terminated,
            truncated,
            next_action,
            before,
            place == 0,
            number,
            episode,
        )
        old = table.copy()
        learner(table, step)
        flags = StepFlag.TERMINATED * terminated | StepFlag.TRUNCATED * truncated
        row = [0.0, state, action, got, following, flags, episode, place]
        rows.append(row)
        changes += [(number, cell, old.flat[cell], table.flat[cell]) for cell in np.flatnonzero(old != table)]
        before, place = got, place + 1
        state, action = following, next_action
        if terminated or truncated:
            state, place, episode = 0, 0, episode + 1
            action = chosen(0)
    log.recording.add(np.array(rows, np.float64), np.array(changes, np.float64).reshape(-1, 4))
    log.ended = True
    return log
