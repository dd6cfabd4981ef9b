"""What a graph view has to place: boxes, actions and their labels, free of any size."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

from rl_tui.lab.live.until import Breakpoints
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.worlds.drawing import Graph
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


class Node(NamedTuple):
    """A state: its name, its place (column, row) and whether nothing can be done there."""

    name: str
    column: int
    row: int
    terminal: bool


class GraphBranch(NamedTuple):
    """Where an action may lead. ``label`` is empty where the label of the action says it all."""

    target: int
    probability: float
    label: str


class GraphAction(NamedTuple):
    """One pair, with one branch for each state that it may lead to, the likeliest first."""

    pair: int
    source: int
    name: str
    label: str
    branches: tuple[GraphBranch, ...]


@dataclass(frozen=True, slots=True)
class GraphShape:
    """The states and pairs of an MDP, labelled for people."""

    nodes: tuple[Node, ...]
    actions: tuple[GraphAction, ...]


NO_BREAKPOINTS: Final = Breakpoints()


class Signs(NamedTuple):
    """What is marked in a graph besides its values: the states of agent and cursor, and the breakpoints.

    ``cursor`` is None where no cursor is to be seen. ``differing`` are the states whose greedy actions are
    others in the lane beside.
    """

    agent: int
    cursor: int | None = None
    breakpoints: Breakpoints = NO_BREAKPOINTS
    differing: frozenset[int] = frozenset()


def graph_shape(mdp: TabularMDP, graph: Graph, glyphs: Glyphs) -> GraphShape:
    """Return the shape of ``mdp``. Columns and rows that ``graph`` leaves empty are left out."""
    columns = sorted({column for column, _ in graph.places})
    rows = sorted({row for _, row in graph.places})
    nodes = tuple(
        Node(to_ascii(name, glyphs), columns.index(column), rows.index(row), not mdp.pairs_of(state))
        for state, (name, (column, row)) in enumerate(zip(mdp.state_names, graph.places, strict=True))
    )
    actions = tuple(
        _action(mdp, state, pair, glyphs) for state in range(mdp.states) for pair in mdp.pairs_of(state)
    )
    return GraphShape(nodes, actions)


def _action(mdp: TabularMDP, state: int, pair: int, glyphs: Glyphs) -> GraphAction:
    name = to_ascii(mdp.action_names[int(mdp.pair_action[pair])], glyphs)
    probabilities: dict[int, float] = {}
    rewards: dict[int, float] = {}
    for outcome in mdp.outcomes_of(pair):
        target, probability = int(mdp.next_state[outcome]), float(mdp.probability[outcome])
        probabilities[target] = probabilities.get(target, 0.0) + probability
        rewards[target] = rewards.get(target, 0.0) + probability * float(mdp.reward[outcome])
    # r(s, a, s′), equation 3.6: outcomes that lead to the same state share an edge
    texts = {target: reward_text(rewards[target] / probabilities[target], glyphs) for target in rewards}
    targets = sorted(probabilities, key=lambda target: -probabilities[target])
    if len(set(texts.values())) == 1:
        label = f"{name} {texts[targets[0]]}"
        texts = dict.fromkeys(texts, "")
    else:
        label = name
    branches = tuple(
        GraphBranch(
            target,
            probabilities[target],
            f"{probability_text(probabilities[target])} {texts[target]}".strip() if len(targets) > 1 else "",
        )
        for target in targets
    )
    return GraphAction(pair, state, name, label, branches)


def reward_text(reward: float, glyphs: Glyphs) -> str:
    """Return a reward with its sign, in three significant digits: +10, −2, 0."""
    return f"{reward:+.3g}".replace("-", glyphs.minus) if reward else "0"


def probability_text(probability: float) -> str:
    """Return a probability in two decimals, more where it is close to 0 or 1: .8, .33, .005."""
    for decimals in (2, 3, 4, 5):
        rounded = round(probability, decimals)
        if 0.0 < rounded < 1.0 and abs(rounded - probability) < 0.02 * min(probability, 1.0 - probability):
            return f"{rounded:.{decimals}f}".strip("0")
    return "1" if probability > 0.5 else f"{probability:.0e}"
