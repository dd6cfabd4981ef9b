"""Claims in the notes of scenarios that tests/said/ cannot express."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numbers_said import copied
from recipes import recipe

from rl_tui.agents.exact.policy_figures import expected_return, figures, uniform_over
from rl_tui.agents.exact.solve import solve
from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import begin
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.files.scenario import scenario_of
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def table_of(scenario: str) -> TabularMDP:
    mdp = begin(recipe(scenario)).world.mdp
    assert mdp is not None
    return mdp


def is_said(scenario: str, text: str) -> None:
    assert text in " ".join(find(scenario).notes.split())


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
    is_said("egg", "If it always eats, it gets −10. If it always waits, it gets −12.")
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


@pytest.mark.parametrize(
    ("row", "first", "far"),
    [
        ("0.3 0 0 the near reward, along the cliff", "right", False),
        ("0.4 0.2 0 the near reward, round by the top", "up", False),
        ("0.9 0 0 the far reward, along the cliff", "right", True),
        ("0.9 0.2 0 the far reward, round by the top", "up", True),
        ("0.9 0.2 1.5 never to leave", None, None),
    ],
)
def test_what_is_best_depends_on_three_numbers(row: str, first: str | None, far: bool | None) -> None:
    is_said("discount", row)
    gamma, noise, pay = row.split()[:3]
    text = copied(find("discount"), {"noise": noise, "step_reward": pay})
    mdp = begin(recipe_for(scenario_of(text, Path("discount.toml")), {}, 0)).world.mdp
    assert mdp is not None
    solution = solve(mdp, float(gamma))
    policy = uniform_over(mdp, solution.greedy)
    found = figures(mdp, policy, float(gamma))
    if first is None:
        assert found.ends < 0.01  # it sometimes slips off
        return
    start = mdp.pairs_of(mdp.state_names.index("28"))
    best = [mdp.action_names[mdp.pair_action[pair]] for pair in start if solution.greedy[pair]]
    assert best == [first]
    assert found.expected_return is not None
    assert (found.expected_return > 5.0) is far  # of 1 near and 10 far, minus the cost of slips
