"""Printed updates can be recalculated."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st
from samples import lake, learned_from, look

from rl_tui.agents.catalogue import Lookup
from rl_tui.live.last_step.backup import Backup, Leaf
from rl_tui.live.last_step.step_report import story_of
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.precision import figure
from rl_tui.screen.kit.blocks import lines_of
from rl_tui.screen.panels.last_step.last_step import last_step_lines
from rl_tui.screen.panels.last_step.update_text import UpdateText, update_text
from rl_tui.screen.panels.last_step.words import words_of
from rl_tui.screen.panels.microscope.backup import outcome_table, target_blocks
from rl_tui.screen.theme.glyphs import ASCII, UNICODE

LAKE = lake()
LAST = LAKE.counters.last_step
assert LAST is not None

# digits and a power of ten: typical sizes of learners, and far beyond in both directions
SIZES = st.tuples(st.floats(1.0, 9.99), st.integers(-14, 11)).map(lambda pair: pair[0] * 10.0 ** pair[1])
NUMBERS = st.one_of(
    st.sampled_from([0.0, 1.0, -1.0, 0.5, 20.0, -100.0]),
    st.floats(-20, 20),
    SIZES,
    SIZES.map(lambda size: -size),
)
STEP_SIZES = st.one_of(
    st.sampled_from([0.05, 0.1, 0.5, 1.0]),
    st.integers(1, 10**6).map(lambda visits: 1.0 / visits),  # a sample average
    st.tuples(st.floats(0.01, 1.0), st.integers(1, 60)).map(
        lambda pair: pair[0] * 0.891 ** pair[1]
    ),  # a trace
)
GAMMAS = st.one_of(st.sampled_from([0.0, 0.9, 0.99, 1.0]), st.floats(0.01, 1.0))


def value(text: str) -> float:
    return float(Fraction(text) if "/" in text else text.replace(UNICODE.minus, "-"))


def last_digit(text: str) -> float:
    mantissa, _, exponent = text.partition("e")
    return 10.0 ** (int(exponent or "0") - len(mantissa.partition(".")[2]))


def contradictions(text: UpdateText, *, bootstraps: bool) -> list[str]:
    """The printed results that do not follow from the printed numbers before them."""
    before, gathered = value(text.before), value(text.gathered)
    bootstrap = value(text.discount) * value(text.bootstrap) if bootstraps else 0.0
    error = gathered + bootstrap - before
    largest = max(map(abs, (before, gathered, bootstrap)))
    # a 0 has no digits: take the precision of the other results, with six known digits after the first
    fine = [last_digit(each) for each in (text.target, text.after) if each != "0"]
    nothing = max([*fine, 2e-6 * largest])
    worked_out = (
        ("target", gathered + bootstrap, text.target),
        ("δ", error, text.error),
        ("δ by the target", value(text.target) - before, text.error),
        ("estimate", before + value(text.step_size) * error, text.after),
        ("estimate by δ", before + value(text.step_size) * value(text.error), text.after),
    )
    return [
        f"{name}: {number} is printed as {shown} in {text}"
        for name, number, shown in worked_out
        if abs(number - value(shown))
        > 1.00001 * (last_digit(shown) if shown != "0" else nothing) + 1e-11 * largest
    ]


@given(
    before=NUMBERS,
    gathered=NUMBERS,
    bootstrap=NUMBERS,
    step_size=STEP_SIZES,
    gamma=GAMMAS,
    power=st.integers(1, 8),
    alpha=st.sampled_from([0.1, "sample-average"]),
    form=st.sampled_from(["one step", "several steps", "terminal", "converged"]),
)
@example(0.00013, 0.0, 0.000159, 0.1, 0.99, 1, 0.1, "one step")
@example(-7.0, -1.0, -6.0000000049, 0.5, 1.0, 1, 0.5, "one step")
@example(1.8356172431393247, -100.0, 1.1223826259626861, 0.05, 0.99, 1, 0.05, "one step")
def test_the_printed_update_does_not_contradict_itself(
    before: float,
    gathered: float,
    bootstrap: float,
    step_size: float,
    gamma: float,
    power: int,
    alpha: float | str,
    form: str,
) -> None:
    discount = gamma**power if form == "several steps" else gamma
    if form == "terminal":
        bootstrap = 0.0
    if form == "converged":
        before = gathered + discount * bootstrap + before * 1e-4
    last = learned_from(
        LAST,
        before=before,
        gathered=gathered,
        bootstrap=bootstrap,
        step_size=step_size,
        gamma=gamma,
        discount=discount,
    )
    bootstraps = form != "terminal"
    text = update_text(last, alpha, UNICODE, bootstraps=bootstraps)
    assert not contradictions(text, bootstraps=bootstraps)


@given(before=st.floats(-20, 20), bootstrap=st.floats(-20, 20), step_size=st.sampled_from([0.05, 0.1, 0.5]))
def test_numbers_of_a_common_size_stay_short(before: float, bootstrap: float, step_size: float) -> None:
    last = learned_from(LAST, before=before, bootstrap=bootstrap, step_size=step_size)
    assume(abs(last.td_error) > 0.01)
    text = update_text(last, step_size, UNICODE, bootstraps=True)
    for each in (text.before, text.bootstrap, text.target, text.error, text.after):
        assert len(each.lstrip("+−").partition(".")[2]) <= 7


@given(before=NUMBERS, gathered=NUMBERS, bootstrap=NUMBERS, step_size=STEP_SIZES)
def test_a_large_screen_prints_the_digits_of_a_small_one(
    before: float, gathered: float, bootstrap: float, step_size: float
) -> None:
    last = learned_from(
        LAST, before=before, gathered=gathered, bootstrap=bootstrap, step_size=step_size, discount=0.99
    )
    assume(last.td_error != 0.0)
    written = [last_step_lines(lake(last_step=last), look(), 150, height) for height in (1, 2, 4, 8)]
    short, *others = ("".join(piece.text for line in lines for piece in line) for lines in written)
    story = story_of(lake(last_step=last))
    assert story is not None
    update = words_of(story, UNICODE).update
    for number in (update.before, update.gathered, update.step_size, update.bootstrap, update.after):
        assert number in short
        assert all(number in other for other in others)


def test_small_values_are_printed_with_digits_to_work_with() -> None:
    last = replace(
        LAST, before=0.00013, bootstrap=0.000159, after=0.00013 + 0.1 * (0.99 * 0.000159 - 0.00013)
    )
    text = update_text(last, 0.1, UNICODE, bootstraps=True)
    assert (text.before, text.bootstrap, text.target) == (".000130", ".000159", ".000157")
    assert (text.error, text.after) == ("+.000027", ".000133")


def test_a_small_change_of_a_large_estimate_is_printed() -> None:
    last = replace(LAST, before=0.95, bootstrap=0.959600, after=0.9500004)
    text = update_text(last, 0.1, UNICODE, bootstraps=True)
    assert (text.target, text.error, text.after) == (".950004", "+.000004", ".950000")


@pytest.mark.parametrize(
    ("x", "decimals", "text"),
    [
        (0.00013, 6, ".000130"),
        (0.000027345, 6, ".000027"),
        (1.3456e-7, 9, "1.35e-7"),
        (2.73e-9, 4, "2.73e-9"),
        (-3.0012e11, -9, "−3e11"),
        (12_345_678.0, -4, "1.235e7"),
        (12_345_678.25, 2, "12345678.25"),
        (-1.0, 4, "−1"),
        (0.5, 6, ".5"),
        (0.0, 3, "0"),
        (-1e-12, 3, "0"),
        (0.950000004, 8, ".95000000"),
    ],
)
def test_a_figure_of_an_equation(x: float, decimals: int, text: str) -> None:
    assert figure(x, decimals, UNICODE) == text
    assert figure(x, decimals, ASCII) == text.replace("−", "-")


def test_what_is_not_finite_is_written_as_such() -> None:
    assert [figure(x, 3, UNICODE) for x in (math.inf, -math.inf, math.nan)] == ["inf", "−inf", "nan"]


STORY = story_of(LAKE)
assert STORY is not None
WORDS = words_of(STORY, UNICODE)
WORTHS = st.one_of(st.sampled_from([0.0, 0.5]), st.floats(0.0, 1.0), SIZES.filter(lambda size: size < 1.0))


@given(
    values=st.lists(WORTHS, min_size=3, max_size=3),
    sampled=st.integers(0, 2),
    gamma=st.sampled_from([0.9, 0.99]),
)
def test_the_microscope_does_not_contradict_itself(values: list[float], sampled: int, gamma: float) -> None:
    leaves = tuple(Leaf(1 / 3, 1, 0.0, 0.0, 1, False, value, False) for value in values)
    shares = [gamma * value / 3 for value in values]
    backup = Backup(0, 0, leaves, gamma, gamma * values[sampled], sum(shares), Lookup.BEST, is_current=True)
    table = outcome_table(LAKE.world, backup, leaves, look(), is_whole=True, secret=False)
    for row in table.lines(85, look())[1:]:
        printed, share = (piece.text.strip() for piece in row[-2:])
        finest = min(last_digit(share), 1.0) if share != "0" else 1e-3
        assert abs(gamma * value(printed) / 3 - value(share)) <= 1.001 * finest + numbers.NEGLIGIBLE
    lines = lines_of(target_blocks(WORDS, backup, look(), secret=()), 80, look())
    first, second = ("".join(piece.text for piece in line).split()[-1] for line in lines[:2])
    told = "".join(piece.text for piece in lines[2]).split()[1]
    finest = max(last_digit(each) for each in (first, second, told) if each != "0") if told != "0" else 1e-6
    assert abs(value(first) - value(second) - value(told)) <= 1.001 * finest + numbers.NEGLIGIBLE
