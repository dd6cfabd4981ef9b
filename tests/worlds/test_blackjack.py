"""The exact table of blackjack."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import gymnasium
import numpy as np
import pytest
from gymnasium.envs.toy_text import blackjack as game
from scipy.special import chdtrc

from rl_tui.agents.exact.solve import solve
from rl_tui.worlds.drawing import CellKind
from rl_tui.worlds.gym.blackjack import CARDS, Hand, dealer_showing
from rl_tui.worlds.gym.section import GymnasiumSection
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

STICK, HIT = 0, 1
RULES = [{}, {"sab": False, "natural": True}, {"sab": False, "natural": False}]


@pytest.fixture(autouse=True)
def quick_cards(monkeypatch):
    """Draw from the same deck, twelve times faster than numpy's choice from a list."""
    assert game.deck == [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 10, 10, 10]
    monkeypatch.setattr(game, "draw_card", lambda generator: game.deck[int(generator.integers(13))])


def table(**kwargs: bool) -> TabularMDP:
    mdp = GymnasiumSection(id="Blackjack-v1", kwargs=kwargs, table=True).build(np.random.default_rng(0)).mdp
    assert mdp is not None
    return mdp


def name_of(environment, observation) -> str:
    total, showing, ace = observation
    natural = sorted(environment.unwrapped.player) == [1, 10]
    return f"{total}, {showing}, {'natural' if natural else 'yes' if ace else 'no'}"


def steps(kwargs, episodes: int, seed: int) -> Iterator[tuple[str, int, str, float]]:
    """Play at random and yield state, action, next state (for ends: their reward) and reward."""
    environment = gymnasium.make("Blackjack-v1", disable_env_checker=True, **kwargs)
    generator = np.random.default_rng(seed)
    observation, _ = environment.reset(seed=seed)
    for _ in range(episodes):
        over = False
        while not over:
            state, action = name_of(environment, observation), int(generator.random() < 0.5)
            observation, reward, over, _, _ = environment.step(action)
            after = (
                ("lost", "drew", "won")[int(np.sign(reward)) + 1]
                if over
                else name_of(environment, observation)
            )
            yield state, action, after, float(reward)
        observation, _ = environment.reset()


def unlikely(counts: np.ndarray, expected: np.ndarray) -> float:
    """Return the probability of a χ² at least as large. Rare cells are combined."""
    rare = expected < 5.0
    if rare.any():
        counts = np.append(counts[~rare], counts[rare].sum())
        expected = np.append(expected[~rare], expected[rare].sum())
    there = expected > 0.0
    statistic = float((((counts - expected) ** 2)[there] / expected[there]).sum())
    return float(chdtrc(max(1, int(there.sum()) - 1), statistic))


@pytest.mark.parametrize("kwargs", RULES)
def test_outcomes_are_as_frequent_as_the_table_says(kwargs):
    mdp = table(**kwargs)
    number = {name: state for state, name in enumerate(mdp.state_names)}
    seen: dict[int, Counter[tuple[int, float]]] = {}
    for state, action, after, reward in steps(kwargs, 8_000, seed=1):
        pair = int(mdp.first_pair[number[state]]) + action
        seen.setdefault(pair, Counter())[number[after], reward] += 1
    statistic = cells = 0.0
    for pair, counter in seen.items():
        outcomes = list(mdp.outcomes_of(pair))
        keys = [(int(mdp.next_state[o]), float(mdp.reward[o])) for o in outcomes]
        assert set(counter) <= set(keys), mdp.state_names[mdp.state_of(pair)]
        times = sum(counter.values())
        expected = times * mdp.probability[outcomes]
        if len(outcomes) > 1 and expected.min() >= 1.0:
            counts = np.array([counter[key] for key in keys])
            statistic += float(((counts - expected) ** 2 / expected).sum())
            cells += len(outcomes) - 1
    assert cells > 300
    assert chdtrc(cells, statistic) > 1e-3


def test_deals_are_as_frequent_as_the_table_says():
    mdp, environment = table(), gymnasium.make("Blackjack-v1", disable_env_checker=True)
    dealt = Counter(name_of(environment, environment.reset(seed=seed)[0]) for seed in range(5_000))
    names = [mdp.state_names[state] for state in mdp.start_state]
    assert set(dealt) <= set(names)
    counts = np.array([dealt[name] for name in names])
    assert unlikely(counts, 5_000 * mdp.start_probability) > 1e-3


def test_sizes():
    mdp = table()
    assert (mdp.states, mdp.pairs, mdp.action_names) == (293, 580, ("stick", "hit"))
    assert mdp.start_probability.sum() == pytest.approx(1.0)
    assert mdp.state_names[-3:] == ("won", "drew", "lost")


@pytest.mark.parametrize(("showing", "bust"), [(6, 0.4231), (10, 0.2121), (1, 0.1153)])
def test_how_often_the_dealer_goes_bust(showing, bust):
    """The known value for an infinite deck and a dealer who stands on soft 17."""
    ends = dealer_showing(showing)
    assert sum(ends.values()) == pytest.approx(1.0)
    assert sum(p for hand, p in ends.items() if hand.sum > 21) == pytest.approx(bust, abs=1e-4)


def test_hands():
    assert Hand(10, False).with_card(1) == Hand(21, True)
    assert Hand(11, False).with_card(1) == Hand(12, False)
    assert Hand(17, True).with_card(10) == Hand(17, False)
    assert Hand(20, True).with_card(1) == Hand(21, True)
    assert Hand(20, False).with_card(10).sum == 30


def threshold(mdp: TabularMDP, greedy: np.ndarray, showing: int, ace: str) -> int:
    sticks = []
    for total in range(21, 10, -1):
        name = f"{total}, {showing}, {ace}"
        if name in mdp.state_names:
            state = mdp.state_names.index(name)
            if not greedy[mdp.first_pair[state] + STICK]:
                break
            sticks.append(total)
    return sticks[-1]


def test_the_optimal_policy_is_that_of_figure_5_2():
    mdp = table()
    greedy = solve(mdp, 1.0).greedy
    hard = [threshold(mdp, greedy, showing, "no") for showing in CARDS]
    soft = [threshold(mdp, greedy, showing, "yes") for showing in CARDS]
    assert hard == [17, 13, 13, 12, 12, 12, 17, 17, 17, 17]
    # the ace is the "notch" that the book remarks on
    assert soft == [19, 18, 18, 18, 18, 18, 18, 18, 19, 19]


@pytest.mark.parametrize(("kwargs", "value"), zip(RULES, [-0.043113, -0.025729, -0.046556], strict=True))
def test_what_a_game_is_worth(kwargs, value):
    """Our own number, consistent with 2,000 games of the optimal policy."""
    mdp = table(**kwargs)
    solution = solve(mdp, 1.0)
    assert solution.value_at_start == pytest.approx(value, abs=1e-6)
    environment = gymnasium.make("Blackjack-v1", disable_env_checker=True, **kwargs)
    number = {name: state for state, name in enumerate(mdp.state_names)}
    returns = []
    for number_of in range(2_000):
        observation, _ = environment.reset(seed=9 if number_of == 0 else None)
        over = False
        while not over:
            pair = mdp.first_pair[number[name_of(environment, observation)]]
            action = STICK if solution.greedy[pair + STICK] else HIT
            observation, reward, over, _, _ = environment.step(action)
        returns.append(float(reward))
    error = np.std(returns, ddof=1) / np.sqrt(len(returns))
    assert abs(np.mean(returns) - value) < 4 * error


def test_how_it_is_drawn():
    world = GymnasiumSection(id="Blackjack-v1", table=True).build(np.random.default_rng(0))
    grid, names = world.drawing, world.space.state_names
    place = {name: divmod(cell, grid.columns) for name, cell in zip(names, grid.cell_of_state, strict=True)}
    assert (grid.rows, grid.columns) == (19, 21)
    assert len(set(grid.cell_of_state)) == len(names)
    assert (place["21, 1, no"], place["4, 10, no"], place["12, 1, yes"]) == ((1, 0), (18, 9), (10, 11))
    assert place["21, 3, natural"] == (0, 13)
    assert [grid.kinds[grid.cell_of_state[names.index(end)]] for end in ("won", "lost")] == [
        CellKind.GOAL,
        CellKind.HOLE,
    ]


def test_the_stepped_game_has_the_same_names():
    mdp = table()
    stepped = set(GymnasiumSection(id="Blackjack-v1").build(np.random.default_rng(0)).space.state_names)
    assert {name for name in mdp.state_names if name.endswith(("yes", "no"))} <= stepped
