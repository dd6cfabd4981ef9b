"""The texts of a lesson as lines."""

from __future__ import annotations

import pytest
from rich.cells import cell_len
from samples import look

from rl_tui.screen.draw.canvas import Line
from rl_tui.screen.panels.lesson.prose import plain, prose_lines
from rl_tui.screen.playground.actions.lesson import NO_COMMA, read_answer

TEXT = """
A first paragraph, with **bold words** in it
over two rows.

- an item
- another one,
  over two rows

    Q(s,a) ← Q(s,a)  +  α · δ

The `end` of **it**."""


def rows(text: str, width: int, *, ascii: bool = False) -> list[str]:  # noqa: A002
    return ["".join(piece.text for piece in line) for line in prose_lines(text, width, look(ascii))]


def styled(line: Line, style: object) -> list[str]:
    return [piece.text for piece in line if piece.style == style]


def test_paragraphs_items_and_equations_stand_apart() -> None:
    assert rows(TEXT, 60) == [
        "A first paragraph, with bold words in it over two rows.",
        "",
        "– an item",
        "– another one, over two rows",
        "",
        "  Q(s,a) ← Q(s,a)  +  α · δ",
        "",
        "The end of it.",
    ]


@pytest.mark.parametrize("ascii", [False, True])
@pytest.mark.parametrize("width", [1, 2, 3, 7, 20, 38, 78])
def test_no_line_is_wider_than_its_room_and_no_word_is_lost(width: int, ascii: bool) -> None:  # noqa: A002
    written = rows(TEXT, width, ascii=ascii)
    assert all(cell_len(row) <= max(width, 3) for row in written)
    letters = "".join("".join(written).split())
    for word in ("paragraph,", "another", "end"):
        assert word in letters


def test_marks_are_styles_and_an_asterisk_alone_is_itself() -> None:
    palette = look().palette
    (line,) = prose_lines("**α** is `epsilon` · 2 * 3 [b]x[/b]", 60, look())
    assert styled(line, palette.strong) == ["α"]
    assert styled(line, palette.press) == ["epsilon"]
    assert "".join(piece.text for piece in line) == "α is epsilon · 2 * 3 [b]x[/b]"


def test_two_keys_stay_in_one_line_and_other_code_may_break() -> None:
    assert rows("Then press `w n` twice.", 13) == ["Then press", "w n twice."]
    assert rows("Then press `run it` twice.", 15) == ["Then press run", "it twice."]


def test_a_mark_may_end_within_a_word() -> None:
    assert rows("**Q**(s), `γ`.", 40) == ["Q(s), γ."]


def test_plain_is_one_line_without_marks() -> None:
    assert plain("What is\n**Q** of `study`?") == "What is Q of study?"


def test_ascii_spells_what_the_terminal_lacks() -> None:
    assert rows("- α → 1 ≥ 0", 40, ascii=True) == ["- alpha -> 1 >= 0"]


@pytest.mark.parametrize(
    ("typed", "number"),
    [
        ("0.5", 0.5),
        (" −1.5 ", -1.5),
        ("-2", -2.0),
        (".25", 0.25),
        ("1/3", 1 / 3),
        ("−3 / 4", -0.75),
        ("1e-3", 0.001),
        ("184616", 184_616.0),
        ("+7.", 7.0),
    ],
)
def test_a_number_is_read(typed: str, number: float) -> None:
    assert read_answer(typed) == pytest.approx(number)


@pytest.mark.parametrize("typed", ["", "half", "1/0", "nan", "inf", "1e999", "--1", "0x10", "1/", "٣", "1 2"])
def test_what_is_no_number_is_refused(typed: str) -> None:
    with pytest.raises(ValueError, match=r"number|division"):
        read_answer(typed)


@pytest.mark.parametrize("typed", ["0,5", "-1,5", "12,34", "0,125", "184,616"])
def test_a_comma_is_refused_since_it_may_mean_two_things(typed: str) -> None:
    with pytest.raises(ValueError, match="decimal point") as refused:
        read_answer(typed)
    assert str(refused.value) == NO_COMMA
