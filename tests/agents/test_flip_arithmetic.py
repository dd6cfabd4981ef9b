"""Polynomials, roots, recurrences and integer values."""

from __future__ import annotations

import math
import random
from fractions import Fraction
from itertools import islice, pairwise

import numpy as np
import pytest
from exact_reference import lake, student
from hypothesis import given, settings
from hypothesis import strategies as st
from plain_flips import plain_world, small_world, values

from rl_tui.agents.exact.flips import RealRoot, first_change, in_order, last_change, optimal_intervals
from rl_tui.agents.exact.polynomials import (
    Polynomial,
    common_factor,
    polynomial,
    primitive,
    quotient,
    sign_at,
    square_free,
    variations,
    without_roots_at_ends,
)
from rl_tui.agents.exact.rational_values import (
    column,
    policy_values,
    primes,
    rational_model,
    shortest_recurrence,
    whole_numbers,
)

pytestmark = pytest.mark.unit

quick = settings(max_examples=60, deadline=None)
ZERO, ONE = Fraction(0), Fraction(1)
fractions_inside = st.fractions(min_value=0, max_value=1, max_denominator=12).filter(lambda x: 0 < x < 1)
roots = st.lists(fractions_inside, min_size=1, max_size=5)


def with_roots(*given: Fraction) -> Polynomial:
    product: Polynomial = (1,)
    for root in given:
        product = times(product, (-root.numerator, root.denominator))
    return product


def times(one: Polynomial, other: Polynomial) -> Polynomial:
    result = [0] * (len(one) + len(other) - 1)
    for i, a in enumerate(one):
        for j, b in enumerate(other):
            result[i + j] += a * b
    return polynomial(result)


def square_root(of: int, scale: int) -> RealRoot:
    root = first_change((-of, 0, scale**2), ZERO, ONE)
    assert root
    return root


def number_of_roots(given: Polynomial, lower: Fraction, upper: Fraction) -> int:
    """Count the different roots in (lower, upper], by the theorem of Sturm."""
    chain = [[Fraction(each) for each in given], [Fraction(k * each) for k, each in enumerate(given) if k]]
    while True:
        rest = chain[-2][:]
        while len(rest) >= len(chain[-1]):
            factor = rest[-1] / chain[-1][-1]
            shift = len(rest) - len(chain[-1])
            rest = [
                each - (factor * chain[-1][place - shift] if place >= shift else 0)
                for place, each in enumerate(rest)
            ]
            while rest and not rest[-1]:
                rest.pop()
        if not rest:
            break
        chain.append([-each for each in rest])

    def changes(at: Fraction) -> int:
        signs = [sum(each * at**k for k, each in enumerate(link)) for link in chain]
        return sum(a * b < 0 for a, b in pairwise([sign for sign in signs if sign]))

    return changes(lower) - changes(upper)


@quick
@given(roots, st.sampled_from([(1,), (1, 0, 1), (3, -2, 5)]))
def test_a_root_is_a_change_of_sign_where_it_is_odd(given: list[Fraction], factor: Polynomial) -> None:
    product = times(with_roots(*given), factor)
    odd = sorted(root for root in set(given) if given.count(root) % 2)
    first, last = first_change(product, ZERO, ONE), last_change(product, ZERO, ONE)
    assert (first is None) == (last is None) == (not odd)
    if first and last:
        assert first.lower < odd[0] < first.upper
        assert last.lower < odd[-1] < last.upper
        assert first.nearest_float() == float(odd[0])
        assert sign_at(square_free(product), odd[-1]) == 0


@quick
@given(st.lists(st.integers(-9, 9), min_size=2, max_size=8), fractions_inside)
def test_sign_changes_bound_the_roots_and_tell_none_and_one(given: list[int], upper: Fraction) -> None:
    product = polynomial(given)
    if len(product) < 2 or not product[0] or not sign_at(product, upper):
        return
    bound, roots = variations(product, ZERO, upper), number_of_roots(product, ZERO, upper)
    assert roots <= bound
    assert bound > 1 or roots == bound
    assert variations(product, upper / 3, upper) <= bound


@quick
@given(roots, roots)
def test_the_common_factor_has_the_common_roots(one: list[Fraction], other: list[Fraction]) -> None:
    shared = [root for root in set(one) for _ in range(min(one.count(root), other.count(root)))]
    found = common_factor(with_roots(*one), with_roots(*other))
    assert found in (with_roots(*shared), tuple(-each for each in with_roots(*shared)))
    assert quotient(with_roots(*one), found) is not None


def test_a_quotient_is_a_polynomial_or_nothing() -> None:
    assert quotient((-1, 0, 1), (1, 1)) == (-1, 1)
    assert quotient((1, 0, 1), (1, 1)) is None
    assert quotient((1, 1), (2, 2)) is None


def test_roots_at_0_and_1_are_left_out_and_signs_stay() -> None:
    given = times(with_roots(Fraction(1, 3)), times((0, 0, 1), (1, -2, 1)))
    assert without_roots_at_ends(given) == (-1, 3)
    assert primitive((4, -6)) == (2, -3)


def test_roots_are_compared_exactly() -> None:
    root, larger = square_root(2, 2), square_root(2 * 10**60 + 1, 2 * 10**30)
    same = first_change(times((-2, 0, 4), (-1, 0, 3)), Fraction(3, 5), ONE)
    assert same
    assert in_order(root, same)[0] == 0
    assert in_order(root, larger)[0] == -1
    assert in_order(larger, root)[0] == 1
    order, one, other = in_order(square_root(1, 2), RealRoot((-1, 2), ZERO, ONE, -1))
    assert (order, one.nearest_float(), other.nearest_float()) == (0, 0.5, 0.5)
    assert root.nearest_float() == math.sqrt(0.5)


def test_primes_and_the_way_back_to_whole_numbers() -> None:
    moduli = list(islice(primes(), 5))
    assert moduli[0] == 2**30 - 35
    assert all(number % odd for number in moduli for odd in range(3, 2**15, 2))
    wanted = [0, 1, -1, 2**140, -(2**140) + 17]
    residues = np.array([[number % prime for number in wanted] for prime in moduli])
    assert whole_numbers(residues, moduli).tolist() == wanted


def test_the_shortest_recurrence_of_known_sequences() -> None:
    moduli = list(islice(primes(), 2))
    fibonacci = [1, 1]
    while len(fibonacci) < 12:
        fibonacci.append(sum(fibonacci[-2:]))
    both = np.array([fibonacci] * 2) % column(moduli, 2)
    found = shortest_recurrence(both, moduli)
    assert found is not None
    assert whole_numbers(found, moduli).tolist() == [1, -1, -1]
    ends = shortest_recurrence(np.array([[5, 3, 7, 0, 0, 0, 0, 0]] * 2), moduli)
    assert ends.tolist() == [[1, 0, 0, 0]] * 2
    silent = shortest_recurrence(np.zeros((2, 8), dtype=np.int64), moduli)
    assert silent.tolist() == [[1]] * 2
    assert shortest_recurrence(np.array([[0, 1, 1, 2], [1, 1, 2, 3]]), moduli) is None


@pytest.mark.parametrize("seed", range(20))
def test_values_are_those_of_gauss_at_any_gamma(seed: int) -> None:
    mdp, drawn = small_world(seed), random.Random(seed)
    model, plain = rational_model(mdp), plain_world(mdp)
    policy = {state: drawn.choice(pairs) for state, pairs in plain.pairs.items()}
    found = policy_values(model, list(policy.values()))
    for gamma in (Fraction(1, 7), Fraction(5, 8), Fraction(99, 100)):
        v, here = values(plain, gamma, policy), found.at(gamma)
        assert here.denominator > 0
        ratios = {
            Fraction(numerator, here.denominator) / v[state]
            for state, numerator in zip(model.live, here.numerators, strict=True)
            if v[state]
        }
        assert len(ratios) <= 1, "all in one unit of reward"
        assert all(ratio > 0 for ratio in ratios)
        for pair in model.pairs:
            exact = here.advantage(pair)
            whole = found.advantage(pair)
            assert (exact > 0) - (exact < 0) == (sign_at(whole, gamma) if whole else 0)


def test_intervals_meet_from_0_to_1_from_whatever_policy_the_search_begins() -> None:
    mdp = lake("4x4", slippery=True)
    model = rational_model(mdp)
    first, last = ([pairs[end] for pairs in model.pairs_of] for end in (0, -1))
    found, again = optimal_intervals(model, first), optimal_intervals(model, last)
    assert [each.optimal for each in found] == [each.optimal for each in again]
    assert found[0].lower is None
    assert found[-1].upper is None
    for below, above in pairwise(found):
        assert below.upper
        assert above.lower
        assert in_order(below.upper, above.lower)[0] == 0


def test_a_world_in_whole_numbers() -> None:
    model = rational_model(student())
    study = model.pairs[0]
    assert (study.state, study.scale, study.reward) == (0, 5, -10)
    assert dict(study.moves) == {2: 4, 0: 1}
    assert model.pairs[-1].moves == ()
    assert model.live == (0, 1, 2)
