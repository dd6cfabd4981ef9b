"""What commands print: JSON for programs, aligned columns for people."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Sequence
from typing import Any, Final

import click

from rl_tui.common.findings import printable

_DIGITS: Final = 5
_SMALLEST: Final = 1e-5
_NOISE: Final = 1e-12  # what binary fractions leave of a zero


def print_json(document: Any) -> None:
    """Print one JSON document on stdout; raises ValueError if there is a NaN or an infinity in it."""
    click.echo(json.dumps(document, allow_nan=False))


def complain(message: str) -> None:
    """Print ``message`` on stderr; characters that a terminal might obey are written out."""
    click.echo("\n".join(map(printable, message.split("\n"))), err=True)


def columns(rows: Sequence[Sequence[str]], right: Sequence[int] = ()) -> str:
    """Return ``rows`` of equal length as aligned columns; those in ``right`` are aligned to the right."""
    from rich.cells import cell_len

    widths = [max(cell_len(cell) for cell in column) for column in zip(*rows, strict=True)]

    def padded(row: Sequence[str]) -> str:
        cells = []
        for place, (cell, width) in enumerate(zip(row, widths, strict=True)):
            space = " " * (width - cell_len(cell))
            cells.append(space + cell if place in right else cell + space)
        return "  ".join(cells).rstrip()

    return "\n".join(padded(row) for row in rows)


def number(value: float | str | None, form: str = ".5g") -> str:
    """Return a figure as people read it; a word stays as it is, and what is not known is a dash.

    What rounding errors leave of a zero is 0.
    """
    if value is None:
        return "-"
    return value if isinstance(value, str) else format(_without_noise(value), form)


def alike(values: Sequence[float | None]) -> list[str]:
    """Return figures that stand beside one another with as many decimals each, five digits of the largest.

    Where they all are below 1e-5 they all have an exponent. Zeros that all of them end with are left out, and
    what would read 0 and is not is a bound.
    """
    known = [_without_noise(value) for value in values if value is not None]
    largest = max(map(abs, known), default=0.0)
    if 0.0 < largest < _SMALLEST:
        return [number(value, ".3e") if value else number(value) for value in values]
    decimals = max(0, _DIGITS - 1 - math.floor(math.log10(largest))) if largest else 0
    plain = [f"{value:.{decimals}f}" for value in known]
    while decimals and all(text.endswith("0") for text in plain):
        decimals, plain = decimals - 1, [text[:-1].removesuffix(".") for text in plain]
    shown = iter(_bounded(value, text, decimals) for value, text in zip(known, plain, strict=True))
    return ["-" if value is None else next(shown) for value in values]


def _bounded(value: float, text: str, decimals: int) -> str:
    if any(digit in text for digit in "123456789"):
        return text
    bound = f"{10.0**-decimals:.{decimals}f}"
    return text.removeprefix("-") if not value else f"<{bound}" if value > 0.0 else f">-{bound}"


def _without_noise(value: float) -> float:
    return 0.0 if abs(value) < _NOISE else value


def can_print(text: str) -> bool:
    """Return whether stdout has all the characters of ``text``."""
    try:
        text.encode(getattr(sys.stdout, "encoding", None) or "ascii")
    except UnicodeEncodeError:
        return False
    return True
