"""The text that a widget draws, edges and padding included."""

from __future__ import annotations

from textual.widget import Widget


def rows_of(widget: Widget) -> list[str]:
    """Every row from edge to edge: rows are cut out of what is drawn, and ``size`` leaves the padding out."""
    return [row.text for row in widget.render_lines(widget.outer_size.region)]


def words_of(widget: Widget) -> str:
    """Its words with a blank between them, wherever lines are broken."""
    return " ".join(" ".join(rows_of(widget)).split())


def letters_of(widget: Widget) -> str:
    """All without blanks: a path may be broken at any letter, and where depends on the folder it is in."""
    return "".join("".join(rows_of(widget)).split())
