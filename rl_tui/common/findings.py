"""Findings in scenario files, and values for messages."""

from __future__ import annotations

import json
import re
import shlex
import sys
from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from itertools import islice
from typing import Final, NamedTuple

Location = tuple[str | int, ...]

_LONGEST_SHOWN: Final = 60
_MANY: Final = 200
_LONGEST_COMPARED: Final = 200
_MOST_COMPARED: Final = 200
# Python refuses to print whole numbers with thousands of digits
_MOST_BITS: Final = 10_000
_CONTROL: Final = re.compile(
    "[\\x00-\\x1f\\x7f-\\x9f\\ud800-\\udfff\\u2028\\u2029"  # Unicode categories Cc, Cs, Zl and Zp
    "\\u061c\\u200e\\u200f\\u202a-\\u202e\\u2066-\\u2069]"  # these change the writing direction
)


_PLAIN_WORD: Final = re.compile(r"[\w.:/\\=+-]+")


def command_line(words: Iterable[str]) -> str:
    """Return a line to type into a shell: cmd.exe and PowerShell on Windows."""
    if sys.platform != "win32":
        return shlex.join(words)
    return " ".join(word if _PLAIN_WORD.fullmatch(word) else f'"{word}"' for word in words)


class Finding(NamedTuple):
    """One error in a file, at the keys and indices (from 0) of `location`.

    Without `expected`, `found` says how to fix it.
    """

    location: Location
    found: str
    expected: str = ""

    def inside(self, *outer: str | int) -> Finding:
        """Return the finding with `outer` before its location."""
        return self._replace(location=(*outer, *self.location))


def place(location: Location) -> str:
    """Return a location as text, such as ``mdp.transition[2].to``."""
    text = ""
    for step in location:
        if isinstance(step, int):
            text += f"[{step}]"
        else:
            key = one_line(step, _LONGEST_SHOWN) if _is_bare_key(step) else shown(step)
            text += ("." if text else "") + key
    return text


def shown(value: object, deepest: int = 3) -> str:
    """Return a value as one short line that is safe to print.

    Lists are written out down to the level `deepest`.
    """
    if isinstance(value, bool):
        text = "true" if value else "false"
    elif isinstance(value, int) and value.bit_length() > _MOST_BITS:
        text = f"a whole number of {value.bit_length():,} bits"
    elif isinstance(value, str):
        # slightly longer than the limit, so that the ellipsis remains
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
    """Return one printable line of at most `longest` characters."""
    text = " ".join(text.split())
    if len(text) > longest:
        text = text[: longest - 1] + "…"
    return printable(text)


def printable(text: str) -> str:
    """Escape unprintable characters, so that no terminal obeys them."""
    return "".join(letter if letter.isprintable() else f"\\u{ord(letter):04x}" for letter in text)


def is_plain(text: str, also: str = "") -> bool:
    """Return True if `text` has no control characters except those in `also`."""
    return not control_character(text, also)


def control_character(text: str, also: str = "") -> str:
    """Return the first control character not in `also`, as ``U+001B``, or an empty text.

    Characters that change the writing direction or end a line count, and so do surrogates.
    """
    found = (each[0] for each in _CONTROL.finditer(text) if each[0] not in also)
    return next((f"U+{ord(each):04X}" for each in found), "")


def near(name: str, names: Iterable[str]) -> str:
    """Return `` (did you mean "…"?)`` with the nearest name, or an empty text.

    Very long lists and names are not searched, because comparing is slow.
    """
    by_small_letters = {each.lower(): each for each in islice(names, _MOST_COMPARED + 1)}
    if len(by_small_letters) > _MOST_COMPARED or len(name) > _LONGEST_COMPARED:
        return ""
    matches = get_close_matches(name.lower(), by_small_letters, n=1, cutoff=0.65)
    return f" (did you mean {shown(by_small_letters[matches[0]])}?)" if matches else ""


def in_file_order(findings: Iterable[Finding], document: object) -> list[Finding]:
    """Return `findings` in file order. Missing keys come last in their table."""
    places: dict[int, dict[str, int]] = {}  # key order of each table visited
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
