"""Our table against the real Gymnasium lake."""

from __future__ import annotations

from collections import Counter

import gymnasium
import numpy as np
import pytest
from scipy.special import chdtrc

from rl_tui.worlds.files.catalogue import find

pytestmark = pytest.mark.slow

STEPS_A_PAIR = 300
LEAST_PLAUSIBLE = 0.001


@pytest.fixture
def lakes(request):
    scenario = find(request.param)
    environment = gymnasium.make(scenario.section.id, **scenario.section.kwargs)
    yield scenario.build(np.random.default_rng(0)).mdp, environment
    environment.close()


def expected_of(mdp, pair):
    expected = Counter()
    for o in mdp.outcomes_of(pair):
        expected[int(mdp.next_state[o]), float(mdp.reward[o]), bool(mdp.terminated[o])] += mdp.probability[o]
    return expected


def drawn(mdp, pair, generator):
    outcome = mdp.outcomes_of(pair)[0]
    draw = generator.random()
    while draw >= mdp.cumulative[outcome]:
        outcome += 1
    return int(mdp.next_state[outcome]), float(mdp.reward[outcome]), bool(mdp.terminated[outcome])


def chi_squared(observed, expected):
    total = sum(observed.values())
    statistic = sum((observed[key] - total * p) ** 2 / (total * p) for key, p in expected.items())
    return statistic, len(expected) - 1


@pytest.mark.exhaustive("steps for hundreds of thousands of times")
@pytest.mark.parametrize(
    "lakes", ["frozenlake", "frozenlake-slippery", "frozenlake-8x8", "frozenlake-8x8-slippery"], indirect=True
)
def test_frequencies_agree_in_every_pair(lakes):
    mdp, environment = lakes
    real = environment.unwrapped
    real.reset(seed=11)
    generator = np.random.default_rng(12)
    statistics = {"real": [], "ours": []}
    for pair in range(mdp.pairs):
        expected = expected_of(mdp, pair)
        observed = {"real": Counter(), "ours": Counter()}
        for _ in range(STEPS_A_PAIR):
            real.s = int(mdp.pair_state[pair])
            next_state, reward, terminated, _, _ = real.step(int(mdp.pair_action[pair]))
            observed["real"][int(next_state), float(reward), bool(terminated)] += 1
            observed["ours"][drawn(mdp, pair, generator)] += 1
        for side, counts in observed.items():
            assert counts.keys() <= expected.keys(), "an outcome that the table calls impossible"
            statistics[side].append(chi_squared(counts, expected))
    for parts in statistics.values():
        statistic, freedom = np.sum(parts, axis=0)
        assert chdtrc(freedom, statistic) > LEAST_PLAUSIBLE if freedom else statistic == 0


@pytest.mark.parametrize("lakes", ["frozenlake", "frozenlake-8x8"], indirect=True)
def test_on_dry_ice_the_same_actions_give_the_same_episodes(lakes):
    mdp, environment = lakes
    actions = np.random.default_rng(3)
    for _ in range(40):
        state, _ = environment.reset(seed=0)
        assert state == mdp.start_state[0]
        ended, step = False, 0
        while not ended:
            action = int(actions.integers(4))
            pair = mdp.pairs_of(int(state))[action]
            (outcome,) = mdp.outcomes_of(pair)
            state, reward, terminated, truncated, _ = environment.step(action)
            step += 1
            ended = terminated or truncated
            assert (state, reward, terminated) == (
                mdp.next_state[outcome],
                mdp.reward[outcome],
                mdp.terminated[outcome],
            )
            assert truncated == (step == mdp.time_limit)
