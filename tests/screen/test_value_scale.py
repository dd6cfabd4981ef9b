"""The scale of colours."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
from samples import bandit, lake, look
from snapshots import changed

from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.answers.policy_values import PolicyAnswer
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.kit.numbers_in_common import known_v
from rl_tui.screen.kit.value_scale import SteadyScale, ValueScale, value_scale
from rl_tui.screen.panels.policies.studied import as_studied
from rl_tui.screen.panels.world.scale_line import scale_pieces

PALETTE = look().palette


@pytest.mark.parametrize(
    ("values", "ends"),
    [
        ([0.2, 0.9], (0.0, 0.9)),  # begins at 0 if the least is below half of the largest
        ([0.6, 0.9], (0.6, 0.9)),
        ([-13.0, -1.0], (-13.0, -1.0)),
        ([0.5], (0.0, 0.5)),
        ([-3.0, -3.0], (-3.0, 0.0)),
        ([-1.0, 3.0], (-3.0, 3.0)),  # both signs matter
        ([-0.2, 3.0], (-0.2, 3.0)),  # the smaller end is less than a tenth
        ([-100.0, *range(1, 17)], (1.0, 16.0)),  # one outlier
        ([0.0, *range(1, 17)], (0.0, 16.0)),
        ([0.01, 0.03, 0.15, 0.52, *[0.0] * 60], (0.0, 0.52)),  # zeros do not make outliers
        ([-0.3, 0.34, *[-0.1] * 5, *[0.0] * 30], (-0.34, 0.34)),  # most are unknown: few have the other sign
    ],
)
def test_ends(values: list[float], ends: tuple[float, float]) -> None:
    scale = value_scale(np.array(values))
    assert scale is not None
    low, high = scale.ends
    assert (low, high) == ends or (ends == (1.0, 16.0) and low in (0.0, 1.0, 2.0))


def test_what_lies_beyond_has_the_tint_of_the_end_and_a_side() -> None:
    scale = ValueScale(-13.0, -1.0)
    assert scale.style(-113.0, PALETTE) == PALETTE.value(0.0)
    assert [scale.side(x) for x in (-113.0, -13.0, -5.0, -1.0, 0.0)] == [-1, 0, 0, 0, 1]
    assert scale.style(math.nan, PALETTE) == PALETTE.text
    assert ValueScale().style(3.0, PALETTE) == PALETTE.value(0.0)
    assert ValueScale().side(3.0) == 0


def test_a_signed_scale_has_a_grey_zero() -> None:
    scale = ValueScale(-1.0, 2.0)
    assert scale.is_signed
    assert scale.style(0.0, PALETTE) == PALETTE.signed_value(0.0)
    assert scale.style(-1.0, PALETTE) == PALETTE.signed_value(-0.5)
    assert scale.style(2.0, PALETTE) == PALETTE.signed_value(1.0)


def test_it_only_gets_wider_and_holds_what_is_known_alone() -> None:
    start = lake(0)
    visits = np.zeros(44, dtype=np.int64)
    visits[0] = 1
    scale = SteadyScale()
    optimistic = changed(start, q=np.full(44, 5.0), visits=visits * 0)
    assert not len(known_v(optimistic))
    assert scale.of(optimistic) == ValueScale()
    for top, expected in ((0.5, 0.5), (0.8, 0.8), (0.2, 0.8)):
        q = np.zeros(44)
        q[0] = top
        assert scale.of(changed(start, q=q, visits=visits)).high == expected
    scale.clear()
    assert scale.of(start) == ValueScale()


def with_policies(shown: Snapshot, studied: PolicyKind, **tops: float) -> Snapshot:
    """Study one of the policies, whose largest V are ``tops``."""
    policies = {
        PolicyKind(kind): PolicyAnswer(np.full(44, 0.25), np.full(16, top), np.full(44, top))
        for kind, top in tops.items()
    }
    return as_studied(replace(shown, answers=replace(shown.answers, studied=studied, policies=policies)))


def test_all_policies_have_one_scale_whichever_was_studied_before() -> None:
    learned, tops = lake(), {"greedy": 0.1, "optimal": 1.6, "behaviour": 0.9}
    scales = []
    for kinds in permutations([PolicyKind.GREEDY, PolicyKind.OPTIMAL, PolicyKind.BEHAVIOUR]):
        steady = SteadyScale()
        before = steady.of(learned)
        scales += [steady.of(with_policies(learned, kind, **tops)).ends for kind in kinds]
        assert steady.of(learned) == before
    assert set(scales) == {(0.0, 1.6)}


def test_a_policy_that_wanders_is_outside_of_the_scale() -> None:
    learned, tops = lake(), {"drawn": -1_000.0, "optimal": 0.8}
    near = SteadyScale().of(with_policies(learned, PolicyKind.OPTIMAL, **tops))
    assert near.ends == (0.0, 0.8)
    assert SteadyScale().of(with_policies(learned, PolicyKind.DRAWN, **tops)) == replace(
        near, cuts=(True, False)
    )


def test_a_study_leaves_nothing_to_the_next() -> None:
    fresh, steady = lake(0), SteadyScale()
    first = with_policies(fresh, PolicyKind.GREEDY, greedy=-50.0, optimal=-13.0)
    assert steady.of(first).ends == (-50.0, 0.0)
    steady.of(fresh)
    later = with_policies(fresh, PolicyKind.GREEDY, greedy=-13.0, optimal=-13.0)
    assert steady.of(later).ends == SteadyScale().of(later).ends == (-13.0, 0.0)


def test_a_policy_that_wanders_leaves_nothing_once_the_optimal_values_are_known() -> None:
    fresh, steady = lake(0), SteadyScale()
    assert steady.of(with_policies(fresh, PolicyKind.DRAWN, drawn=-1_000.0)).low == -1_000.0
    known = with_policies(fresh, PolicyKind.DRAWN, drawn=-1_000.0, optimal=0.8)
    assert steady.of(known) == SteadyScale().of(known)
    assert steady.of(known).ends == (0.0, 0.8)


def test_a_hidden_policy_does_not_change_the_scale() -> None:
    shown = with_policies(changed(lake(), is_hidden=True), PolicyKind.GREEDY, greedy=0.1, optimal=0.8)
    assert SteadyScale().of(shown).ends == (0.0, 0.1)


def test_that_of_a_bandit_is_that_of_the_arms_pulled() -> None:
    snapshot = bandit(400)
    pulled = snapshot.agent.q[snapshot.agent.visits > 0]
    assert sorted(known_v(snapshot)) == sorted(pulled)


def with_errors(*errors: float, tried: int = 44) -> Snapshot:
    """Add errors to the exact Q of the first pairs, of which some are tried."""
    shown = lake()
    solution = shown.exact_answer.solution
    assert solution is not None
    q = solution.q.copy()
    q[: len(errors)] += errors
    return changed(shown, q=q, visits=np.int64(np.arange(44) < tried))


def test_errors_of_untried_pairs_do_not_widen_their_scale() -> None:
    assert SteadyScale().of(with_errors(-0.3, -0.2, -9.0, tried=2), Layer.ERROR).ends == (-0.3, 0.3)
    assert SteadyScale().of(with_errors(-0.3, -0.2, -0.9, tried=3), Layer.ERROR).ends == (-0.9, 0.9)


def test_rounding_has_the_colour_of_no_error() -> None:
    scale = SteadyScale().of(with_errors(-1e-9, 1e-9), Layer.ERROR)
    assert scale.style(-1e-9, PALETTE) == scale.style(1e-9, PALETTE) == scale.style(0.0, PALETTE)


def test_it_is_drawn_with_both_ends() -> None:
    pieces = scale_pieces(ValueScale(0.0, 0.86), look())
    assert [piece.text for piece in pieces] == ["0 ", *" " * len(PALETTE.values), " .86"]
    assert not scale_pieces(ValueScale(), look())
    pieces = scale_pieces(ValueScale(-13.0, 0.002, cuts=(True, True)), look())
    assert (pieces[0].text, pieces[-1].text) == ("≤−13 ", " ≥.002")


def test_numbers_of_the_table_alone_cut_it_too() -> None:
    shown = lake()
    low = shown.agent.q.copy()
    low[np.argmin(low)] = -5.0
    visits = np.ones(44, dtype=np.int64)
    for q, cuts in ((shown.agent.q, (False, False)), (low, (True, False))):
        scale = SteadyScale().of(changed(shown, q=q, visits=visits))
        assert (scale.low, scale.cuts) == (0.0, cuts)
