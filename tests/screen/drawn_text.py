"""The text that a widget draws, with edges and padding."""

from __future__ import annotations

from textual.widget import Widget


def rows_of(widget: Widget) -> list[str]:
    """Every row from edge to edge, cut out of the drawing, because ``size`` excludes the padding."""
    return [row.text for row in widget.render_lines(widget.outer_size.region)]


def words_of(widget: Widget) -> str:
    """Its words with single blanks, whatever the line breaks."""
    return " ".join(" ".join(rows_of(widget)).split())


def letters_of(widget: Widget) -> str:
    """Its letters without blanks: a path may break at any letter, depending on its folder."""
    return "".join("".join(rows_of(widget)).split())
