"""What commands print: JSON for programs, aligned columns for people."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from typing import Any

import click

from rl_tui.common.findings import printable


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
    """Return a figure as people read it; a word stays as it is, and what is not known is a dash."""
    if value is None:
        return "-"
    return value if isinstance(value, str) else format(value, form)


def can_print(text: str) -> bool:
    """Return whether stdout has all the characters of ``text``."""
    try:
        text.encode(getattr(sys.stdout, "encoding", None) or "ascii")
    except UnicodeEncodeError:
        return False
    return True
