"""What is wrong with a scenario file: where, what was found and what was expected."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from typing import Final, NamedTuple

Location = tuple[str | int, ...]

_LONGEST_SHOWN: Final = 60
_MOST_COMPARED: Final = 200
# Python refuses to write out whole numbers of more than some thousand digits
_MOST_BITS: Final = 10_000


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
            text += ("." if text else "") + (step if _is_bare_key(step) else shown(step))
    return text


def shown(value: object) -> str:
    """Return a value of a file as one short line that is safe to print."""
    if isinstance(value, bool):
        text = "true" if value else "false"
    elif isinstance(value, int) and value.bit_length() > _MOST_BITS:
        text = f"a whole number of {value.bit_length():,} bits"
    elif isinstance(value, str):
        text = json.dumps(value, ensure_ascii=False)
    elif isinstance(value, Mapping):
        text = "a table" if value else "an empty table"
    elif isinstance(value, list):
        text = f"[{', '.join(shown(each) for each in value[:8])}{', …' if len(value) > 8 else ''}]"
    else:
        text = str(value)
    return one_line(text, _LONGEST_SHOWN)


def one_line(text: str, longest: int) -> str:
    """Return a text in one line of at most ``longest`` characters, with nothing in it that moves a cursor."""
    text = " ".join(text.split())
    if len(text) > longest:
        text = text[: longest - 1] + "…"
    return "".join(letter if letter.isprintable() else f"\\u{ord(letter):04x}" for letter in text)


def near(name: str, names: Iterable[str]) -> str:
    """Return `` (did you mean "…"?)`` for the nearest of ``names``, or nothing where none is near.

    Long lists are not searched: comparing names is slow, and a large file may hold thousands of unknown ones.
    """
    by_small_letters = {each.lower(): each for each in names}
    if len(by_small_letters) > _MOST_COMPARED:
        return ""
    matches = get_close_matches(name.lower(), by_small_letters, n=1, cutoff=0.6)
    return f" (did you mean {shown(by_small_letters[matches[0]])}?)" if matches else ""


def order_in_file(location: Location, document: object) -> tuple[int, ...]:
    """Return a sort key that puts locations into the order of the file, missing keys last in their table."""
    key = []
    for step in location:
        if isinstance(document, Mapping):
            keys = list(document)
            key.append(keys.index(step) if step in document else len(keys))
            document = document.get(step)
        elif isinstance(document, Sequence) and isinstance(step, int) and step < len(document):
            key.append(step)
            document = document[step]
        else:
            break
    return tuple(key)


def _is_bare_key(text: str) -> bool:
    return text != "" and all(letter.isalnum() or letter in "_-" for letter in text)
