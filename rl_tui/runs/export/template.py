"""Templates of exported scripts, and the text of a world made from them.

``# [tables]`` begins a section. A line that ends in ``#: ties first, not time limit`` is used only if
the first flag is set and the second is not. ``$name`` is a place for a piece of text, a line ``#
$name`` for a piece of several lines.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from importlib.resources import files
from typing import Final

# Sections and places
#
# ``# [tables]`` begins a section. A line that ends in ``#: ties first, not time limit`` is kept only if the
# first of these flags is set and the second is not. ``$name`` is a place for a piece, a line ``# $name`` one
# for a piece of several lines.


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


# The text of a world


TEXTS: Final = sections(f"{__package__}.world")
FIELDS: Final = "probability, next_state, reward, terminated"
NOISY_FIELDS: Final = f"{FIELDS}, noise"


@dataclass(frozen=True, slots=True)
class WorldText:
    """A world in the words of a script.

    ``setup`` makes ``env``. ``outcomes(state, action)``, for those who plan, gives ``fields``; it is there
    already or comes with ``model``. ``starts`` is the expression of the states to start in, empty where
    there is no model. ``new_table`` makes a table of estimates. ``report`` prints the policy, once
    ``report_pieces`` and ``$equals``, which values are equally good, are filled in.
    ``truncates`` says whether episodes are cut off. ``imports`` are lines, ``remarks`` sentences for the head
    of the script.
    """

    setup: str
    new_table: str
    report: str
    model: str = ""
    starts: str = ""
    fields: str = FIELDS
    report_pieces: Mapping[str, str] = field(default_factory=dict)
    truncates: bool = False
    imports: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()


def environment(states: str, actions: str, start: str, *, fields: str = FIELDS, time_limit: int = 0) -> str:
    """Return the class that steps through ``outcomes``, and ``env``; the first three are expressions."""
    flags = {"noise"} if fields == NOISY_FIELDS else set()
    pieces = {"states": states, "actions": actions, "start": start, "fields": fields}
    text = sections(f"{__package__}.world", {*flags, "time limit"} if time_limit else flags)["environment"]
    return fill(text, {**pieces, "time_limit": str(time_limit)})


def between(arrows: Iterable[str]) -> str:
    """Return, as a literal, what stands between moves that are equally good: some are two characters."""
    return '""' if all(len(each) == 1 for each in arrows) else '"/"'


def arrow(step: tuple[int, int] | None, name: str) -> str:
    """Return a move as characters that every terminal has; another action by its first letter."""
    if step is None:
        return name[:1]
    down, right = step
    return {-1: "^", 0: "", 1: "v"}[down] + {-1: "<", 0: "", 1: ">"}[right] or "o"
