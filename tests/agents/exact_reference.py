"""Exact values of small worlds, in fractions or by long sweeps."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from fractions import Fraction

import gymnasium
from hypothesis import strategies as st

from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp


def lake(map_name: str, slippery: bool, time_limit: int = 0) -> TabularMDP:
    table = gymnasium.make("FrozenLake-v1", map_name=map_name, is_slippery=slippery).unwrapped.P
    transitions = [
        Transition(
            state, action, [Outcome(p, to, float(reward), bool(end)) for p, to, reward, end in outcomes]
        )
        for state, actions in table.items()
        for action, outcomes in actions.items()
    ]
    names = [str(state) for state in table]
    return tabular_mdp(names, ["left", "down", "right", "up"], transitions, {0: 1.0}, time_limit)


def world(
    *pairs: tuple[str, str, Sequence[tuple[float, str, float]]],
    start: dict[str, float] | None = None,
    time_limit: int = 0,
) -> TabularMDP:
    """Make a world of (state, action, [(probability, next state, reward)]). All other states are terminal."""
    states = list(dict.fromkeys([pair[0] for pair in pairs] + [o[1] for pair in pairs for o in pair[2]]))
    actions = list(dict.fromkeys(pair[1] for pair in pairs))
    transitions = [
        Transition(
            states.index(state),
            actions.index(action),
            [Outcome(p, states.index(to), reward, False) for p, to, reward in outcomes],
        )
        for state, action, outcomes in pairs
    ]
    given = start or {pairs[0][0]: 1.0}
    begin = {states.index(state): probability for state, probability in given.items()}
    return tabular_mdp(states, actions, transitions, begin, time_limit)


def student(time_limit: int = 100) -> TabularMDP:
    return world(
        ("Class", "study", [(0.8, "Pass", -2.0), (0.2, "Class", -2.0)]),
        ("Class", "check phone", [(1.0, "Phone", 0.0)]),
        ("Phone", "scroll", [(1.0, "Phone", -1.0)]),
        ("Phone", "quit", [(1.0, "Class", 0.0)]),
        ("Pass", "sleep", [(1.0, "Sleep", 10.0)]),
        time_limit=time_limit,
    )


SPLITS = ([1.0], [0.5, 0.5], [0.25, 0.75], [0.25, 0.25, 0.5])


@st.composite
def worlds(draw: st.DrawFn, largest_reward: int = 3, states: int = 4, time_limit: int = 0) -> TabularMDP:
    """Draw probabilities exact in binary: a loop that pays 0 on average pays exactly 0."""
    count = draw(st.integers(1, states))
    rewards = st.integers(-largest_reward, largest_reward)
    transitions = []
    for state in range(count):
        for action in draw(st.sets(st.integers(0, 2), min_size=1)):
            outcomes = [
                Outcome(p, draw(st.integers(0, count - 1)), float(draw(rewards)), draw(st.booleans()))
                for p in draw(st.sampled_from(SPLITS))
            ]
            transitions.append(Transition(state, action, outcomes))
    start = {0: 1.0} if count == 1 or draw(st.booleans()) else {0: 0.25, 1: 0.75}
    return tabular_mdp([f"s{i}" for i in range(count)], ["a", "b", "c"], transitions, start, time_limit)


@st.composite
def worlds_and_policies(draw: st.DrawFn, time_limit: int = 0) -> tuple[TabularMDP, list[float]]:
    mdp = draw(worlds(time_limit=time_limit))
    policy = []
    for state in live(mdp):
        weights = [draw(st.integers(0, 2)) for _ in mdp.pairs_of(state)]
        weights[draw(st.integers(0, len(weights) - 1))] += 1
        policy += [weight / sum(weights) for weight in weights]
    return mdp, policy


def live(mdp: TabularMDP) -> list[int]:
    return [state for state in range(mdp.states) if mdp.pairs_of(state)]


def probabilities(mdp: TabularMDP, pair: int) -> list[Fraction]:
    given = [Fraction(float(mdp.probability[outcome])) for outcome in mdp.outcomes_of(pair)]
    return [p / sum(given) for p in given]


def deterministic_policies(mdp: TabularMDP) -> Iterator[dict[int, int]]:
    states = live(mdp)
    for choice in itertools.product(*(mdp.pairs_of(state) for state in states)):
        yield dict(zip(states, choice, strict=True))


def solve_rational(matrix: list[list[Fraction]], right: list[Fraction]) -> list[Fraction]:
    """Solve a linear system by Gauss–Jordan elimination. The matrix must have an inverse."""
    rows = [[*row, b] for row, b in zip(matrix, right, strict=True)]
    for column in range(len(rows)):
        pivot = next(i for i in range(column, len(rows)) if rows[i][column] != 0)
        rows[column], rows[pivot] = rows[pivot], rows[column]
        rows[column] = [x / rows[column][column] for x in rows[column]]
        for i, row in enumerate(rows):
            if i != column and row[column] != 0:
                rows[i] = [x - row[column] * y for x, y in zip(row, rows[column], strict=True)]
    return [row[-1] for row in rows]


def rational_values(
    mdp: TabularMDP, policy: dict[int, int], gamma: Fraction, also_ends: int | None = None
) -> dict[int, Fraction]:
    states = list(policy)
    matrix, right = [], []
    for state in states:
        row = [Fraction(int(state == other)) for other in states]
        mean = Fraction(0)
        pair = policy[state]
        for outcome, p in zip(mdp.outcomes_of(pair), probabilities(mdp, pair), strict=True):
            mean += p * Fraction(float(mdp.reward[outcome]))
            to = int(mdp.next_state[outcome])
            if not mdp.terminated[outcome] and to != also_ends:
                row[states.index(to)] -= gamma * p
        matrix.append(row)
        right.append(mean)
    return dict(zip(states, solve_rational(matrix, right), strict=True))


def leads_to(mdp: TabularMDP, pairs: Sequence[int], state: int) -> set[int | None]:
    """Return the states that chance may reach from ``state``. None is the end."""
    found: set[int | None] = {state}
    queue = [state]
    for here in queue:
        for pair in set(pairs) & set(mdp.pairs_of(here)):
            for outcome in mdp.outcomes_of(pair):
                to = None if mdp.terminated[outcome] else int(mdp.next_state[outcome])
                if to not in found:
                    found.add(to)
                    if to is not None:
                        queue.append(to)
    return found


def recurrent(mdp: TabularMDP, pairs: Sequence[int], state: int) -> bool:
    reach = leads_to(mdp, pairs, state)
    return None not in reach and all(state in leads_to(mdp, pairs, other) for other in reach)


def best_rational(mdp: TabularMDP, gamma: Fraction) -> dict[int, Fraction] | None:
    """Return the largest values over all deterministic policies; at γ = 1 only those that end."""
    best: dict[int, Fraction] = {}
    for policy in deterministic_policies(mdp):
        pairs = list(policy.values())
        if gamma == 1:
            loops = [state for state in policy if recurrent(mdp, pairs, state)]
            if any(gain_of_loop(mdp, policy, state) > 0 for state in loops):
                return None
            if loops:
                continue
        values = rational_values(mdp, policy, gamma)
        best = {state: max(v, best.get(state, v)) for state, v in values.items()}
    return best or None


def gain_of_loop(mdp: TabularMDP, policy: dict[int, int], state: int) -> Fraction:
    inside = {s: policy[s] for s in policy if s in leads_to(mdp, list(policy.values()), state)}
    return rational_values(mdp, inside, Fraction(1), also_ends=state)[state]


def policy_iteration_of_the_box(mdp: TabularMDP, gamma: float, theta: float = 1e-14) -> list[float]:
    """Run the box in Sutton & Barto, 2nd ed., page 80, line by line."""

    def backup(pair: int) -> float:
        return sum(
            float(p) * (mdp.reward[o] + (0.0 if mdp.terminated[o] else gamma * value[mdp.next_state[o]]))
            for o, p in zip(mdp.outcomes_of(pair), probabilities(mdp, pair), strict=True)
        )

    # 1. Initialisation
    value = [0.0] * mdp.states
    policy = {state: mdp.pairs_of(state)[0] for state in live(mdp)}
    while True:
        delta = theta
        while delta >= theta:
            delta = 0.0
            for state in policy:
                before = value[state]
                value[state] = backup(policy[state])
                delta = max(delta, abs(before - value[state]))
        # 3. Policy improvement. The box notes that policies may be equally good: change only for a real gain
        stable = True
        for state in policy:
            best = max(mdp.pairs_of(state), key=backup)
            if backup(best) > backup(policy[state]) + 1e-12:
                policy[state] = best
                stable = False
        if stable:
            return value


def return_within(mdp: TabularMDP, policy: Sequence[float] | None, steps: int) -> float:
    """Return the expected return within ``steps``, without a policy the largest of one with a clock."""
    value = [Fraction(0)] * mdp.states
    for _ in range(steps):
        later = value
        value = [Fraction(0)] * mdp.states
        for state in live(mdp):
            backups = {
                pair: sum(
                    p
                    * (
                        Fraction(float(mdp.reward[o]))
                        + (0 if mdp.terminated[o] else later[mdp.next_state[o]])
                    )
                    for o, p in zip(mdp.outcomes_of(pair), probabilities(mdp, pair), strict=True)
                )
                for pair in mdp.pairs_of(state)
            }
            value[state] = (
                max(backups.values())
                if policy is None
                else sum(Fraction(policy[pair]) * backup for pair, backup in backups.items())
            )
    start = zip(mdp.start_state, mdp.start_probability, strict=True)
    return float(sum(Fraction(float(p)) * value[state] for state, p in start))
