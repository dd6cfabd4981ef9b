"""Small worlds made by hand, and their values."""

from __future__ import annotations

from functools import cache

import numpy as np

from rl_tui.agents.exact.policy_evaluation import Solution
from rl_tui.worlds.drawing import Arms, CellKind, Graph, Grid
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp
from rl_tui.worlds.world import World

LEFT, DOWN, RIGHT, UP = range(4)
DIRECTIONS = ((0, -1), (1, 0), (0, 1), (-1, 0))
LAKE = ("SFFF", "FHFH", "FFFH", "HFFG")
BIG_LAKE = ("SFFFFFFF", "FFFFFFFF", "FFFHFFFF", "FFFFFHFF", "FFFHFFFF", "FHHFFFHF", "FHFFHFHF", "FFFHFFFG")
KINDS = {"S": CellKind.START, "F": CellKind.FLOOR, "H": CellKind.HOLE, "G": CellKind.GOAL}


@cache
def lake_world(*, slippery: bool = True, rows: tuple[str, ...] = LAKE, time_limit: int = 100) -> World:
    height, width = len(rows), len(rows[0])
    cells = "".join(rows)

    def landing(state: int, action: int) -> int:
        row, column = divmod(state, width)
        down, right = DIRECTIONS[action]
        return min(max(row + down, 0), height - 1) * width + min(max(column + right, 0), width - 1)

    def outcome(state: int, action: int, probability: float) -> Outcome:
        there = landing(state, action)
        reward = 1.0 if cells[there] == "G" else 0.0
        return Outcome(probability, there, reward, cells[there] in "GH", action=action)

    transitions = []
    for state, cell in enumerate(cells):
        if cell in "GH":
            continue
        for action in range(4):
            if slippery:
                outcomes = [outcome(state, (action + turn) % 4, 1 / 3) for turn in (-1, 0, 1)]
            else:
                outcomes = [outcome(state, action, 1.0)]
            transitions.append(Transition(state, action, outcomes))
    mdp = tabular_mdp(
        [str(state) for state in range(len(cells))],
        ("left", "down", "right", "up"),
        transitions,
        {cells.index("S"): 1.0},
        time_limit,
    )
    grid = Grid(height, width, tuple(KINDS[cell] for cell in cells), tuple(range(len(cells))), DIRECTIONS)
    return World(mdp, grid)


@cache
def student_world() -> World:
    mdp = tabular_mdp(
        ("Class", "Phone", "Pass", "Sleep"),
        ("study", "check phone", "scroll", "quit", "sleep"),
        (
            Transition(0, 0, (Outcome(0.8, 2, -2.0, False), Outcome(0.2, 0, -2.0, False))),
            Transition(0, 1, (Outcome(1.0, 1, 0.0, False),)),
            Transition(1, 2, (Outcome(1.0, 1, -1.0, False),)),
            Transition(1, 3, (Outcome(1.0, 0, 0.0, False),)),
            Transition(2, 4, (Outcome(1.0, 3, 10.0, True),)),
        ),
        {0: 1.0},
        time_limit=100,
    )
    return World(mdp, Graph(((0, 1), (0, 0), (1, 1), (2, 1))))


TRUE_MEANS = (-0.4, 0.3, -0.6, 0.7, 0.0, 1.5, -0.1, 0.2, -1.2, 0.8)


@cache
def bandit_world(means: tuple[float, ...] = TRUE_MEANS, budget: int = 1_000) -> World:
    mdp = tabular_mdp(
        ("bandit",),
        [str(arm) for arm in range(len(means))],
        [
            Transition(0, arm, (Outcome(1.0, 0, mean, True, reward_std=1.0),))
            for arm, mean in enumerate(means)
        ],
        {0: 1.0},
        time_limit=1,
    )
    return World(mdp, Arms(mdp.pairs), budget)


@cache
def exact_solution(mdp: TabularMDP, gamma: float) -> Solution:
    q: FloatArray = np.zeros(mdp.pairs)
    v: FloatArray = np.zeros(mdp.states)
    outcome_pair = mdp.outcome_pair
    sweeps = 0
    moved = 1.0
    while moved > 1e-13:
        sweeps += 1
        continuing = np.where(mdp.terminated, 0.0, v[mdp.next_state])
        before = q
        each = mdp.probability * (mdp.reward + gamma * continuing)
        q = np.bincount(outcome_pair, each, minlength=mdp.pairs).astype(np.float64)
        v = best_values(mdp, q)
        moved = float(np.abs(q - before).max())
    at_start = float(mdp.start_probability @ v[mdp.start_state])
    greedy = q >= v[mdp.pair_state] - 1e-9
    for shared in (v, q, greedy):
        shared.flags.writeable = False
    best = np.flatnonzero(greedy)
    policy = best[np.diff(mdp.pair_state[best], prepend=-1) > 0]
    return Solution(gamma, v, q, greedy, greedy, at_start, policy, sweeps)


def best_values(mdp: TabularMDP, q: FloatArray) -> FloatArray:
    return np.array(
        [max(q[mdp.first_pair[s] : mdp.first_pair[s + 1]], default=0.0) for s in range(mdp.states)]
    )


def learned_q(exact: Solution, share: float = 0.7) -> FloatArray:
    """Q somewhat below the exact values, a little different in every pair."""
    wobble = 1.0 - 0.05 * np.abs(np.sin(np.arange(len(exact.q), dtype=np.float64)))
    return np.asarray(exact.q * share * wobble)
