"""Texts of Python with places to fill in."""

from __future__ import annotations

import re
from collections.abc import Mapping

_PLACE = re.compile(r"\$(\w+)")
_LINE_OF_PLACE = re.compile(r"( *)\$(\w+)")


def fill(text: str, pieces: Mapping[str, str]) -> str:
    """Return ``text`` with each ``$name`` replaced by its piece.

    A line that is nothing but a place takes a piece of several lines, indented as it is itself, and goes
    where the piece is empty. Raises KeyError where a piece is missing.
    """
    lines: list[str] = []
    for line in text.strip("\n").split("\n"):
        alone = _LINE_OF_PLACE.fullmatch(line)
        if alone is None:
            lines.append(_PLACE.sub(lambda place: pieces[place[1]], line))
            continue
        indent, piece = alone[1], pieces[alone[2]]
        lines += [indent + each if each else "" for each in piece.split("\n")] if piece else []
    return "\n".join(lines)
