"""What the notes of scenarios, and docs/, say that needs no run: it is worked out from the table."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from policy_worth import evaluate
from recipes import recipe

from rl_tui.agents.exact.policies import greedy_policy, softened, uniform_over
from rl_tui.agents.exact.policy_figures import expected_return
from rl_tui.agents.exact.solve import solve
from rl_tui.lab.run.recipe import begin
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

AGENTS = " ".join((Path(__file__).parents[2] / "docs/agents.md").read_text(encoding="utf-8").split())


def table_of(scenario: str) -> TabularMDP:
    mdp = begin(recipe(scenario)).world.mdp
    assert mdp is not None
    return mdp


def is_said(scenario: str, text: str) -> None:
    assert text in " ".join(find(scenario).notes.split())


def blind(scenario: str, **values: Any) -> float:
    """The chance that an episode pays while all estimates are equal."""
    mdp = table_of(scenario)
    settings = recipe(scenario, **values).hyperparameters
    policy = greedy_policy(mdp, np.zeros(mdp.pairs), settings.ties)
    chance = expected_return(mdp, softened(mdp, policy, settings.epsilon))
    assert chance is not None
    return chance


def test_how_long_the_lake_stays_dark() -> None:
    chance = blind("frozenlake")
    is_said("frozenlake", f"the goal is met in {chance:.1%} of the episodes".replace("%", " %"))
    is_said("frozenlake", f"the first reward comes in episode {1 / chance:.0f} on average")
    is_said("frozenlake", f"by episode {math.ceil(math.log(0.5) / math.log(1 - chance))}")
    is_said(
        "frozenlake", f"{1 - (1 - chance) ** 200:.0%} of all runs find the goal within 200".replace("%", " %")
    )


def test_how_many_who_take_the_first_of_equals_never_see_a_reward() -> None:
    never = (1 - blind("frozenlake", ties="first")) ** 10_000
    share = f"{never:.1%}".replace("%", " %")
    is_said("frozenlake", f"{share} of all runs see no reward at all in 10,000 episodes")
    assert f"{share} of all runs never see the goal in 10,000 episodes" in AGENTS


@pytest.mark.parametrize(
    ("scenario", "ties"), [("frozenlake-8x8", "random"), ("frozenlake-slippery", "first")]
)
def test_when_the_first_reward_comes(scenario: str, ties: str) -> None:
    text = {
        "random": "first reward? {:,.0f} on average",
        "first": "first reward comes in episode {:,.0f} on average",
    }
    is_said(scenario, text[ties].format(1 / blind(scenario, ties=ties)))


def by_row(mdp: TabularMDP, row: int) -> FloatArray:
    """Of the cliff: up to ``row``, right along it, and down at the goal's column."""
    moves = {name: action for action, name in enumerate(mdp.action_names)}
    policy = np.zeros(mdp.pairs)
    for state in range(mdp.states):
        pairs = mdp.pairs_of(state)
        if pairs:
            down, below = state % 12 == 11, state // 12 > row
            policy[pairs.start + moves["down" if down else "up" if below else "right"]] = 1.0
    return policy


def best_softened(mdp: TabularMDP, epsilon: float) -> tuple[float | None, float | None]:
    """The return of the best policy that explores so much, and of its path without exploration."""
    policy = by_row(mdp, 0)
    outcome_pair = np.repeat(np.arange(mdp.pairs), np.diff(mdp.first_outcome))
    for _ in range(20):  # policy iteration among policies that explore
        v = evaluate(mdp, softened(mdp, policy, epsilon), 1.0).v
        after = mdp.reward + np.where(mdp.terminated, 0.0, v[mdp.next_state])
        q = np.bincount(outcome_pair, weights=mdp.probability * after, minlength=mdp.pairs)
        policy = greedy_policy(mdp, np.round(q, 9), "first")
    return evaluate(mdp, softened(mdp, policy, epsilon), 1.0).at_start, expected_return(mdp, policy)


def test_one_row_from_the_edge_is_enough_for_one_random_action_in_ten() -> None:
    mdp = table_of("cliff")
    best, path = best_softened(mdp, 0.1)
    assert path == -15.0
    is_said("cliff", f"15 steps and {best:.2f} an episode".replace("-", "−"))
    top = evaluate(mdp, softened(mdp, by_row(mdp, 0), 0.1), 1.0).at_start
    assert expected_return(mdp, by_row(mdp, 0)) == -17.0
    is_said("cliff", f"Round by the top, 17 steps, it is {top:.2f}".replace("-", "−"))


def test_the_top_is_right_for_two_random_actions_in_ten() -> None:
    is_said("cliff", "With ε = 0.2 the top is right")
    assert best_softened(table_of("cliff"), 0.2)[1] == -17.0


def test_two_arrows_of_the_textbook_turn_with_the_discount() -> None:
    is_said("book", "two arrows of the lowest row turn, one from ← to →, the other from ← to ↑")
    mdp = table_of("book")
    patient, hasty = (solve(mdp, gamma).greedy for gamma in (1.0, 0.9))
    turned = {
        tuple(
            mdp.action_names[mdp.pair_action[pairs.start + int(np.argmax(each[pairs.start : pairs.stop]))]]
            for each in (patient, hasty)
        )
        for pairs in map(mdp.pairs_of, range(mdp.states))
        if (patient[pairs.start : pairs.stop] != hasty[pairs.start : pairs.stop]).any()
    }
    assert turned == {("left", "right"), ("left", "up")}


def test_at_gamma_1_the_student_who_always_checks_the_phone_gets_nothing() -> None:
    is_said("student", "*check phone* is worth 7.5 as *study* is")
    is_said("student", "never sleeps, and gets 0")
    mdp = table_of("student")
    solution = solve(mdp, 1.0)
    study, check_phone = mdp.pairs_of(0)
    assert solution.q[[study, check_phone]] == pytest.approx([7.5, 7.5], abs=1e-12)
    assert solution.greedy[[study, check_phone]].tolist() == [True, False]
    never_studies = np.where(np.arange(mdp.pairs) == study, 0.0, uniform_over(mdp, solution.best))
    never_studies[check_phone] = 1.0
    assert expected_return(mdp, never_studies) == 0.0


def test_what_an_egg_comes_to_without_a_clock_or_a_memory() -> None:
    is_said("egg", "Always *eat*: −10. Always *wait*: −12.")
    is_said("egg", "waits with probability 0.61 and gets −8.08 on average")
    wait = np.linspace(0.0, 1.0, 10_001)
    prospects = begin(recipe("egg")).world.prospects
    ((_, _, (raw, soft)),) = prospects[7]
    (_, _, (minute,)), (_, _, (hard,)) = prospects[6]
    worth = (1 - wait) * soft + wait * hard
    for _ in range(2):
        worth = (1 - wait) * raw + wait * (minute + worth)
    assert (worth[0], worth[-1]) == (-10.0, -12.0)
    assert wait[worth.argmax()] == pytest.approx(0.61, abs=0.005)
    assert worth.max() == pytest.approx(-8.08, abs=0.005)
