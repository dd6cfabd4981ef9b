"""Expressions of figures."""

from __future__ import annotations

from typing import Any

import pytest

from rl_tui.lessons.figures.expression import FigureError, evaluate, read_expression

pytestmark = pytest.mark.unit


def worked_out(text: str) -> Any:
    """The value of an expression if ``two`` is 2 and every function returns its argument."""
    names = {"two": 2.0, "word": "study"}

    def look(name: str) -> Any:
        if name not in names:
            raise FigureError(name, "a name")
        return names[name]

    return evaluate(read_expression(text), look, lambda name, given, named: (name, given, named))


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1 + 2 * 3", 7.0),
        ("-two ** 2", -4.0),
        ("−2 + .9 * (10 − 1)", 6.1),
        ("two / 4", 0.5),
        ("2 ** 0.5", 2**0.5),
        ("'a'", "a"),
        ("word", "study"),
        ("f(1, 'x', [two, -1], g={'a': 'b'})", ("f", [1, "x", [2.0, -1.0]], {"g": {"a": "b"}})),
    ],
)
def test_what_an_expression_comes_to(text: str, value: Any) -> None:
    assert worked_out(text) == (pytest.approx(value) if isinstance(value, float) else value)


_REFUSED = (
    "1 + | two.real | ().__class__ | __import__('os').system('true') | f(x for x in two) | [x for x in "
    "[1]] | {x for x in [1]} | lambda: 1 | f'{two}' | 1 if two else 2 | two > 1 | not two | two and two |"
    " two[0] | f(*[1]) | f(**{'a': 1}) | {**{'a': 1}} | (x := 1) | 7 // 2 | 7 % 2 | 1 << 9 | ~1 | 1j | "
    "b'a' | None | ... | two; two | two = 1 | 1e16 | 'a' + 'b' | 'a' * 3 | True + 1 | 1 / 0 | 0 ** -1 | "
    "(-8) ** 0.5 | 9e14 ** 900 | f(1) + 1 | two(1)(2)"
)


@pytest.mark.parametrize(
    "text",
    [
        "",
        *_REFUSED.split(" | "),
        "9" * 4000,
        "(" * 300 + "1" + ")" * 300,
        "-" * 40 + "1",
        "+".join("1" * 400),
    ],
)
def test_all_else_is_refused(text: str) -> None:
    with pytest.raises(FigureError) as refusal:
        worked_out(text)
    assert "\n" not in str(refusal.value)
    assert len(str(refusal.value)) < 400
