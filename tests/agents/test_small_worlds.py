"""The kernels that evaluate many policies of a small world."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

import exact_reference
import numpy as np
import pytest
import random_worlds
from exact_reference import lake, world
from hypothesis import given, settings
from hypothesis import strategies as st
from two_forms import interpreted

from rl_tui.agents.compiling.loops import compile_what_all_share
from rl_tui.agents.exact import policy_figures
from rl_tui.agents.exact.backward_induction import policy_values
from rl_tui.agents.exact.exact_model import exact_model
from rl_tui.agents.exact.policy_evaluation import NoExactAnswer, PolicyChain, PolicyValue
from rl_tui.agents.exact.policy_figures import (
    BatchFigures,
    batch_figures,
    expected_return,
    expected_returns,
    figures,
    greedy_policy,
    softened,
    uniform_policy,
)
from rl_tui.agents.exact.small_worlds import elimination, many_policies
from rl_tui.agents.exact.small_worlds.many_policies import (
    Values,
    distinct_policies,
    find_values,
    new_memory,
    new_values,
)
from rl_tui.agents.exact.small_worlds.world import as_small_world, small_world
from rl_tui.agents.exact.solve import solve
from rl_tui.agents.hyperparameters import Ties
from rl_tui.agents.kernels import machine_code
from rl_tui.agents.kernels.machine_code import fastest
from rl_tui.runs.library import recipe_named
from rl_tui.runs.recipe import begin
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

quick = settings(max_examples=80, deadline=None)
GAMMAS = st.sampled_from([0.0, 0.3, 0.9, 0.99, 1.0 - 1e-6, 1.0])
TIES = st.sampled_from(["random", "first"])

pytestmark = pytest.mark.unit


class Drawn(NamedTuple):
    mdp: TabularMDP
    policies: FloatArray


@st.composite
def worlds_and_policies(draw: st.DrawFn) -> Drawn:
    limits = st.sampled_from([0, 0, 1, 7, 60])
    mdp = draw(st.one_of(exact_reference.worlds(states=6, time_limit=draw(limits)), random_worlds.worlds(12)))
    generator = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    few = greedy_policy(mdp, generator.integers(0, 3, (3, mdp.pairs)).astype(np.float64), "random")
    one = greedy_policy(mdp, generator.random((3, mdp.pairs)), "first")
    chances = generator.dirichlet(np.ones(mdp.pairs), 2)
    total = np.add.reduceat(chances, mdp.first_pair[:-1][np.diff(mdp.first_pair) > 0], axis=1)
    count = np.diff(mdp.first_pair)
    any_chances = chances / np.repeat(total, count[count > 0], axis=1)
    hardly = [softened(mdp, each, 1e-3) for each in one]
    return Drawn(mdp, np.concatenate((few, one, any_chances, hardly, one[:1])))


def by_chain(mdp: TabularMDP, policy: FloatArray, gamma: float) -> PolicyValue | None:
    try:
        return PolicyChain(exact_model(mdp), policy).value(gamma)
    except NoExactAnswer:
        return None


def by_kernel(mdp: TabularMDP, policies: FloatArray, gamma: float) -> Values:
    of_world = as_small_world(mdp).unlimited
    values = new_values(of_world, len(policies))
    fastest(find_values)(of_world, policies, gamma, values, new_memory(of_world))
    return values


def bits(figures: BatchFigures | Values) -> list[bytes]:
    names = getattr(figures, "_fields", None) or figures.__slots__  # type: ignore[union-attr]
    return [getattr(figures, name).tobytes() for name in names]


@contextmanager
def compiled() -> Iterator[None]:
    compile_what_all_share()
    yield


@contextmanager
def without_machine_code() -> Iterator[None]:
    with interpreted(), pytest.MonkeyPatch.context() as patch:
        patch.setattr(many_policies, "COMPILED_LOOPS", set())
        yield


@quick
@given(worlds_and_policies(), GAMMAS)
def test_values_are_those_of_the_chain_and_missing_where_it_has_none(drawn: Drawn, gamma: float) -> None:
    mdp, policies = drawn
    values = by_kernel(mdp, policies, gamma)
    assert not values.left.any()
    live = np.diff(mdp.first_pair) > 0
    for policy, v, at_start in zip(policies, values.v, values.at_start, strict=True):
        chain = by_chain(mdp, policy, gamma)
        close = 1e-15 * np.nanmax(np.abs(chain.v), initial=0.0)
        assert v == pytest.approx(chain.v[live], rel=1e-12, abs=close, nan_ok=True)
        assert np.isnan(at_start) == (chain.at_start is None)
        if chain.at_start is not None:
            assert at_start == pytest.approx(chain.at_start, rel=1e-12, abs=close)


@quick
@given(worlds_and_policies())
def test_returns_within_a_limit_have_the_bits_of_backward_induction(drawn: Drawn) -> None:
    mdp, policies = drawn
    with compiled():
        found = expected_returns(mdp, policies)
    if mdp.time_limit:
        swept = [mdp.average_at_start(policy_values(mdp, each, mdp.time_limit)) for each in policies]
        assert found.tolist() == swept


@quick
@given(worlds_and_policies(), GAMMAS, TIES)
def test_a_row_of_a_batch_is_what_it_is_alone_bit_for_bit(drawn: Drawn, gamma: float, ties: Ties) -> None:
    mdp, q = drawn  # estimates as good as any others, and full of ties
    try:
        optimum = solve(mdp, gamma)
    except NoExactAnswer:
        optimum = None
    batch = batch_figures(mdp, q, ties, gamma, optimum)
    for row, estimates in enumerate(q):
        alone = figures(mdp, greedy_policy(mdp, estimates, ties), gamma)
        error = None if optimum is None else float(np.abs(estimates - optimum.q).max())
        both = [
            (batch.value_at_start, alone.value_at_start),
            (batch.expected_return, alone.expected_return),
            (batch.max_error, error),
        ]
        for figure, single in both:
            assert figure[row].tobytes() == np.float64(np.nan if single is None else single).tobytes()
    policies = greedy_policy(mdp, q, ties)
    one_by_one = [expected_return(mdp, each) for each in policies]
    assert batch.expected_return.tobytes() == expected_returns(mdp, policies).tobytes()
    assert batch.expected_return.tobytes() == np.array(one_by_one, dtype=np.float64).tobytes()


@quick
@given(worlds_and_policies(), GAMMAS, TIES)
def test_machine_code_and_python_give_the_same_bits(drawn: Drawn, gamma: float, ties: Ties) -> None:
    mdp, q = drawn
    with compiled():
        as_machine_code = batch_figures(mdp, q, ties, gamma, None), by_kernel(mdp, q, gamma)
    with without_machine_code():
        as_python = batch_figures(mdp, q, ties, gamma, None), by_kernel_interpreted(mdp, q, gamma)
    assert [bits(each) for each in as_machine_code] == [bits(each) for each in as_python]


def by_kernel_interpreted(mdp: TabularMDP, policies: FloatArray, gamma: float) -> Values:
    of_world = as_small_world(mdp).unlimited
    values = new_values(of_world, len(policies))
    machine_code.interpreted(find_values)(of_world, policies, gamma, values, new_memory(of_world))
    return values


@pytest.mark.parametrize("scenario", ["bandit", "cliff", "frozenlake-8x8-slippery", "student", "taxi"])
def test_so_they_do_in_shipped_worlds(scenario: str) -> None:
    recipe = recipe_named(scenario, {}, 0)
    mdp = begin(recipe).world.mdp
    assert mdp is not None
    q = np.random.default_rng(0).normal(size=(2, mdp.pairs))
    q[1] = 0.0
    with compiled():
        as_machine_code = batch_figures(mdp, q, "first", recipe.hyperparameters.gamma, None)
    with without_machine_code():
        as_python = batch_figures(mdp, q, "first", recipe.hyperparameters.gamma, None)
    assert bits(as_machine_code) == bits(as_python)


def test_a_chain_that_hardly_ends_is_left_and_worked_out_as_before() -> None:
    mdp = world(
        ("A", "on", [(1.0, "B", -1.0)]),
        ("B", "back", [(1.0 - 1e-11, "A", 0.0), (1e-11, "end", 0.0)]),
        ("B", "out", [(1.0, "end", 0.0)]),
    )
    policies = np.array([[1.0, 1.0, 0.0], [1.0, 0.0, 1.0], [1.0, 0.5, 0.5]])
    assert by_kernel(mdp, policies, 1.0).left.tolist() == [True, False, False]
    found = expected_returns(mdp, policies)
    chain = by_chain(mdp, policies[0], 1.0)
    assert found[0] == chain.at_start == pytest.approx(-1e11, rel=1e-4)
    assert found[1:].tolist() == [-1.0, pytest.approx(-2.0, rel=1e-9)]


def test_what_takes_too_much_work_is_left_and_spoils_no_other_policy(monkeypatch: pytest.MonkeyPatch) -> None:
    mdp = lake("4x4", False)
    by_chance = uniform_policy(mdp)
    policies = np.array([by_chance, greedy_policy(mdp, solve(mdp, 0.9).q, "first"), by_chance])
    with without_machine_code():
        expected = expected_returns(mdp, policies)
        monkeypatch.setattr(elimination, "MOST_WORK", 20)
        values = by_kernel_interpreted(mdp, policies, 0.9)
        assert values.left.tolist() == [True, False, True]
        assert bits(by_kernel_interpreted(mdp, policies[1:2], 0.9))[1] == values.at_start[1:2].tobytes()
        assert expected_returns(mdp, policies) == pytest.approx(expected, rel=1e-12)


@quick
@given(worlds_and_policies(), GAMMAS)
def test_large_worlds_go_the_same_way_one_by_one(drawn: Drawn, gamma: float) -> None:
    mdp, q = drawn
    small = batch_figures(mdp, q, "random", gamma, None)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(many_policies, "small_world", lambda mdp: None)
        large = batch_figures(mdp, q, "random", gamma, None)
        alone = [figures(mdp, greedy_policy(mdp, each, "random"), gamma) for each in q]
    for name in ("value_at_start", "expected_return"):
        of_large = getattr(large, name)
        assert of_large.tolist() == pytest.approx(
            [np.nan if (it := getattr(each, name)) is None else it for each in alone],
            rel=0,
            abs=0,
            nan_ok=True,
        )
        assert getattr(small, name) == pytest.approx(of_large, rel=1e-12, abs=1e-13, nan_ok=True)


def test_too_many_states_and_rewards_beyond_measure_are_no_small_world() -> None:
    way = [(f"s{n}", "on", [(1.0, f"s{n + 1}", 0.0)]) for n in range(513)]
    assert small_world(world(*way)) is None
    assert small_world(world(*way[1:])) is not None
    dear = [("s", "on", [(1.0, "end", 1e300)])]
    assert small_world(world(*dear)) is None
    assert expected_return(world(*dear), np.ones(1)) == 1e300


def test_policies_may_be_of_any_layout_and_read_only() -> None:
    mdp = lake("4x4", True, 100)
    compile_what_all_share()
    policies = greedy_policy(mdp, np.random.default_rng(0).random((4, mdp.pairs)), "first")
    expected = expected_returns(mdp, policies)
    read_only = policies.copy()
    read_only.flags.writeable = False
    for other in (read_only, np.asfortranarray(policies)):
        assert expected_returns(mdp, other).tolist() == expected.tolist()
        assert expected_return(mdp, other[0]) == expected[0]


@given(st.lists(st.lists(st.sampled_from([0.0, 0.5, 1.0]), min_size=3, max_size=3), max_size=9))
def test_equal_policies_are_found(rows: list[list[float]]) -> None:
    policies = np.array(rows).reshape(len(rows), 3)
    distinct, place = distinct_policies(policies)
    assert len(distinct) == len({tuple(row) for row in rows})
    assert distinct[place].tolist() == rows


def test_equal_policies_are_evaluated_once(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []

    def counted(mdp: TabularMDP, policies: FloatArray, *rest: object) -> many_policies.PolicyValues:
        asked.append(len(policies))
        return many_policies.values_of(mdp, policies, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(policy_figures, "values_of", counted)
    mdp = lake("4x4", False, 100)
    q = np.random.default_rng(0).random((2, mdp.pairs))[[0, 1, 0, 0, 1]]
    q[3] *= 2.0
    found = batch_figures(mdp, q, "random", 0.9, None)
    assert asked == [2]
    assert found.value_at_start[0] == found.value_at_start[3]


def test_no_policies_have_no_figures() -> None:
    mdp = lake("4x4", False, 100)
    found = batch_figures(mdp, np.zeros((0, mdp.pairs)), "random", 0.9, solve(mdp, 0.9))
    assert [len(found.value_at_start), len(found.expected_return), len(found.max_error)] == [0, 0, 0]
