"""What stands in an edit, as numbers and places."""

from __future__ import annotations

import json
import re
from typing import Any, Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line, shown
from rl_tui.worlds.editing.edit import Edit

_LINES: Final = re.compile(r"([+-][0-9]{1,6})@([0-9]{1,6})")
_PLACE: Final = re.compile(r"([0-9]{1,6})(?::([0-9]{1,6}))?")
_LONGEST_SHOWN: Final = 80
_MOST_DIGITS: Final = 18


def named(edit: Edit) -> str:
    """Return what ``edit`` changes and where, short and safe to print: ``cell[1,2]``."""
    return one_line(f"{edit.name}[{','.join(edit.at)}]", _LONGEST_SHOWN)


def number_in(edit: Edit) -> float:
    """Return the number that ``edit`` puts somewhere. Raises UserError where it is none."""
    value = plain_value(edit)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or value != value:
        raise UserError(f"{edit.name} is {shown(edit.value)}; expected a number")
    return value


def plain_value(edit: Edit) -> Any:
    """Return the value of ``edit``: what JSON reads, else the text as it is."""
    try:
        return json.loads(edit.value, parse_int=_whole_number)
    except (ValueError, RecursionError):
        return edit.value


def _whole_number(digits: str) -> float:
    """Return the number of these ``digits``; no value of a world is larger than what a float can hold."""
    return int(digits) if len(digits) <= _MOST_DIGITS else float(digits)


def rule_value(edit: Edit) -> Any:
    """Return the value of ``edit``, which is of the whole world. Raises UserError where it names a place."""
    _check_of_all(edit)
    return plain_value(edit)


def rule_number(edit: Edit) -> float:
    """Return the number that ``edit`` sets for the whole world. Raises UserError where it is none."""
    _check_of_all(edit)
    return number_in(edit)


def _check_of_all(edit: Edit) -> None:
    if edit.at:
        raise UserError(f"{named(edit)}: {edit.name} is of the whole world: leave the brackets out")


def place_in(edit: Edit, what: str, count: int) -> range:
    """Return the one range of lines that ``edit`` is about, of ``count`` that are called ``what``."""
    if len(edit.at) != 1:
        raise UserError(f"{named(edit)}: expected one {what}")
    return _range(edit, edit.at[0], what, count)


def places_in(edit: Edit, first: tuple[str, int], second: tuple[str, int]) -> tuple[range, range]:
    """Return the two ranges that ``edit`` is about: each is called something, and there are so many."""
    if len(edit.at) != 2:
        raise UserError(f"{named(edit)}: expected a {first[0]} and a {second[0]}")
    return _range(edit, edit.at[0], *first), _range(edit, edit.at[1], *second)


def _range(edit: Edit, text: str, what: str, count: int) -> range:
    match = _PLACE.fullmatch(text)
    if match is None:
        raise UserError(f"{named(edit)}: {shown(text)} is no {what}, such as 3 or 1:4")
    first = int(match[1])
    last = first + 1 if match[2] is None else int(match[2])
    if not 0 <= first < last <= count:
        raise UserError(f"{named(edit)}: there are {what}s 0 to {count - 1}")
    return range(first, last)


def lines_added(edit: Edit, count: int) -> tuple[int, int]:
    """Return how many of ``count`` lines ``edit`` adds, below 0 takes away, and before which it does so.

    It is written ``+1@3``, or ``-2@3`` for the two from 3 on. Raises UserError where there is no such line.
    """
    match = _LINES.fullmatch(edit.value)
    if match is None or edit.at or int(match[1]) == 0:
        raise UserError(f"{edit.name} is {shown(edit.value)}; expected +1@3, so many more before number 3")
    added, at = int(match[1]), int(match[2])
    if at > count or at - min(added, 0) > count:
        raise UserError(f"{edit.name}={edit.value}: there are {edit.name} 0 to {count - 1}")
    return added, at
