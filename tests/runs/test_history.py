from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rl_tui.runs.history import History

ROOM = 8


def filled(returns: np.ndarray, lengths: np.ndarray, cuts: list[int]) -> History:
    history = History(ROOM)
    edges = [0, *sorted(cuts), len(returns)]
    for start, end in pairwise(edges):
        history.add(returns[start:end].copy(), lengths[start:end].copy())
    return history


@st.composite
def deliveries(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray, list[int]]:
    count = draw(st.integers(0, 300))
    generator = np.random.default_rng(draw(st.integers(0, 1000)))
    cuts = draw(st.lists(st.integers(0, count), max_size=6))
    return generator.normal(size=count), generator.integers(1, 50, count), cuts


@settings(deadline=None)
@given(deliveries())
def test_how_episodes_are_delivered_does_not_show(delivery: tuple[np.ndarray, np.ndarray, list[int]]) -> None:
    returns, lengths, cuts = delivery
    at_once, in_parts = filled(returns, lengths, []), filled(returns, lengths, cuts)
    for one, other in zip(at_once.checkpoint(), in_parts.checkpoint(), strict=True):
        assert one.tobytes() == other.tobytes()
    assert at_once.last_100 == in_parts.last_100


@settings(deadline=None)
@given(deliveries())
def test_bins_hold_what_numpy_says(delivery: tuple[np.ndarray, np.ndarray, list[int]]) -> None:
    returns, lengths, cuts = delivery
    history = filled(returns, lengths, cuts)
    curve = history.curve()
    width = 1
    while width * ROOM < len(returns):
        width *= 2
    parts = [slice(start, start + width) for start in range(0, len(returns), width)]
    assert curve.episode.tolist() == [min(part.stop, len(returns)) for part in parts]
    assert curve.return_mean == pytest.approx([returns[part].mean() for part in parts])
    assert curve.return_low.tolist() == [returns[part].min() for part in parts]
    assert curve.return_high.tolist() == [returns[part].max() for part in parts]
    assert curve.length_mean == pytest.approx([lengths[part].mean() for part in parts])
    assert history.total_return == pytest.approx(returns.sum(), abs=1e-9)


def test_the_last_hundred_are_exact() -> None:
    history = History()
    assert history.last_100 == (None, None)
    returns = np.random.default_rng(3).normal(size=1000)
    history.add(returns[:30], np.full(30, 7))
    assert history.last_100 == (math.fsum(returns[:30]) / 30, 7.0)
    history.add(returns[30:], np.arange(970))
    assert history.last_100 == (math.fsum(returns[-100:]) / 100, np.arange(870, 970).mean())


def test_the_lengths_of_the_first_hundred_and_the_newest_episode_are_kept() -> None:
    history, lengths = History(), np.arange(1, 1001)
    assert history.newest is None
    for part in (slice(0, 30), slice(30, 30), slice(30, 990), slice(990, 1000)):
        history.add(-lengths[part].astype(float), lengths[part])
    assert history.first_lengths.tolist() == list(range(1, 101))
    assert history.newest == (-1000.0, 1000)
    again = History()
    again.restore(history.checkpoint())
    assert (again.first_lengths.tolist(), again.newest) == (list(range(1, 101)), history.newest)


def test_a_million_episodes_take_no_more_memory_than_a_few_thousand() -> None:
    few, many = History(), History()
    few.add(np.ones(4_096), np.ones(4_096, np.int64))
    many.add(np.ones(1_000_000), np.ones(1_000_000, np.int64))
    sizes = [sum(array.nbytes for array in each.checkpoint()[:-3]) for each in (few, many)]
    assert sizes[1] <= sizes[0]
    assert many.curve().episode[-1] == 1_000_000
    assert many.total_return == 1_000_000.0


@settings(deadline=None)
@given(deliveries())
def test_single_returns_are_those_of_every_so_many_th_episode(
    delivery: tuple[np.ndarray, np.ndarray, list[int]],
) -> None:
    returns, lengths, cuts = delivery
    curve = filled(returns, lengths, cuts).curve()
    every, most = curve.sample_every, 8 * ROOM
    assert curve.samples.tolist() == returns[::every].tolist()
    assert len(curve.samples) <= most
    assert every == 1 or len(returns) > most * every / 2


def test_a_restored_history_goes_on_as_the_first_did() -> None:
    returns, lengths = np.random.default_rng(1).normal(size=500), np.arange(1, 501)
    history, other = filled(returns[:200], lengths[:200], []), History(ROOM)
    state = history.checkpoint()
    history.add(returns[200:], lengths[200:])
    other.restore(state)
    other.add(returns[200:], lengths[200:])
    for one, two in zip(history.checkpoint(), other.checkpoint(), strict=True):
        assert one.tobytes() == two.tobytes()
    assert history.last_100 == other.last_100
