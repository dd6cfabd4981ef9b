"""The terminal emulator of the tests."""

from __future__ import annotations

import pytest
from emulator import Emulator

COLOURED = (
    b"\x1b[?1049h\x1b[>1u\x1b[?2026$p\x1b[?u\x1b[2;3H\x1b[38;5;196;48;2;1;2;3;1mred \xe2\x94\x82\x1b[0m plain"
    b"\x1b[4;1H\x1b[7mbackwards\x1b[m\x1b]0;title\x07\x1bP1$r0m\x1b\\end\x1b[<u"
)

pytestmark = pytest.mark.unit


def test_sequences_that_pyte_does_not_know_leave_nothing_on_the_screen() -> None:
    emulator = Emulator(20, 4)
    emulator.feed(COLOURED)
    assert emulator.text == "\n  red │ plain\n\nbackwardsend"


def test_it_does_not_matter_where_the_output_is_cut() -> None:
    whole, cut = Emulator(20, 4), Emulator(20, 4)
    whole.feed(COLOURED)
    for at in range(len(COLOURED)):
        cut.feed(COLOURED[at : at + 1])
    assert cut.text == whole.text
    assert [cut.cell(x, 1) for x in range(20)] == [whole.cell(x, 1) for x in range(20)]


def test_cells_have_their_colours() -> None:
    emulator = Emulator(20, 4)
    emulator.feed(COLOURED)
    red, plain, backwards = emulator.cell(2, 1), emulator.cell(8, 1), emulator.cell(0, 3)
    assert (red.data, red.fg, red.bg, red.bold) == ("r", "ff0000", "010203", True)
    assert (plain.fg, plain.bg, plain.bold) == ("default", "default", False)
    assert backwards.reverse


def test_the_alternate_screen_gives_the_main_one_back() -> None:
    emulator = Emulator(20, 4)
    emulator.feed(b"$ rl-tui\r\n\x1b[?1049h\x1b[2J\x1b[Hplayground")
    assert emulator.text == "playground\n\n\n"
    emulator.feed(b"\x1b[?1049ldone")
    assert emulator.text == "$ rl-tui\ndone\n\n"


@pytest.mark.parametrize(("tells", "answers"), [(True, ["\x1b[2;4R"]), (False, [])])
def test_it_says_where_the_cursor_is_only_if_told_to(tells: bool, answers: list[str]) -> None:
    got: list[str] = []
    Emulator(20, 4, got.append, tells_position=tells).feed(b"\x1b[2;1Habc\x1b[6n")
    assert got == answers


@pytest.mark.parametrize(("can", "answers"), [(True, ["\x1b[?2026;2$y"]), (False, [])])
def test_it_says_that_it_synchronises_only_if_told_to(can: bool, answers: list[str]) -> None:
    got: list[str] = []
    emulator = Emulator(20, 4, got.append, synchronises=can)
    emulator.feed(b"\x1b[?2026$p\x1b[?2048$p")
    assert got == answers
    emulator.feed(b"\x1b[?2026hhalf")
    assert not emulator.is_whole
    emulator.feed(b"\x1b[?2026l")
    assert emulator.is_whole


def test_text_past_the_last_column_stays_in_its_row_where_lines_do_not_wrap() -> None:
    emulator = Emulator(5, 2)
    emulator.feed(b"\x1b[?7l\x1b[1;4Habcd")
    assert emulator.text == "   ad\n"


def test_a_smaller_screen_is_read_at_its_size() -> None:
    emulator = Emulator(10, 3)
    emulator.feed(b"0123456789")
    emulator.resize(2, 5)
    assert len(emulator.text.splitlines()) <= 2
