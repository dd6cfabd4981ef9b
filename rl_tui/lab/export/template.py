"""Texts of Python in files: with sections, lines for some cases only, and places to fill in.

``# [tables]`` begins a section. A line that ends in ``#: ties first, not time limit`` stands only where the
first of these flags is set and the second is not. ``$name`` is a place for a piece, a line ``# $name`` one
for a piece of several lines.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from importlib.resources import files
from typing import Final

ENDING: Final = ".py.txt"
_HEAD: Final = re.compile(r"# \[(.+)\]")
_PLACE: Final = re.compile(r"\$(\w+)")
_LINE_OF_PLACE: Final = re.compile(r"( *)(?:# )?\$(\w+)")


def sections(module: str, flags: Collection[str] = ()) -> dict[str, str]:
    """Return the sections of the text beside ``module``, by name, with the lines that ``flags`` call for.

    Raises FileNotFoundError where there is no such text, ModuleNotFoundError where there is no such package,
    ValueError where the module is in none.
    """
    package, _, name = module.rpartition(".")
    text = (files(package) / f"{name}{ENDING}").read_text(encoding="utf-8")
    found: dict[str, list[str]] = {}
    lines: list[str] = []
    for marked in text.splitlines():
        line, _, mark = marked.partition("  #: ")
        if head := _HEAD.fullmatch(line):
            lines = found[head[1]] = []
        elif all(_holds(flag, flags) for flag in mark.split(", ") if flag):
            lines.append(line)
    return {name: "\n".join(lines).strip("\n") for name, lines in found.items()}


def _holds(flag: str, flags: Collection[str]) -> bool:
    return flag[4:] not in flags if flag.startswith("not ") else flag in flags


def fill(text: str, pieces: Mapping[str, str]) -> str:
    """Return ``text`` with each ``$name`` replaced by its piece.

    A line that is nothing but a place takes a piece of several lines, indented as it is itself, and is left
    out where the piece is empty. Raises KeyError where a piece is missing.
    """
    lines: list[str] = []
    for line in text.split("\n"):
        alone = _LINE_OF_PLACE.fullmatch(line)
        if alone is None:
            lines.append(_PLACE.sub(lambda place: pieces[place[1]], line))
            continue
        indent, piece = alone[1], pieces[alone[2]]
        lines += [indent + each if each else "" for each in piece.split("\n")] if piece else []
    return "\n".join(lines)
