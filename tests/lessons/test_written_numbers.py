"""Numbers as written in texts."""

from __future__ import annotations

import pytest

from rl_tui.lessons.figures.written import written_number

pytestmark = pytest.mark.unit


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("−1.5", -1.5),
        ("-1.5", -1.5),
        ("+4.0", 4.0),
        (".5188", 0.5188),
        ("184,616", 184_616.0),
        ("≈ 184,616", 184_616.0),
        ("52 %", 0.52),
        ("52%", 0.52),
        ("14/17", 14 / 17),
        ("−1/3", -1 / 3),
        ("⅓", 1 / 3),
        ("5.4·10⁻⁶", 5.4e-6),
        ("2·10¹³", 2e13),
        ("−10⁻³", -1e-3),
        ("1e-3", 1e-3),
    ],
)
def test_what_a_text_writes(text: str, value: float) -> None:
    found = written_number(text)
    assert found.value == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    "text",
    [
        *("", "study", "1,23", "1/0", "12 3", "1.2.3", "±", "7 ±", "10⁻", "nan", "inf", "٣"),
        *("1e400", "10⁴⁰⁰", "1·10⁴⁰⁰"),
    ],
)
def test_what_is_no_number(text: str) -> None:
    assert written_number(text) is None


@pytest.mark.parametrize(
    ("text", "right", "wrong"),
    [
        ("6.3415", 6.34146, 6.34156),
        ("−1.5", -1.5, -1.56),
        ("52 %", 0.5249, 0.526),
        ("94.7 %", 0.94674, 0.9460),
        ("184,616", 184_615.7, 184_617.0),
        ("184,600", 184_600.4, 184_616.0),
        ("≈ 184,600", 184_616.0, 184_660.0),
        ("5.4·10⁻⁶", 5.41665e-6, 5.46e-6),
        ("14/17", 14 / 17, 0.8235),
        ("7.0", 7.04, 7.06),
        ("2.5", 2.55, 2.5501),
    ],
)
def test_a_number_is_right_to_its_last_digit(text: str, right: float, wrong: float) -> None:
    number = written_number(text)
    assert number.agrees_with(right)
    assert not number.agrees_with(wrong)
    assert not number.agrees_with(float("nan"))


@pytest.mark.parametrize(
    ("text", "mean", "error"),
    [
        ("70.9 ± 0.7", 70.9, 0.7),
        ("52 % ± 3 %", 0.52, 0.03),
        ("(52 ± 3) %", 0.52, 0.03),
        ("52 ± 3 %", 0.52, 0.03),
    ],
)
def test_a_mean_with_its_error(text: str, mean: float, error: float) -> None:
    number = written_number(text)
    assert (number.value, number.error.value) == (pytest.approx(mean), pytest.approx(error))
