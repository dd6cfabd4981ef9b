"""Symbols made of quadrant blocks."""

from __future__ import annotations

import pytest

from rl_tui.screen.draw.block_signs import SignName, block_number, block_sign, sign_size

MIRRORED = str.maketrans("▘▝▖▗▌▐▛▜▙▟▞▚", "▝▘▗▖▐▌▜▛▟▙▚▞")
FLIPPED = str.maketrans("▘▝▖▗▀▄▛▜▙▟▞▚", "▖▗▘▝▄▀▙▟▛▜▚▞")
SIZES = [(2 * rows, rows) for rows in range(2, 12)]


@pytest.mark.parametrize(("columns", "rows"), SIZES)
def test_opposite_arrows_are_mirror_images(columns: int, rows: int) -> None:
    right, left = (block_sign("arrow", columns, rows, (0, way)) for way in (1, -1))
    assert [row[::-1].translate(MIRRORED) for row in right] == list(left)
    down, up = (block_sign("arrow", columns, rows, (way, 0)) for way in (1, -1))
    assert [row.translate(FLIPPED) for row in reversed(down)] == list(up)
    assert len({right, left, down, up}) == 4


@pytest.mark.parametrize(("columns", "rows"), SIZES)
@pytest.mark.parametrize("name", ["agent", "ring", "square"])
def test_round_signs_are_symmetric_and_fill_their_size(name: SignName, columns: int, rows: int) -> None:
    sign = block_sign(name, columns, rows)
    assert [len(row) for row in sign] == [columns] * rows
    assert [row[::-1].translate(MIRRORED) for row in sign] == list(sign)
    assert [row.translate(FLIPPED) for row in reversed(sign)] == list(sign)


def test_from_six_rows_on_an_arrow_has_a_shaft() -> None:
    tail = [row[0] for row in block_sign("arrow", 10, 5, (0, 1))]
    assert tail.count(" ") == 0
    tail = [row[0] for row in block_sign("arrow", 12, 6, (0, 1))]
    assert tail.count(" ") > 2


def test_a_diagonal_fills_the_corner_it_points_at() -> None:
    assert block_sign("arrow", 6, 3, (1, 1)) == ("    ▗▟", "  ▗▟██", "▗▟████")


def test_a_low_star_is_set_by_hand_with_a_row_free_above_and_below() -> None:
    assert block_sign("star", 8, 4) == ("   ▗▖   ", " ▄▄██▄▄ ", "  █▛▜█  ", " ▝▘  ▝▘ ")
    for columns, rows in [(6, 3), (8, 4), (8, 5), (10, 6)]:
        sign = block_sign("star", columns, rows)
        assert [row[::-1].translate(MIRRORED) for row in sign] == list(sign)


def test_other_signs_than_arrows_are_centred_in_their_rows() -> None:
    assert block_sign("ring", 4, 3) == ("▗▄▄▖", "█  █", "▝▀▀▘")


@pytest.mark.parametrize(
    ("cell", "size"),
    [((7, 3), (4, 2)), ((9, 4), (6, 3)), ((11, 5), (6, 3)), ((17, 6), (6, 3)), ((23, 9), (10, 5))],
)
def test_a_sign_grows_with_its_cell(cell: tuple[int, int], size: tuple[int, int]) -> None:
    assert sign_size(*cell) == size


def test_a_number_has_three_rows_in_blocks_unless_it_is_more_than_digits() -> None:
    assert block_number(".17") == ("  ▀█  ▀▀█", "   █   ▄▀", "▀ ▀▀▀  ▀ ")
    assert {len(row) for row in block_number("−12.5")} == {17}
    assert block_number("1e5") == block_number("") == ()
