"""A result that prints as a short table, and as HTML in a notebook."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from html import escape


class ShortTable:
    """What a result says of itself when it is printed, or is the last value of a notebook's cell."""

    @abstractmethod
    def _caption(self) -> str:
        """Return what it is the result of, in a line."""

    @abstractmethod
    def _rows(self) -> Sequence[Sequence[str]]:
        """Return the cells, all rows of equal length. The first of a row says what the others are."""

    def __str__(self) -> str:
        rows = self._rows()
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = ("  ".join(map(str.ljust, row, widths)).rstrip() for row in rows)
        return "\n".join((self._caption(), *lines))

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Return it as a table of HTML; whatever stands in it is text there."""
        body = "".join(
            f"<tr><th>{escape(first)}</th>{''.join(f'<td>{escape(cell)}</td>' for cell in others)}</tr>"
            for first, *others in self._rows()
        )
        return f"<table><caption>{escape(self._caption())}</caption><tbody>{body}</tbody></table>"


def figure(value: float | str | None) -> str:
    """Return a figure as it stands in a table: five digits, a dash for what is not known."""
    if value is None:
        return "-"
    return value if isinstance(value, str) else format(value, ",d" if isinstance(value, int) else ".5g")
