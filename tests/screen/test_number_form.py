"""All numbers of a panel have one form."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rl_tui.screen.draw.number_form import NumberForm, SteadyForms, number_form
from rl_tui.screen.theme.glyphs import ASCII


@pytest.mark.parametrize(
    ("values", "width", "most", "texts"),
    [
        ((0.54, 0.0, 1e-4), 5, 3, ("0.540", "0.000", "<.001")),
        ((-0.54, 0.25, 0.0), 5, 3, ("−.540", ".250", ".000")),
        ((-113.0, -9.0, -0.2), 5, 3, ("−113", "−9", "−.2")),
        ((0.86, 0.36, -0.004), 4, 2, (".86", ".36", "0⁻")),
        ((0.86, 0.36, 0.004), 3, 2, (".86", ".36", "0⁺")),
        ((1.4e-3, 4.1e-4, 4.4e-4), 6, 3, ("0.0014", "0.0004", "0.0004")),
        ((4.1e-7, 3.14e-8, 0.0), 6, 3, ("4.1e-7", "3.1e-8", "0")),
        ((4e-4, 1e-5, 0.0), 4, 2, ("4e-4", "1e-5", "0")),
        ((10.0, 6.37, 0.5), 6, 2, ("10.00", "6.37", "0.50")),
        ((-1e-12, 0.5, -3.17e-36), 6, 3, ("0.000", "0.500", "0.000")),
    ],
)
def test_numbers_of_a_panel_have_one_form(values, width: int, most: int, texts) -> None:
    form = number_form(values, width, most)
    assert tuple(map(form.text, values)) == texts


def test_what_is_almost_zero_has_ascii_characters_too() -> None:
    form = number_form([-0.9, 0.9], 4, 2)
    assert [form.text(x, ASCII) for x in (0.001, -0.001, -0.9)] == ["0+", "0-", "-.90"]


@given(
    st.lists(st.floats(-1e4, 1e4).filter(lambda x: abs(x) > 1.0), min_size=1, max_size=4), st.integers(5, 9)
)
def test_what_is_shown_has_the_same_number_of_decimals(values: list[float], width: int) -> None:
    form = number_form(values, width)
    texts = [form.text(value) for value in values]
    assert all(len(text) <= width for text in texts)
    assert len({len(text.partition(".")[2]) for text in texts}) == 1


@pytest.mark.parametrize(
    ("x", "width", "text"),
    [
        (0.94, 3, ".94"),
        (1.0, 3, "1.0"),
        (-1.0, 3, "−1"),
        (-0.55, 3, "−.6"),
        (0.87, 3, ".87"),
        (0.996, 3, ".99"),
        (-0.98, 3, "−.9"),
        (-0.98, 4, "−.98"),
        (-0.998, 4, "−.99"),
        (-3.05, 4, "−3.0"),
        (-113.0, 4, "−113"),
    ],
)
def test_few_numbers_that_are_too_long_do_not_take_decimals_from_the_others(x, width: int, text: str) -> None:
    form = number_form([*np.linspace(0.1, 0.9, 9), x], width, 2)
    assert form.decimals == 2
    assert form.text(x) == text


@pytest.mark.parametrize("decimals", [0, 1, 2])
@given(x=st.floats(-0.999, 0.999), width=st.integers(3, 6))
def test_what_is_less_than_1_is_never_rounded_to_1_by_being_shortened(
    x: float, width: int, decimals: int
) -> None:
    form = NumberForm(width, decimals, leading_zero=False)
    text = form.text(x)
    assert text not in ("1", "−1")
    assert "1." not in text or text.endswith("1." + decimals * "0")


@pytest.mark.parametrize("decimals", [0, 2, 3])
def test_what_rounding_errors_keep_from_1_is_written_as_1(decimals: int) -> None:
    form = NumberForm(4, decimals, leading_zero=False)
    for sign in (1.0, -1.0):
        assert form.text(sign * (1.0 - 4e-16)) == form.text(sign)
    assert NumberForm(4, 3, leading_zero=False).text(0.9997) == ".999"


def test_many_numbers_that_are_too_long_do() -> None:
    assert number_form([*np.linspace(-0.9, 0.9, 8), 0.5], 3, 2).decimals == 1
    assert number_form([-0.9, *np.linspace(0.1, 0.9, 7), *np.zeros(90)], 3, 2).decimals == 2
    assert number_form([-0.9, -0.9, *np.linspace(0.1, 0.9, 7), *np.zeros(90)], 3, 2).decimals == 1


@given(st.floats(-1e3, 1e3).filter(lambda x: abs(x) > 1e-9), st.integers(3, 9))
def test_only_zero_looks_like_zero(x: float, width: int) -> None:
    text = number_form([x, -1.0, 1.0], width).text(x)
    assert text.strip("−.0") != ""


def test_a_form_is_steady() -> None:
    forms = SteadyForms()
    assert forms.form("Q", [0.0, 9.9], 5).decimals == 3
    assert forms.form("Q", [0.0, 10.1], 5).decimals == 2
    assert forms.form("Q", [0.0, 9.9], 5).decimals == 2
    assert forms.form("Q", [0.0, 4.9], 5).decimals == 3
    assert forms.form("other", [0.0, 9.9], 5).decimals == 3
    forms.clear()
    wide, narrow = forms.form("Q", [-12.0, 0.0], 6, 2), forms.form("Q", [-9.0, 0.0], 6, 2)
    assert (wide.cells, narrow.cells) == (6, 6)
    forms.clear()
    assert forms.form("Q", [-9.0, 0.0], 6, 2).cells == 5
