"""Every γ at which the optimal actions change."""

from __future__ import annotations

import itertools
from fractions import Fraction
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from exact_reference import lake, student, world
from plain_flips import disagreements, optimal_pairs, plain_world, small_world
from shipped import SHIPPED

from rl_tui.agents.exact.flips import MOST_STATES, Flip, flips
from rl_tui.agents.exact.policy_evaluation import NoExactAnswer
from rl_tui.agents.exact.policy_figures import expected_return, uniform_over
from rl_tui.agents.exact.solve import solve
from rl_tui.runs.library import recipe_named
from rl_tui.runs.recipe import begin
from rl_tui.worlds.files.shipped import shipped_folder
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

pytestmark = pytest.mark.unit

WITH_FLIPS = {
    "student": 1,
    "frozenlake-slippery": 2,
    "book": 4,
    "discount": 14,
    "frozenlake-8x8-slippery": 25,
}


def table(scenario: str) -> TabularMDP | None:
    return begin(recipe_named(scenario, {}, 0)).world.mdp


@cache
def known(scenario: str) -> tuple[TabularMDP, tuple[Flip, ...]]:
    mdp = table(scenario)
    assert mdp is not None
    return mdp, flips(mdp)


def without_noise(scenario: str, folder: Path) -> TabularMDP:
    text = (shipped_folder() / f"{scenario}.toml").read_text(encoding="utf-8")
    assert "noise = 0.2\n" in text
    file = folder / "steady.toml"
    file.write_text(text.replace("noise = 0.2\n", "noise = 0.0\n"), encoding="utf-8")
    mdp = table(str(file))
    assert mdp is not None
    return mdp


def test_the_student_studies_above_a_quarter() -> None:
    mdp = student()
    (flip,) = flips(mdp)
    assert flip.gamma == 0.25
    assert flip.turns_the_way
    assert flip.expected_return == (0.0, 7.5)
    (turn,) = flip.turns
    assert (turn.state, *map(mdp.pair_name, (*turn.before, *turn.after))) == (
        0,
        "Class, check phone",
        "Class, study",
    )


def test_the_slippery_lake_turns_twice() -> None:
    mdp = lake("4x4", slippery=True, time_limit=100)
    first, second = flips(mdp)
    assert (first.gamma, second.gamma) == pytest.approx((0.808783309216, 0.978316459143), abs=1e-12)
    assert [turn.state for turn in first.turns] == [0, 2]
    assert [(turn.state, turn.before, turn.after) for turn in second.turns] == [
        (2, (mdp.pair_of(2, 0),), (mdp.pair_of(2, 3),))
    ]
    assert first.turns_the_way
    assert second.turns_the_way


def test_a_bridge_without_noise_is_crossed_from_a_root_of_a_tenth_on(tmp_path: Path) -> None:
    found = flips(without_noise("bridge", tmp_path))
    assert [flip.gamma for flip in found] == [pytest.approx(10 ** (-1 / n), rel=1e-15) for n in (2, 4, 6)]
    assert [flip.turns_the_way for flip in found] == [False, False, True]
    assert found[-1].expected_return == (pytest.approx(1.0), pytest.approx(10.0))


def test_one_flip_of_fourteen_turns_the_way_to_the_far_reward() -> None:
    _, found = known("discount")
    assert len(found) == 14
    assert [flip.gamma for flip in found if flip.turns_the_way] == [pytest.approx(0.518845036131, abs=1e-12)]


@pytest.mark.parametrize("scenario", SHIPPED)
def test_shipped_worlds_have_as_many_flips_as_are_known(scenario: str) -> None:
    mdp = table(scenario)
    if mdp is None:
        return
    live = np.count_nonzero(np.diff(mdp.first_pair))
    if live > MOST_STATES:
        with pytest.raises(NoExactAnswer, match=f"100 states with actions; here there are {live}$"):
            flips(mdp)
    else:
        _, found = known(scenario)
        assert len(found) == WITH_FLIPS.get(scenario, 0)
        assert list(found) == sorted(found, key=lambda flip: flip.gamma)


@pytest.mark.parametrize("scenario", ["frozenlake-slippery", "book", "discount", "frozenlake-8x8-slippery"])
def test_on_both_sides_of_a_flip_stands_what_the_planner_finds_there(scenario: str) -> None:
    mdp, found = known(scenario)
    gammas = [0.0, *(flip.gamma for flip in found), 1.0]
    middles = [(lower + upper) / 2 for lower, upper in itertools.pairwise(gammas)]
    # differences below 1e-9 count as equal, which many have near 0 and between close flips
    best = [set(np.flatnonzero(solve(mdp, gamma).best).tolist()) for gamma in middles]
    for place, flip in enumerate(found):
        for turn in flip.turns:
            assert set(turn.before) <= best[place]
            assert set(turn.after) <= best[place + 1]
    for below, above in itertools.pairwise(found):
        assert below.expected_return[1] == above.expected_return[0]


def test_what_is_earned_is_that_of_the_best_actions_shared_evenly() -> None:
    mdp, found = known("frozenlake-slippery")
    assert found[0].expected_return == pytest.approx(
        [expected_return(mdp, uniform_over(mdp, solve(mdp, gamma).best)) for gamma in (0.7, 0.9)]
    )


@pytest.mark.exhaustive("ten worlds each", but=["0", "10", "20", "30"])
@pytest.mark.parametrize("tens", range(0, 200, 10))
def test_small_worlds_in_fractions(tens: int) -> None:
    for seed in range(tens, tens + 10):
        mdp = small_world(seed)
        assert list(disagreements(mdp, flips(mdp), parts=61)) == [], f"world {seed}"


def test_the_plain_way_finds_a_flip_missed_and_one_invented() -> None:
    mdp = next(mdp for mdp in map(small_world, range(200)) if len(flips(mdp)) == 2)
    first, second = flips(mdp)
    assert not list(disagreements(mdp, (first, second), parts=61))
    assert list(disagreements(mdp, (first,), parts=61))
    invented = Flip((first.gamma + second.gamma) / 2, False, (0.0, 0.0), first.turns)
    assert list(disagreements(mdp, (first, invented, second), parts=61))


def test_what_only_touches_is_no_flip() -> None:
    # 1/4 − γ + γ² = (γ − 1/2)²: waiting is as good as stopping only at γ = 1/2
    mdp = world(
        ("here", "stop", [(1.0, "end", 0.25)]),
        ("here", "go", [(1.0, "there", 0.0)]),
        ("there", "on", [(1.0, "last", 1.0)]),
        ("last", "out", [(1.0, "end", -1.0)]),
    )
    plain = plain_world(mdp)
    policy = {state: pairs[0] for state, pairs in plain.pairs.items()}
    assert optimal_pairs(plain, Fraction(1, 2), policy)[0] == (0, 1)
    assert flips(mdp) == ()


def test_a_tie_on_one_side_only_is_a_flip() -> None:
    mdp = world(
        ("here", "stop", [(1.0, "end", 0.5)]),
        ("here", "go", [(1.0, "there", 0.0)]),
        ("here", "walk", [(1.0, "there", 0.0)]),
        ("there", "out", [(1.0, "end", 1.0)]),
    )
    (flip,) = flips(mdp)
    assert (flip.gamma, flip.turns[0].before, flip.turns[0].after) == (0.5, (0,), (1, 2))


def test_flips_close_to_each_other_and_to_the_ends_are_told_apart() -> None:
    prices = [0.000001, 0.499999, 0.5, 0.500001, 0.999998, 0.999999]
    rooms = [
        pair
        for price in prices
        for pair in (
            (f"room {price}", "stop", [(1.0, "end", price)]),
            (f"room {price}", "go", [(1.0, "hall", 0.0)]),
        )
    ]
    start = {f"room {price}": 1 / len(prices) for price in prices}
    mdp = world(*rooms, ("hall", "out", [(1.0, "end", 1.0)]), start=start)
    assert [flip.gamma for flip in flips(mdp)] == prices


def test_numbers_are_read_as_the_fractions_they_are_meant_to_be() -> None:
    # in binary a third is less than a third, and half of 0.2 + 0.4 is not 0.3
    mdp = world(
        ("here", "stop", [(1.0, "end", 0.15)]),
        ("here", "once", [(1.0, "a", 0.0)]),
        ("here", "by halves", [(1.0, "b", 0.0)]),
        ("here", "by thirds", [(1 / 3, "c", 0.0), (2 / 3, "end", 0.0)]),
        ("a", "out", [(1.0, "end", 0.3)]),
        ("b", "out", [(0.5, "end", 0.2), (0.5, "end", 0.4)]),
        ("c", "out", [(1.0, "end", 0.9)]),
    )
    (flip,) = flips(mdp)
    assert (flip.gamma, flip.turns[0].before, flip.turns[0].after) == (0.5, (0,), (1, 2, 3))


def test_a_way_that_goes_round_until_a_slip_leads_out_turns_only_at_the_start() -> None:
    def room(chance: float, first: str) -> TabularMDP:
        return world(
            (first, "go", [(1.0, "a", 0.0)]),
            ("a", "wait", [(1.0 - chance, "b", 1.0), (chance, "end", 1.0)]),
            ("a", "leave", [(1.0, "hall", 0.0)]),
            ("b", "back", [(1.0, "a", 1.0)]),
            ("hall", "out", [(1.0, "end", 8.0)]),
        )

    slip = flips(room(0.25, "start"))
    assert slip
    assert not any(flip.turns_the_way for flip in slip)
    assert all(flip.turns_the_way for flip in flips(room(0.0, "start")))


def test_where_the_start_itself_turns_the_way_does() -> None:
    mdp = world(
        ("start", "search", [(0.9, "start", 1.0), (0.1, "end", 1.0)]), ("start", "leave", [(1.0, "end", 4.0)])
    )
    (flip,) = flips(mdp)
    assert flip.gamma == pytest.approx(5 / 6)
    assert flip.turns_the_way


def test_outcomes_that_land_alike_are_as_likely_as_one() -> None:
    def fork(*outcomes: tuple[float, str, float]) -> TabularMDP:
        return world(
            ("start", "go", list(outcomes)),
            ("a", "near", [(1.0, "end", 1.0)]),
            ("a", "far", [(1.0, "on", 0.0)]),
            ("on", "far", [(1.0, "end", 2.0)]),
            ("b", "out", [(1.0, "end", 0.0)]),
        )

    whole, parts = (
        fork((0.6, "a", 0.0), (0.4, "b", 0.0)),
        fork((0.3, "a", 0.0), (0.3, "a", 1.0), (0.4, "b", 0.0)),
    )
    for mdp in (whole, parts):
        assert [flip.turns_the_way for flip in flips(mdp)] == [True]


def test_what_is_too_small_to_be_read_is_refused() -> None:
    mdp = world(
        ("a", "now", [(1.0, "end", 1e-7)]),
        ("a", "later", [(1.0, "b", 0.0)]),
        ("b", "x", [(1.0, "end", 2e-7)]),
    )
    with pytest.raises(NoExactAnswer, match="1e-07 is too small"):
        flips(mdp)


def test_where_nothing_is_paid_or_every_action_ends_nothing_flips() -> None:
    nothing = world(
        ("a", "x", [(1.0, "b", 0.0)]), ("a", "y", [(1.0, "a", 0.0)]), ("b", "x", [(1.0, "a", 0.0)])
    )
    assert flips(nothing) == ()
    mdp = table("bandit")
    assert mdp is not None
    assert flips(mdp) == ()
