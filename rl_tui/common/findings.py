"""What is wrong with a scenario file: where, what was found and what was expected."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from itertools import islice
from typing import Final, NamedTuple

Location = tuple[str | int, ...]

_LONGEST_SHOWN: Final = 60
_MANY: Final = 200
_LONGEST_COMPARED: Final = 200
_MOST_COMPARED: Final = 200
# Python refuses to write out whole numbers of more than some thousand digits
_MOST_BITS: Final = 10_000
_CONTROL: Final = re.compile(
    "[\\x00-\\x1f\\x7f-\\x9f\\ud800-\\udfff\\u2028\\u2029"  # categories Cc, Cs, Zl and Zp of Unicode
    "\\u061c\\u200e\\u200f\\u202a-\\u202e\\u2066-\\u2069]"  # these turn the direction of writing
)


class Finding(NamedTuple):
    """One fault at ``location``: the keys and indices (from 0) that lead to it in the file."""

    location: Location
    found: str
    expected: str

    def inside(self, *outer: str | int) -> Finding:
        """Return the same finding, seen from the table that holds it under ``outer``."""
        return self._replace(location=(*outer, *self.location))


def place(location: Location) -> str:
    """Return the location as people write it: ``mdp.transition[2].to``."""
    text = ""
    for step in location:
        if isinstance(step, int):
            text += f"[{step}]"
        else:
            key = one_line(step, _LONGEST_SHOWN) if _is_bare_key(step) else shown(step)
            text += ("." if text else "") + key
    return text


def shown(value: object, deepest: int = 3) -> str:
    """Return a value of a file as one short line that is safe to print.

    Of lists within lists so many levels are written out.
    """
    if isinstance(value, bool):
        text = "true" if value else "false"
    elif isinstance(value, int) and value.bit_length() > _MOST_BITS:
        text = f"a whole number of {value.bit_length():,} bits"
    elif isinstance(value, str):
        # a little more than what will stand there, so that it still ends in an ellipsis
        text = json.dumps(value[: 2 * _LONGEST_SHOWN], ensure_ascii=False)
    elif isinstance(value, Mapping):
        text = "a table" if value else "an empty table"
        if len(value) > _MANY:
            text += f" of {len(value):,} keys"
    elif isinstance(value, list) and (len(value) > _MANY or not deepest):
        text = f"a list of {len(value):,}"
    elif isinstance(value, list):
        inner = ", ".join(shown(each, deepest - 1) for each in value[:8])
        text = f"[{inner}{', …' if len(value) > 8 else ''}]"
    else:
        text = str(value)
    return one_line(text, _LONGEST_SHOWN)


def one_line(text: str, longest: int) -> str:
    """Return a text in one line of at most ``longest`` characters, with nothing in it that moves a cursor."""
    text = " ".join(text.split())
    if len(text) > longest:
        text = text[: longest - 1] + "…"
    return printable(text)


def printable(text: str) -> str:
    """Return a text in which characters that a terminal might obey are written out as numbers."""
    return "".join(letter if letter.isprintable() else f"\\u{ord(letter):04x}" for letter in text)


def is_plain(text: str, also: str = "") -> bool:
    """Return whether a text has no control character but those in ``also``: none may reach a terminal."""
    return not control_character(text, also)


def control_character(text: str, also: str = "") -> str:
    """Return the first control character of a text besides those in ``also``, as U+001B; empty if none.

    What turns the direction of writing or ends a line counts as one, and so does half a character.
    """
    found = (each[0] for each in _CONTROL.finditer(text) if each[0] not in also)
    return next((f"U+{ord(each):04X}" for each in found), "")


def near(name: str, names: Iterable[str]) -> str:
    """Return `` (did you mean "…"?)`` for the nearest of ``names``, or nothing where none is near.

    Long lists are not searched: comparing names is slow, and a large file may hold thousands of unknown ones.
    """
    by_small_letters = {each.lower(): each for each in islice(names, _MOST_COMPARED + 1)}
    if len(by_small_letters) > _MOST_COMPARED or len(name) > _LONGEST_COMPARED:
        return ""
    matches = get_close_matches(name.lower(), by_small_letters, n=1, cutoff=0.6)
    return f" (did you mean {shown(by_small_letters[matches[0]])}?)" if matches else ""


def in_file_order(findings: Iterable[Finding], document: object) -> list[Finding]:
    """Return ``findings`` in the order of the file, those of missing keys last in their table."""
    places: dict[int, dict[str, int]] = {}  # of the keys of each table that was looked at
    return sorted(findings, key=lambda finding: _place_in_file(finding.location, document, places))


def _place_in_file(
    location: Location, document: object, places: dict[int, dict[str, int]]
) -> tuple[int, ...]:
    key = []
    for step in location:
        if isinstance(document, Mapping):
            if id(document) not in places:
                places[id(document)] = {name: place for place, name in enumerate(document)}
            key.append(places[id(document)].get(str(step), len(document)))
            document = document.get(step)
        elif isinstance(document, Sequence) and isinstance(step, int) and step < len(document):
            key.append(step)
            document = document[step]
        else:
            break
    return tuple(key)


def _is_bare_key(text: str) -> bool:
    return text != "" and all(letter.isalnum() or letter in "_-" for letter in text)
