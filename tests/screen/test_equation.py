"""Words above equations, and braces below."""

from __future__ import annotations

import pytest
from samples import look

from rl_tui.screen.draw.canvas import Piece
from rl_tui.screen.kit.blocks import Equation, Term

STYLE = look().palette.text
EQUATION = Equation(
    Term("", "now", ".38"),
    [
        Term(" = ", "was", ".36"),
        Term(" + ", "α", ".10"),
        Term("·(", "r", "−100"),
        Term(" − ", "was", ".36"),
        Term(")"),
    ],
    Piece("δ", STYLE),
)


def lines(width: int, *, ascii: bool = False) -> list[str]:  # noqa: A002
    return ["".join(each.text for each in line) for line in EQUATION.lines(width, look(ascii))]


def test_each_word_begins_where_its_number_does() -> None:
    assert lines(40) == [
        " now = was + α  ·(r    − was)",
        " .38 = .36 + .10·(−100 − .36)",
        "                 ╰─── δ ────╯",
    ]


def test_a_word_that_ascii_spells_out_makes_room() -> None:
    assert lines(40, ascii=True) == [
        " now = was + alpha*(r    - was)",
        " .38 = .36 + .10  *(-100 - .36)",
        "                   +- delta --+",
    ]


@pytest.mark.parametrize("ascii", [False, True])
def test_in_any_width_no_line_is_too_long_and_no_number_is_lost(ascii: bool) -> None:  # noqa: A002
    for width in range(16, 40):
        drawn = lines(width, ascii=ascii)
        assert max(map(len, drawn)) <= width
        text = "".join(drawn)
        assert all(text.count(number) == 1 for number in (".38", ".10", "100"))
        assert text.count(".36") == 2


def test_the_numbers_alone_are_groups_that_keep_their_operators() -> None:
    groups = ["".join(each.text for each in group) for group in EQUATION.numbers(look())]
    assert groups == [".36", " + .10", "·(−100", " − .36)"]
