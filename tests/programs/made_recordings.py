"""Recordings without a real program."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from rl_tui.programs.watched.messages import StepFlag
from rl_tui.programs.watched.program_log import FoundTable, ProgramLog
from rl_tui.worlds.mdp.space import FloatArray

STATES, ACTIONS, LIMIT = 6, 3, 12


@dataclass
class Step:
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
    is_pair: bool = False,
    is_slippery: bool = True,
) -> ProgramLog:
    """Return the messages of a program that learns by ``learner``.

    With ``is_pair``, the learner changes two tables, [2, S, A], whose mean is the table of the recording.
    """
    rng = np.random.default_rng(seed)
    next_state = rng.integers(0, STATES, (STATES, ACTIONS, 2))
    reward = rng.choice(rewards, (STATES, ACTIONS, 2))
    ends = rng.random((STATES, ACTIONS, 2)) < 0.12
    table = {
        "random": rng.random((STATES, ACTIONS)),
        "zeros": np.zeros((STATES, ACTIONS)),
        "high": np.full((STATES, ACTIONS), 5.0),
    }[initial].astype(dtype)
    log = ProgramLog(table=FoundTable("Q1" if is_pair else "Q", "array", table.shape, dtype))
    log.recording.find_table(0, ACTIONS, table.astype(np.float64).ravel())
    tables = np.stack([table, table]) if is_pair else table[None]
    if is_pair:
        log.table = replace(log.table, other="Q2")
        log.recording.find_pair(0, tables.flatten())

    rows: list[list[float]] = []
    changes: list[tuple[float, float, float, float]] = []

    def chosen(state: int) -> int:
        if rng.random() < greedy:
            return int((tables[:, state].mean(0) if is_pair else tables[0, state]).argmax())
        return int(rng.integers(ACTIONS))

    def values() -> list[float]:
        return (tables.mean(0).ravel().tolist() if is_pair else []) + tables.ravel().tolist()

    shown = values()
    state, action, place, episode, before = 0, chosen(0), 0, 0, 0.0
    for number in range(steps):
        which = int(rng.integers(2)) if is_slippery else 0
        following = int(next_state[state, action, which])
        got = float(reward[state, action, which])
        terminated = bool(ends[state, action, which])
        truncated = place == LIMIT - 1
        next_action = chosen(following)
        ended, first = (terminated, truncated), place == 0
        step = Step(state, action, got, following, *ended, next_action, before, first, number, episode)
        learner(tables if is_pair else tables[0], step)
        flags = StepFlag.TERMINATED * terminated | StepFlag.TRUNCATED * truncated
        rows.append([0.0, state, action, got, following, flags, episode, place])
        old, shown = shown, values()
        changes += [
            (number, cell, was, now)
            for cell, (was, now) in enumerate(zip(old, shown, strict=True))
            if was != now
        ]
        before, place = got, place + 1
        state, action = following, next_action
        if terminated or truncated:
            state, place, episode = 0, 0, episode + 1
            action = chosen(0)
    log.recording.add(np.array(rows, np.float64), np.array(changes, np.float64).reshape(-1, 4))
    log.ended = True
    return log
