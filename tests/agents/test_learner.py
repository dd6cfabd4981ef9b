"""One learner and its steps, with Q-learning."""

from __future__ import annotations

from itertools import pairwise

import pytest

from rl_tui.agents.hyperparameters import Hyperparameters, Ties
from rl_tui.agents.kernels.position import Stop
from rl_tui.agents.learner import EPISODES_LOGGED, Learner
from rl_tui.common.streams import streams
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp


def learner(mdp: TabularMDP, hyperparameters: Hyperparameters | None = None, seed: int = 0) -> Learner:
    return Learner(mdp, "q-learning", hyperparameters or Hyperparameters(), streams(seed))


def one_state(rewards: list[float], std: float = 0.0, time_limit: int = 0) -> TabularMDP:
    return tabular_mdp(
        ["here"],
        [str(arm) for arm in range(len(rewards))],
        [Transition(0, arm, [Outcome(1.0, 0, reward, True, std)]) for arm, reward in enumerate(rewards)],
        {0: 1.0},
        time_limit,
    )


def endless(reward: float = 1.0, time_limit: int = 0) -> TabularMDP:
    return tabular_mdp(
        ["here"], ["stay"], [Transition(0, 0, [Outcome(1.0, 0, reward, False)])], {0: 1.0}, time_limit
    )


def test_exploration_picks_every_legal_action_equally_the_greedy_one_included() -> None:
    ours = learner(one_state([0.0, 1.0, 0.0, 0.0]), Hyperparameters(alpha=1.0, epsilon=0.4))
    ours.advance(4000)
    assert ours.q.tolist() == [0.0, 1.0, 0.0, 0.0]
    assert ours.visits.tolist() == pytest.approx([400, 2800, 400, 400], abs=100)


@pytest.mark.parametrize(("ties", "pulled"), [("random", [1000] * 4), ("first", [4000, 0, 0, 0])])
def test_ties_are_broken_as_asked(ties: Ties, pulled: list[int]) -> None:
    ours = learner(one_state([0.0] * 4), Hyperparameters(epsilon=0.0, ties=ties))
    ours.advance(4000)
    assert ours.visits.tolist() == pytest.approx(pulled, abs=150)


def test_only_exact_equality_is_a_tie() -> None:
    ours = learner(one_state([0.0, 1e-15]), Hyperparameters(alpha=1.0, epsilon=0.0, initial_q=1e-15))
    ours.advance(100)
    assert ours.visits[0] in (0, 1)
    assert ours.visits.sum() == 100


def test_the_last_step_holds_the_numbers_of_its_update() -> None:
    ours = learner(endless(reward=2.0), Hyperparameters(alpha=0.25, gamma=0.5, initial_q=4.0))
    ours.advance(1)
    last = ours.last_step
    assert (last.step, last.episode, last.state, last.pair, last.next_state) == (1, 1, 0, 0, 0)
    assert (last.before, last.bootstrap, last.target, last.td_error) == (4.0, 4.0, 4.0, 0.0)
    assert last.after == last.before + last.step_size * last.td_error


def test_a_change_acts_from_the_next_step() -> None:
    ours = learner(endless(reward=1.0), Hyperparameters(alpha=0.5, gamma=0.0))
    ours.advance(1)
    ours.configure(Hyperparameters(alpha=1.0, gamma=0.0))
    ours.advance(1)
    assert ours.q.tolist() == [1.0]


def test_episodes_are_counted_and_never_lost() -> None:
    ours = learner(one_state([1.0]))
    asked = EPISODES_LOGGED + 10
    assert ours.advance(asked) is Stop.EPISODES_FULL
    assert ours.advance(10) is Stop.EPISODES_FULL
    assert ours.episodes == EPISODES_LOGGED
    assert len(ours.drain_episodes().returns) == EPISODES_LOGGED
    assert ours.advance(asked - ours.step) is Stop.DONE
    assert len(ours.drain_episodes().lengths) == 10
    assert ours.advance(10**6, episodes=3) is Stop.DONE
    assert ours.drain_episodes().lengths.tolist() == [1, 1, 1]


def test_a_runaway_stops_and_names_its_step() -> None:
    ours = learner(endless(reward=1e11), Hyperparameters(alpha=1.0, gamma=1.0))
    assert ours.advance(1000) is Stop.DIVERGED
    assert ours.step == 11
    assert "Q(here, stay)" in ours.stop_reason
    assert "step 11" in ours.stop_reason
    assert ours.advance(1) is Stop.DIVERGED
    assert ours.step == 11


def test_an_endless_episode_stops_after_ten_million_steps() -> None:
    ours = learner(endless(reward=0.0))
    assert ours.advance(10**9) is Stop.ENDLESS_EPISODE
    assert ours.step == 10**7
    assert "episode 1 " in ours.stop_reason


def test_seeds_give_different_runs_and_the_same_seed_the_same() -> None:
    mdp = one_state([0.0] * 4, std=1.0)
    tables = []
    for seed in (0, 1, 1):
        ours = learner(mdp, seed=seed)
        ours.advance(100)
        tables.append(ours.q.tobytes())
    assert [one == other for one, other in pairwise(tables)] == [False, True]
