"""Variations of a sweep, as text and as values."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.studies.sweeps.cells.variation import Spread, Value, Variation, read_variation


def values(text: str) -> list[Value]:
    variation = read_variation(text)
    return [variation.value(index) for index in range(variation.count)]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("alpha=0.1,0.5", [0.1, 0.5]),
        ("alpha=0.1,sample-average", [0.1, "sample-average"]),
        ("epsilon=0:0.5:6", [0, 0.1, 0.2, 0.3, 0.4, 0.5]),
        ("alpha=0.0001:1:log:5", [0.0001, 0.001, 0.01, 0.1, 1]),
        ("n=1:512:log:10", [1, 2, 4, 8, 16, 32, 64, 128, 256, 512]),
        ("n=1:4:4", [1, 2, 3, 4]),
        ("initial-q=-1:1:3", [-1, 0, 1]),
        ("lambda=.5, 1e-1", [0.5, 0.1]),
        ("algorithm=q-learning,sarsa", ["q-learning", "sarsa"]),
        ("policy=softmax", ["softmax"]),
        ("scenario=cliff,gym:FrozenLake-v1,./own.toml", ["cliff", "gym:FrozenLake-v1", "./own.toml"]),
        ('scenario="a,b.toml",12', ["a,b.toml", "12"]),
        ("world.kwargs.is_slippery=true,false", [True, False]),
        ("world.wind=[0,1],[1,1]", ["[0,1]", "[1,1]"]),
        ('world.reward["A=B","left"]=1,2', [1, 2]),
        ("world.cell[0,1]=#,.", ["#", "."]),
    ],
)
def test_what_is_said(text: str, expected: list[Value]) -> None:
    found = values(text)
    assert found == expected
    assert list(map(type, found)) == list(map(type, expected))


def test_a_value_of_a_range_is_the_one_that_people_write() -> None:
    """0.15, not 0.15000000000000002: the same cell as the 0.15 of a list."""
    assert values("epsilon=0:0.5:11") == [float(f"0.{place:02}") for place in range(0, 55, 5)]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("alpha", "NAME=FROM:TO"),
        ("=1", "NAME=FROM:TO"),
        ("alhpa=1", "alpha"),
        ("alpha=0,1", "(0, 1]"),
        ("alpha=0:1:3", "(0, 1]"),
        ("alpha=0.5:2:3", "(0, 1]"),
        ("alpha=0.5:0.1:3", "below"),
        ("initial_q=-1:1:log:3", "log needs FROM above 0"),
        ("initial_q=1:2:1", "COUNT"),
        ("initial_q=1:2:lin:3", "COUNT"),
        ("initial_q=1:2:3:4", "COUNT"),
        ("initial_q=1:2:0", "COUNT"),
        ("alpha=0.1,0.10", "twice"),
        ("alpha=", "missing"),
        ("alpha=0.1,,0.2", "missing"),
        ("n=1:3:9", "whole numbers"),
        ("n=1:10:log:10", "whole numbers"),
        ("n=1.5,2", "whole number"),
        ("algorithm=q-lerning", "q-learning"),
        ("policy=softmx", "softmax"),
        ("policy=1:2:3", "words"),
        ('alpha="0.1', "JSON"),
        ("world.x=[1", "JSON"),
    ],
)
def test_what_is_refused(text: str, expected: str) -> None:
    with pytest.raises(ValueError, match=r".") as fault:
        read_variation(text)
    assert expected in str(fault.value)
    assert "\n" not in str(fault.value)


numbers = st.decimals(min_value=-(10**6), max_value=10**6, places=4).map(lambda number: f"{number:f}")
words = st.text(
    st.characters(codec="utf-8", exclude_categories=["Cs"], exclude_characters="\0"), min_size=1, max_size=12
)


@st.composite
def variations(draw: st.DrawFn) -> Variation:
    kind = draw(st.sampled_from(["spread", "numbers", "words", "names"]))
    if kind == "names":
        some = st.lists(st.sampled_from([*BY_ID]), min_size=1, unique=True)
        return Variation("algorithm", tuple(draw(some)))
    if kind == "words":
        return Variation("scenario", tuple(draw(st.lists(words, min_size=1, max_size=4, unique=True))))
    if kind == "numbers":
        some_values = st.one_of(st.booleans(), st.integers(-(10**9), 10**9), words)
        unique = st.lists(some_values, min_size=1, max_size=4, unique_by=lambda value: (type(value), value))
        listed = tuple(each for each in draw(unique) if not str(each).startswith(("[", "{")))
        return Variation("world.some_key", listed or (1,))
    ends = sorted(draw(st.lists(numbers, min_size=2, max_size=2, unique_by=Fraction)), key=Fraction)
    logarithmic = Fraction(ends[0]) > 0 and draw(st.booleans())
    return Variation("world.key", spread=Spread(ends[0], ends[1], draw(st.integers(2, 50)), logarithmic))


@given(variations())
def test_what_is_written_is_read_back(variation: Variation) -> None:
    assert read_variation(variation.text) == variation


@given(variations())
def test_values_ascend_between_the_ends(variation: Variation) -> None:
    spread = variation.spread
    if spread is None:
        return
    found = [float(Fraction(str(variation.value(index)))) for index in range(spread.count)]
    assert found == sorted(set(found))
    assert (found[0], found[-1]) == (float(spread.low), float(spread.high))


@given(st.floats(0, 1, exclude_max=True), st.sampled_from(["0.01:1:log", "0.123456789:0.9", "1:64:log:7"]))
def test_what_is_drawn_lies_between_the_ends(share: float, text: str) -> None:
    variation = read_variation(f"initial_q={text}")
    low, high = (float(each) for each in text.split(":")[:2])
    assert low <= float(str(variation.drawn(share))) <= high


def test_shares_that_are_uniform_draw_alike_by_ratio_and_by_whole_numbers() -> None:
    by_ratio = read_variation("alpha=0.01:1:log")
    assert by_ratio.drawn(0.5) == 0.1
    whole = read_variation("n=1:4")
    assert [whole.drawn(place / 8) for place in range(8)] == [1, 1, 2, 2, 3, 3, 4, 4]
    words = read_variation(f"policy={','.join(POLICY_BY_ID)}")
    assert words.drawn(0.999) == list(POLICY_BY_ID)[-1]
