"""Edits: single changes of a world, written as ``world.cell[1,2]=#``."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from typing import Any, Final, NamedTuple

from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line, shown

# Reading and writing edits


PREFIX: Final = "world."
FORM: Final = "world.NAME[PLACE]=VALUE"
BETWEEN: Final = ";"
_NAME: Final = re.compile(r"world\.([a-z_]+)")
_BARE: Final = re.compile(r"[^\s,;\[\]\"][^,\[\]\"]*")
_VALUE: Final = re.compile(r"[^;]*")
JSON_BEGINS: Final = tuple('{["')
"""A value that starts with one of these is read as JSON."""
# The value of a cell is any single character
_CELL: Final = "cell"


class Edit(NamedTuple):
    """One change of a world, as written. Only the draft checks the content.

    `at` is the place: row and column, two ranges such as ``1:4`` (end excluded), state and action, or the
    number of an arm. It is empty for rules of the whole world.
    """

    name: str
    at: tuple[str, ...] = ()
    value: str = ""


def read_edits(text: str) -> tuple[Edit, ...]:
    """Parse edits separated by semicolons, or raise ValueError."""
    edits, at = [], 0
    while True:
        edit, at = _read_edit(text, at)
        edits.append(edit)
        if at == len(text):
            return tuple(edits)
        if text[at] != BETWEEN:
            raise ValueError(f"unexpected {shown(text[at:])} after {FORM}; separate edits by {BETWEEN}")
        at += 1


def _read_edit(text: str, start: int) -> tuple[Edit, int]:
    name = _NAME.match(text, start)
    if name is None:
        raise ValueError(f"{shown(text[start:])} is not {FORM}, such as world.cell[1,2]=#")
    places, at = _read_places(text, name.end())
    if not text.startswith("=", at):
        raise ValueError(f"{shown(text[start:])} is not {FORM}: = is missing")
    value, at = _read_value(name[1], text, at + 1)
    return Edit(name[1], places, value), at


def _read_places(text: str, at: int) -> tuple[tuple[str, ...], int]:
    if not text.startswith("[", at):
        return (), at
    places = []
    while text[at] != "]":
        at += 1
        if text.startswith('"', at):
            place, at = _read_json(text, at)
            places.append(str(json.loads(place)))
        elif bare := _BARE.match(text, at):
            places.append(bare[0].strip())
            at = bare.end()
        else:
            raise ValueError(f"{shown(text[at:])}: expected a place, such as 1,2 in world.cell[1,2]=#")
        if not text.startswith((",", "]"), at):
            raise ValueError(f"{shown(text[at:])}: expected , or ] after a place")
    return tuple(places), at + 1


def _read_value(name: str, text: str, at: int) -> tuple[str, int]:
    if name == _CELL:
        if at == len(text):
            raise ValueError(f"{shown(text)}: expected a character of the map")
        return text[at], at + 1
    if text.startswith(JSON_BEGINS, at):
        return _read_json(text, at)
    value = _VALUE.match(text, at)
    assert value is not None
    return value[0].strip(), value.end()


def _read_json(text: str, at: int) -> tuple[str, int]:
    try:
        value, end = json.JSONDecoder().raw_decode(text, at)
        return as_json(value), end
    except (ValueError, RecursionError) as fault:
        raise ValueError(f'{shown(text[at:])}: expected JSON, such as {{"Pass": 0.8}}') from fault


def json_in(text: str) -> str:
    """Format JSON text as :func:`as_json` does, or raise ValueError."""
    value, end = _read_json(text, 0)
    if text[end:].strip():
        raise ValueError(f"unexpected {shown(text[end:])} after the JSON")
    return value


def as_json(value: object) -> str:
    """Return compact JSON. Equal values give equal texts."""
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))


def written_edits(edits: Iterable[Edit]) -> str:
    """Return text that :func:`read_edits` can parse."""
    return BETWEEN.join(map(_written, edits))


def _written(edit: Edit) -> str:
    bare = (each == each.strip() and _BARE.fullmatch(each) for each in edit.at)
    places = ",".join(each if is_bare else as_json(each) for each, is_bare in zip(edit.at, bare, strict=True))
    return f"{PREFIX}{edit.name}{f'[{places}]' if edit.at else ''}={edit.value}"


# Numbers and places in an edit


_LINES: Final = re.compile(r"([+-][0-9]{1,6})@([0-9]{1,6})")
_PLACE: Final = re.compile(r"([0-9]{1,6})(?::([0-9]{1,6}))?")
_LONGEST_SHOWN: Final = 80
_MOST_DIGITS: Final = 18


def named(edit: Edit) -> str:
    """Return name and place, short and printable, such as ``cell[1,2]``."""
    return one_line(f"{edit.name}[{','.join(edit.at)}]", _LONGEST_SHOWN)


def number_in(edit: Edit) -> float:
    """Return the value as a number, or raise UserError."""
    value = plain_value(edit)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or value != value:
        raise UserError(f"{edit.name} is {shown(edit.value)}; expected a number")
    return value


def plain_value(edit: Edit) -> Any:
    """Return the value of `edit`, parsed as JSON if possible."""
    try:
        return json.loads(edit.value, parse_int=_whole_number)
    except (ValueError, RecursionError):
        return edit.value


def _whole_number(digits: str) -> float:
    return int(digits) if len(digits) <= _MOST_DIGITS else float(digits)


def rule_value(edit: Edit) -> Any:
    """Return the value of an edit without a place, or raise UserError."""
    _check_of_all(edit)
    return plain_value(edit)


def rule_number(edit: Edit) -> float:
    """Return the number of an edit without a place, or raise UserError."""
    _check_of_all(edit)
    return number_in(edit)


def _check_of_all(edit: Edit) -> None:
    if edit.at:
        raise UserError(f"{named(edit)}: {edit.name} applies to the whole world; leave out the brackets")


def place_in(edit: Edit, what: str, count: int) -> range:
    """Return the range of `count` existing lines that `edit` names, or raise UserError.

    `what` is a line's name for messages.
    """
    if len(edit.at) != 1:
        raise UserError(f"{named(edit)}: expected one {what}")
    return _range(edit, edit.at[0], what, count)


def places_in(edit: Edit, first: tuple[str, int], second: tuple[str, int]) -> tuple[range, range]:
    """Return the two ranges that `edit` names, or raise UserError.

    Each kind of line has a name and a number of existing ones.
    """
    if len(edit.at) != 2:
        raise UserError(f"{named(edit)}: expected a {first[0]} and a {second[0]}")
    return _range(edit, edit.at[0], *first), _range(edit, edit.at[1], *second)


def _range(edit: Edit, text: str, what: str, count: int) -> range:
    match = _PLACE.fullmatch(text)
    if match is None:
        raise UserError(f"{named(edit)}: {shown(text)} is not a {what}, such as 3 or 1:4")
    first = int(match[1])
    last = first + 1 if match[2] is None else int(match[2])
    if not 0 <= first < last <= count:
        raise UserError(f"{named(edit)}: the {what}s are numbered from 0 to {count - 1}")
    return range(first, last)


def lines_added(edit: Edit, count: int) -> tuple[int, int]:
    """Parse the insertion of lines, ``+1@3``, or their removal, ``-2@3`` (two lines from 3 on).

    Returns:
        Number of lines to add (negative: to remove), and the first line.

    Raises:
        UserError: The form is wrong, or the lines do not exist.
    """
    match = _LINES.fullmatch(edit.value)
    if match is None or edit.at or int(match[1]) == 0:
        raise UserError(
            f"{edit.name} is {shown(edit.value)}; expected a change such as +1@3 (add one before number 3)"
        )
    added, at = int(match[1]), int(match[2])
    if at > count or at - min(added, 0) > count:
        raise UserError(f"{edit.name}={edit.value}: the {edit.name} are numbered from 0 to {count - 1}")
    return added, at
