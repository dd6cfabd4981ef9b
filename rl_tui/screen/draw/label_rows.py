"""Rows for the labels of lines, beside their ends, where several end close together."""

from __future__ import annotations

from collections.abc import Sequence


def apart(wanted: Sequence[int], rows: int) -> list[int]:
    """Return a row of its own for each of ``wanted`` (ascending, at most ``rows``).

    Together they are moved as little as can be; where there is a choice, upwards.
    """
    reach = len(wanted)
    placed: dict[int, tuple[int, tuple[int, ...]]] = {-1: (0, ())}  # by the row of the last: moves, rows
    for row in wanted:
        placed = {
            place: min(
                (moves + abs(place - row), (*above, place))
                for last, (moves, above) in placed.items()
                if last < place
            )
            for place in range(max(0, row - reach), min(rows, row + reach + 1))
            if place > min(placed)
        }
    return list(min(placed.values())[1])
