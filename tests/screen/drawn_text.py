"""The text that a widget draws."""

from __future__ import annotations

from textual.widget import Widget


def rows_of(widget: Widget) -> list[str]:
    """Every row from edge to edge, because ``size`` excludes the padding."""
    return [row.text for row in widget.render_lines(widget.outer_size.region)]


def words_of(widget: Widget) -> str:
    """Its words with single blanks, whatever the line breaks."""
    return " ".join(" ".join(rows_of(widget)).split())


def letters_of(widget: Widget) -> str:
    """Its letters without blanks: a path may break at any letter."""
    return "".join("".join(rows_of(widget)).split())
