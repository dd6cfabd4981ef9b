"""The search for a program's table: variables above `step`, and attributes of objects there."""

from __future__ import annotations

import random
import re
import types
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

import gymnasium
import numpy as np

from rl_tui.programs.watched.child.environments.numbering import Numbering
from rl_tui.programs.watched.child.tables.held_table import HeldTable
from rl_tui.programs.watched.child.tables.recognition import form_of

MISSING: Final = object()
NO_TABLE: Final = re.compile(
    r"^(n|e|p|pi|r|t|probs?|model|rewards?|returns?|transitions?|advantages?)$"
    r"|count|visit|trace|eligib|policy|polic|model|return|probab|freq|weights_sum|reward",
    re.IGNORECASE,
)
_SECOND_CHOICE: Final = re.compile(
    r"old|prev|last|best|copy|target|init|hist|snapshot|saved|opt|star|true|_2$|2$", re.I
)
LIKE_Q: Final = re.compile(r"^q", re.IGNORECASE)
GOOD: Final = re.compile(r"q|value|table", re.IGNORECASE)
_NO_HOLDERS: Final = (
    types.ModuleType,
    type,
    types.FunctionType,
    types.BuiltinFunctionType,
    types.MethodType,
    np.ndarray,
    np.generic,
    np.random.Generator,
    random.Random,
    gymnasium.Env,
    gymnasium.Space,
    str,
    int,
    float,
    list,
    dict,
    tuple,
    set,
)
_OURS: Final = ("gymnasium.", "rl_tui.programs.watched.")
_DEEPEST: Final = 2
_MOST_OBJECTS: Final = 200


@dataclass(frozen=True, slots=True)
class Way:
    """The path to a table: a variable of a running function or a module, and attributes."""

    frame: types.FrameType | None
    """Frame of the function, or None for a module."""
    scope: Mapping[str, Any]
    """Variables of the module, or those of the function at that moment."""
    names: tuple[str, ...]

    def read(self) -> Any:
        """Return the current object, or `MISSING`."""
        scope = self.scope if self.frame is None else self.frame.f_locals
        value = scope.get(self.names[0], MISSING)
        if len(self.names) > 1:
            for name in self.names[1:]:
                value = attributes(value).get(name, MISSING)
        return value

    def name(self) -> str:
        """Return the path as the program would write it."""
        return ".".join(self.names)


@dataclass(frozen=True, slots=True)
class TableCandidate:
    """An object that may be the table."""

    way: Way
    value: Any
    form: HeldTable


def attributes(value: object) -> dict[str, Any]:
    """Return the `__dict__` of an object without calling its class."""
    if value is MISSING or issubclass(type(value), _NO_HOLDERS):
        return {}
    for each in type(value).__mro__:
        found = each.__dict__.get("__dict__")
        if found is not None:
            return found.__get__(value) if type(found) is types.GetSetDescriptorType else {}
    return {}


def candidates(
    frame: types.FrameType | None, numbering: Numbering, wanted: str | None
) -> list[TableCandidate]:
    """Return objects that may be the table of the program at `frame`, the most likely first. For an object
    with several names, the nearest to `frame` is used.

    Args:
        frame: Frame that called `step`.
        numbering: States and actions.
        wanted: Name or path given by the user, the only one to accept.
    """
    found: list[TableCandidate] = []
    known: set[int] = set()
    for way, value in ways(frame):
        if wanted is not None and wanted not in (way.name(), way.names[-1]):
            continue
        if id(value) in known or (wanted is None and NO_TABLE.search(way.names[-1])):
            continue
        form = form_of(value, numbering)
        if form is not None and (wanted is not None or not _is_policy(value, way.names[-1])):
            known.add(id(value))
            found.append(TableCandidate(way, value, form))
    return sorted(found, key=lambda each: rank(each.way.names[-1], each.value))


def turned_table(frame: types.FrameType | None, numbering: Numbering) -> tuple[str, tuple[int, ...]] | None:
    """Return name and shape of an array of actions × states, which is not a table, or None."""
    turned = (numbering.actions, numbering.states)
    for way, value in ways(frame):
        is_turned = type(value) is np.ndarray and value.shape == turned and turned[0] != turned[1]
        if is_turned and not NO_TABLE.search(way.names[-1]):
            return way.name(), turned
    return None


def ways(frame: types.FrameType | None) -> Iterator[tuple[Way, Any]]:
    """Yield the variables of the functions that led to `frame`, the nearest first, and their attributes."""
    seen: set[int] = set()
    while frame is not None:
        if not frame.f_globals.get("__name__", "").startswith(_OURS):
            is_module = frame.f_locals is frame.f_globals
            if not is_module:
                yield from _in_scope(frame, frame.f_locals, seen)
            if id(frame.f_globals) not in seen:
                seen.add(id(frame.f_globals))
                yield from _in_scope(None, frame.f_globals, seen)
        frame = frame.f_back


def _in_scope(
    frame: types.FrameType | None, scope: Mapping[str, Any], seen: set[int]
) -> Iterator[tuple[Way, Any]]:
    level: list[tuple[tuple[str, ...], Any]] = [((name,), value) for name, value in list(scope.items())]
    level = [each for each in level if not each[0][0].startswith("__")]
    for depth in range(_DEEPEST + 1):
        deeper: list[tuple[tuple[str, ...], Any]] = []
        for names, value in level:
            yield Way(frame, scope, names), value
            if depth < _DEEPEST and len(deeper) < _MOST_OBJECTS and id(value) not in seen:
                inside = attributes(value)
                if inside:
                    seen.add(id(value))
                deeper += [((*names, name), each) for name, each in list(inside.items()) if type(name) is str]
        level = deeper


def rank(name: str, value: object) -> tuple[bool, int, bool]:
    """Return a sort key of candidates, smaller for a more likely table."""
    liking = 0 if LIKE_Q.search(name) else 1 if GOOD.search(name) else 2
    is_whole = type(value) is np.ndarray and value.dtype.kind in "iu"
    return (bool(_SECOND_CHOICE.search(name)), liking, is_whole)


def _is_policy(value: object, name: str) -> bool:
    """Return True if each row has probabilities, and the name does not indicate values."""
    if type(value) is not np.ndarray or value.dtype.kind != "f" or LIKE_Q.search(name):
        return False
    return bool((value >= 0).all() and np.allclose(value.sum(axis=-1), 1.0))
