"""Templates of exported scripts and of their worlds.

`# [tables]` begins a section. A line ending in `#: ties first, not time limit` needs the first flag, but not
the second. `$name` is replaced by a piece, and a line `# $name` by several lines.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from importlib.resources import files
from typing import Final

# Sections and places


ENDING: Final = ".py.txt"
_HEAD: Final = re.compile(r"# \[(.+)\]")
_PLACE: Final = re.compile(r"\$(\w+)")
_LINE_OF_PLACE: Final = re.compile(r"( *)(?:# )?\$(\w+)")


def sections(module: str, flags: Collection[str] = ()) -> dict[str, str]:
    """Return the sections of the template next to `module`, with the lines selected by `flags`.

    Raises FileNotFoundError, ModuleNotFoundError, or ValueError.
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
    """Replace each `$name` in `text`. Raises KeyError for a missing piece.

    A line with only a place takes several lines with its indentation, or disappears.
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
    """A world as text for a script.

    `setup` makes `env`, and `report` prints the policy, with places for `report_pieces` and `$equals`.
    `model` defines `outcomes(state, action)` if `setup` does not. `starts` is empty without a model.
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
    """Return the class that steps through `outcomes` and makes `env`. `time_limit` 0 means none."""
    flags = {"noise"} if fields == NOISY_FIELDS else set()
    pieces = {"states": states, "actions": actions, "start": start, "fields": fields}
    text = sections(f"{__package__}.world", {*flags, "time limit"} if time_limit else flags)["environment"]
    return fill(text, {**pieces, "time_limit": str(time_limit)})


def between(arrows: Iterable[str]) -> str:
    """Return the literal that separates equally good moves, empty if all have one character."""
    return '""' if all(len(each) == 1 for each in arrows) else '"/"'


def arrow(step: tuple[int, int] | None, name: str) -> str:
    """Return a move in ASCII, another action by its first letter."""
    if step is None:
        return name[:1]
    down, right = step
    return {-1: "^", 0: "", 1: "v"}[down] + {-1: "<", 0: "", 1: ">"}[right] or "o"
