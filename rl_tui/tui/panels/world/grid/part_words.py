"""Which part of a map is in view, in words."""

from __future__ import annotations


def shorter(legend: str) -> tuple[str, ...]:
    """Return ``legend``, then rows and columns alone, without further parts and what precedes a colon."""
    rows_and_columns = ", ".join(legend.split(", ")[:2])
    return legend, rows_and_columns, rows_and_columns.rpartition(": ")[2]


def stretch(first: int, shown: int, total: int) -> str:
    """Return which of ``total`` rows or columns ``shown`` ones are, counted from 0: ``3–12 of 40``."""
    return f"{first}–{first + shown - 1} of {total:,}"
