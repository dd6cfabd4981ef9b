"""Scenarios as environments of Gymnasium."""

from __future__ import annotations

from collections import Counter

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from scipy.special import chdtrc
from shipped import SCENARIOS, SHIPPED

from rl_tui.agents.exact.solve import solve
from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.worlds.environments.registration import spec_of
from rl_tui.worlds.environments.scenario_env import ScenarioEnv
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.files.shipped import shipped_folder

BY_TABLE = [each.id for each in SCENARIOS if each.build(streams(0).world).mdp is not None]
STEPPED = sorted(set(SHIPPED) - set(BY_TABLE))
DRAWS = 200
CRACK = """
[[mdp.transition]]
state = "Clock 1"
action = "crack"
reward = -10.0
to = "Plate"
"""
LEAST_PLAUSIBLE = 0.001


@pytest.fixture(autouse=True)
def _advice_is_given(monkeypatch):
    """Enable Gymnasium's warnings, which fail a test, even if something silenced them."""
    monkeypatch.setattr(gymnasium.logger, "min_level", gymnasium.logger.WARN)


def outcomes(mdp, pair):
    expected = Counter()
    for o in mdp.outcomes_of(pair):
        expected[int(mdp.next_state[o]), float(mdp.reward[o]), bool(mdp.terminated[o])] += mdp.probability[o]
    return expected


def episode_of(environment, seed, steps=60):
    seen = [environment.reset(seed=seed)[0]]
    for step in range(steps):
        state, reward, terminated, truncated, _ = environment.step(step % environment.action_space.n)
        seen.append((state, reward, terminated, truncated))
        if terminated or truncated:
            seen.append(environment.reset()[0])
    return seen


@pytest.mark.parametrize("name", SHIPPED)
def test_gymnasiums_own_check_finds_nothing(name):
    check_env(gymnasium.make(f"rl_tui/{name}-v0").unwrapped)


@pytest.mark.parametrize("name", SHIPPED)
def test_states_actions_and_time_limit_are_the_scenarios(name):
    environment = gymnasium.make(f"rl_tui/{name}-v0")
    space = find(name).build(streams(0).world).space
    assert environment.observation_space == gymnasium.spaces.Discrete(space.states)
    assert environment.action_space == gymnasium.spaces.Discrete(len(space.action_names))
    assert environment.spec.max_episode_steps == (space.time_limit or None)
    assert hasattr(environment.unwrapped, "P") == (name in BY_TABLE)
    assert hasattr(environment.unwrapped, "initial_state_distrib") == (name in BY_TABLE)


@pytest.mark.parametrize("name", BY_TABLE)
def test_the_table_is_ours(name):
    environment = ScenarioEnv(name)
    mdp, table = find(name).build(streams(0).world).mdp, environment.P
    assert environment.initial_state_distrib @ np.arange(mdp.states) == pytest.approx(
        mdp.start_probability @ mdp.start_state
    )
    assert environment.initial_state_distrib.sum() == pytest.approx(1.0)
    for state in range(mdp.states):
        pairs = mdp.pairs_of(state)
        assert list(table[state]) == list(range(len(mdp.action_names)))
        if not pairs:
            assert all(entries == [(1.0, state, 0.0, True)] for entries in table[state].values())
            continue
        for action, entries in table[state].items():
            pair = mdp.pair_of(state, action)
            pair = pairs[0] if pair is None else pair
            here = mdp.outcomes_of(pair)
            assert entries == [
                (mdp.probability[o], mdp.next_state[o], mdp.reward[o], mdp.terminated[o]) for o in here
            ]


@pytest.mark.parametrize("name", ["frozenlake-slippery", "student", "book", "bandit-bernoulli", "windy-king"])
def test_what_happens_has_our_probabilities(name):
    environment = ScenarioEnv(name)
    environment.reset(seed=5)
    mdp = environment.world.mdp
    statistic = freedom = 0.0
    for pair in range(mdp.pairs):
        expected, observed = outcomes(mdp, pair), Counter()
        for _ in range(DRAWS):
            environment.s = mdp.state_of(pair)
            state, reward, terminated, truncated, info = environment.step(int(mdp.pair_action[pair]))
            observed[state, reward, terminated] += 1
            assert not truncated
            assert 0.0 < info["prob"] <= expected[state, reward, terminated] + 1e-12
        statistic += sum((observed[key] - DRAWS * p) ** 2 / (DRAWS * p) for key, p in expected.items() if p)
        freedom += sum(p > 0.0 for p in expected.values()) - 1
    assert chdtrc(freedom, statistic) > LEAST_PLAUSIBLE if freedom else statistic == 0


def test_episodes_start_where_ours_do():
    environment = ScenarioEnv("taxi")
    expected = environment.initial_state_distrib * 6_000
    environment.reset(seed=3)
    observed = np.bincount([environment.reset()[0] for _ in range(6_000)], minlength=len(expected))
    possible = expected > 0
    assert not observed[~possible].any()
    statistic = ((observed - expected)[possible] ** 2 / expected[possible]).sum()
    assert chdtrc(possible.sum() - 1, statistic) > LEAST_PLAUSIBLE


@pytest.mark.parametrize(
    "name", ["frozenlake-slippery", "student", "taxi", "bandit", "bandit-drifting", *STEPPED]
)
def test_the_same_seed_gives_the_same_episodes(name):
    one, other = gymnasium.make(f"rl_tui/{name}-v0"), gymnasium.make(f"rl_tui/{name}-v0")
    first = episode_of(one, 7)
    assert first == episode_of(other, 7)
    assert first == episode_of(one, 7)
    assert first != episode_of(one, 8)


def test_the_seed_of_the_scenario_draws_the_arms():
    means = [[entries[0][2] for entries in ScenarioEnv("bandit", seed).P[0].values()] for seed in (0, 0, 1)]
    assert means[0] == means[1] != means[2]
    assert means[2] == find("bandit").build(streams(1).world).mdp.expected_reward.tolist()


def test_rewards_have_the_noise_of_the_scenario():
    environment = gymnasium.make("rl_tui/bandit-v0")
    environment.reset(seed=1)
    mean = environment.unwrapped.P[0][3][0][2]
    pulls = [environment.step(3) for _ in range(4_000)]
    assert all(terminated and not truncated for _, _, terminated, truncated, _ in pulls)
    rewards = np.array([reward for _, reward, *_ in pulls])
    assert rewards.mean() == pytest.approx(mean, abs=4 / np.sqrt(4_000))
    assert rewards.std() == pytest.approx(1.0, abs=0.05)


def test_arms_drift_over_episodes_until_a_seed_takes_them_back():
    environment = ScenarioEnv("bandit-drifting")
    environment.reset(seed=1)
    for _ in range(20_000):
        environment.step(0)
        environment.reset()
    late = np.mean([environment.step(0)[1] for _ in range(200)])
    environment.reset(seed=1)
    early = np.mean([environment.step(0)[1] for _ in range(200)])
    assert early == pytest.approx(environment.P[0][0][0][2], abs=0.5)
    assert abs(late - early) > 0.5


def test_a_time_limit_truncates_and_an_end_terminates():
    environment = gymnasium.make("rl_tui/frozenlake-v0")
    environment.reset(seed=0)
    ends = [environment.step(0)[2:4] for _ in range(100)]  # left, against the edge
    assert ends == [(False, False)] * 99 + [(False, True)]
    environment.reset()
    assert [environment.step(action)[2:4] for action in (1, 2)] == [(False, False), (True, False)]
    assert gymnasium.make("rl_tui/frozenlake-v0", max_episode_steps=300).spec.max_episode_steps == 300


def test_an_action_that_is_not_legal_does_what_the_first_legal_one_does():
    environment = ScenarioEnv("student")
    state, info = environment.reset(seed=0)
    assert info["action_mask"].dtype == np.int8
    assert info["action_mask"].tolist() == [1, 1, 0, 0, 0]
    assert environment.P[state][4] == environment.P[state][0] != environment.P[state][1]
    table = environment.P
    for seed in range(5):
        environment.reset(seed=seed)
        legal = environment.step(0)[:4]
        environment.reset(seed=seed)
        assert environment.step(4)[:4] == legal
        assert legal[0] in {entry[1] for entry in table[state][0]}
    with pytest.raises(gymnasium.error.InvalidAction, match="from 0 to 4"):
        environment.step(5)


def test_a_world_without_a_table_tells_which_actions_are_legal(tmp_path):
    text = (shipped_folder() / "egg.toml").read_text(encoding="utf-8")
    (tmp_path / "mine.toml").write_text(text + CRACK, encoding="utf-8")
    environment = ScenarioEnv(tmp_path / "mine.toml")
    found = {environment.reset(seed=seed)[0]: environment.reset(seed=seed)[1] for seed in range(10)}
    assert {state: info["action_mask"].tolist() for state, info in found.items()} == {
        0: [1, 1, 1],
        3: [1, 1, 0],
    }
    assert "prob" not in found[0]
    pot = next(seed for seed in range(10) if environment.reset(seed=seed)[0] == 3)
    environment.reset(seed=pot)
    assert environment.step(2)[:2] == (3, -1.0)  # unavailable: it waits


def test_the_table_is_made_once():
    environment = ScenarioEnv("frozenlake")
    assert environment.P is environment.P
    environment.P[0][1][0] = (1.0, 15, 1.0, True)
    environment.reset(seed=0)
    assert environment.step(1)[:3] == (4, 0.0, False)


@pytest.mark.parametrize("mode", ["sync", "async"])
def test_several_at_once_step_side_by_side(mode):
    environments = gymnasium.make_vec("rl_tui/student-v0", num_envs=2, vectorization_mode=mode)
    states, info = environments.reset(seed=1)
    assert states.tolist() == [0, 0]
    assert info["action_mask"].shape == (2, 5)
    states, rewards, *_ = environments.step(np.array([1, 1]))
    assert rewards.shape == (2,)
    environments.close()


def test_after_the_end_nothing_happens():
    environment = ScenarioEnv("frozenlake")
    environment.reset(seed=0)
    environment.s = 5
    assert environment.step(2)[:4] == (5, 0.0, True, False)
    assert "action_mask" not in environment.step(2)[4]


@pytest.mark.parametrize(
    "name", ["frozenlake-slippery", "student", "max-bias", "blackjack-table", "karpathy"]
)
def test_what_is_best_by_the_table_is_best_by_ours(name):
    gamma, environment = 0.9, ScenarioEnv(name)
    table, states = environment.P, environment.observation_space.n
    value = np.zeros(states)
    for _ in range(400):
        value = np.array(
            [
                max(
                    sum(p * (r + gamma * value[to] * (not ended)) for p, to, r, ended in entries)
                    for entries in table[state].values()
                )
                for state in range(states)
            ]
        )
    ours = solve(environment.world.mdp, gamma)
    acting = np.diff(environment.world.mdp.first_pair) > 0
    assert value[acting] == pytest.approx(ours.v[acting], abs=1e-9)


def test_the_world_is_drawn_as_text():
    environment = gymnasium.make("rl_tui/cliff-v0", render_mode="ansi")
    environment.reset(seed=0)
    assert environment.render().splitlines()[-1] == "@CCCCCCCCCCG"
    environment.step(0)
    assert environment.render().splitlines()[-2:] == ["@...........", "SCCCCCCCCCCG"]
    environment = ScenarioEnv("student", render_mode="ansi")
    environment.reset(seed=0)
    environment.step(0)
    assert "study" in environment.render()
    assert ScenarioEnv("student").render() is None


def test_a_scenario_of_ones_own_is_made_by_its_path(tmp_path):
    path = tmp_path / "two steps.toml"
    path.write_text('title = "t"\n[grid]\nmap = """\nS.G\n"""\ntime_limit = 9\n', encoding="utf-8")
    environment = gymnasium.make(spec_of(str(path)))
    assert environment.spec.max_episode_steps == 9
    assert environment.observation_space.n == 3
    with pytest.raises(UserError, match="there is no scenario"):
        gymnasium.make(spec_of("clif"))


def test_making_one_leaves_gymnasiums_advice_as_it_was():
    gymnasium.make("rl_tui/frozenlake-v0")
    assert gymnasium.logger.min_level == gymnasium.logger.WARN


def test_our_own_ids_are_not_read_as_foreign_environments():
    with pytest.raises(UserError, match="is a scenario of rl-tui; name another environment"):
        find("gym:rl_tui/frozenlake-v0")
