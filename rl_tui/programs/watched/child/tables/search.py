"""The search for a table, in variables above `step` and their attributes."""

from __future__ import annotations

import random
import re
import sys
import types
from collections.abc import Iterator, Mapping
from copy import copy
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any, Final

import gymnasium
import numpy as np

from rl_tui.programs.watched.child.environments.numbering import Numbering
from rl_tui.programs.watched.child.errors import is_users_file, with_callers
from rl_tui.programs.watched.child.tables.forms import HeldTable
from rl_tui.programs.watched.child.tables.keyed_table import form_of

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
    *(types.ModuleType, type, types.FunctionType, types.BuiltinFunctionType, types.MethodType, np.ndarray),
    *(np.generic, np.random.Generator, random.Random, gymnasium.Env, gymnasium.Space),
    *(str, int, float, list, dict, tuple, set),
)
_CONTAINERS: Final = (np.ndarray, list, dict)
_OURS: Final = ("gymnasium.", "rl_tui.programs.watched.")
_DEEPEST: Final = 2
_MOST_OBJECTS: Final = 200
_TWO: Final = 2
_TWINS: Final = (("1", "2"), ("0", "1"), ("A", "B"), ("a", "b"), ("one", "two"), ("first", "second"))
"""Parts of names in which two tables of an update may differ."""


@dataclass(frozen=True, slots=True)
class Way:
    """The path to a table: a variable and attributes."""

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
                value = attribute(value, name)
        return value

    def name(self) -> str:
        """Return the path as the program would write it."""
        return ".".join(self.names)


@dataclass(frozen=True)
class EntryWay(Way):
    """The path to one of two tables in a list, tuple, dict or array."""

    place: int
    _view: list[Any] = field(default_factory=lambda: [MISSING, MISSING])

    def read(self) -> Any:
        """Return the current object, the same one each time."""
        holder = super().read()
        keys = _keys_of_two(holder)
        if type(holder) is not np.ndarray or not keys:
            return _entry(holder, keys[self.place]) if keys else MISSING
        if self._view[0] is not holder:
            self._view[:] = holder, holder[self.place]
        return self._view[1]

    def name(self) -> str:
        """Return the path with its entry."""
        keys = _keys_of_two(super().read())
        return f"{super().name()}[{keys[self.place]!r}]" if keys else super().name()


@dataclass(frozen=True, slots=True)
class TableCandidate:
    """An object that may be the table."""

    way: Way
    value: Any
    form: HeldTable


def attributes(value: object) -> dict[str, Any]:
    """Return the `__dict__` without calling the class."""
    if value is MISSING or issubclass(type(value), _NO_HOLDERS):
        return {}
    for each in type(value).__mro__:
        found = each.__dict__.get("__dict__")
        if found is not None:
            return found.__get__(value) if type(found) is types.GetSetDescriptorType else {}
    return {}


def attribute(value: object, name: str) -> Any:
    """Return an attribute without calling the program's code, or `MISSING`."""
    found = attributes(value).get(name, MISSING)
    return _tables_of_class(value).get(name, MISSING) if found is MISSING else found


def _tables_of_class(value: object) -> dict[str, Any]:
    """Return the arrays, lists and dicts that are attributes of the program's class of `value`."""
    if issubclass(type(value), _NO_HOLDERS):
        return {}
    return {
        name: each
        for kind in reversed(type(value).__mro__)
        if _is_users_class(kind)
        for name, each in vars(kind).items()
        if issubclass(type(each), _CONTAINERS) and not name.startswith("__")
    }


@lru_cache(maxsize=256)
def _is_users_class(kind: type) -> bool:
    file = getattr(sys.modules.get(kind.__module__), "__file__", None)
    return file is not None and is_users_file(file)


def candidates(
    frame: types.FrameType | None, numbering: Numbering, wanted: str | None
) -> list[TableCandidate]:
    """Return objects that may be the table of the program at `frame`, the most likely first.

    Of several names the nearest to `frame` is used. Without any table, two entries of an object may be
    tables. `wanted`, if given by the user, is the only path to accept.
    """
    found: list[TableCandidate] = []
    entries: list[TableCandidate] = []
    known: set[int] = set()
    for way, value in ways(frame):
        is_wanted = wanted is None or wanted in (way.name(), way.names[-1])
        if not is_wanted and not str(wanted).startswith(f"{way.name()}["):
            continue
        if id(value) in known or (wanted is None and NO_TABLE.search(way.names[-1])):
            continue
        form = form_of(value, numbering) if is_wanted else None
        if form is None:
            tables = _tables_in(way, value, numbering)
            entries += [each for each in tables if is_wanted or each.way.name() == wanted]
        elif wanted is not None or not _is_policy(value, way.names[-1]):
            known.add(id(value))
            found.append(TableCandidate(way, value, form))
    return sorted(found or entries, key=lambda each: rank(each.way.names[-1], each.value))


def _tables_in(way: Way, value: Any, numbering: Numbering) -> list[TableCandidate]:
    found = []
    for place in range(len(_keys_of_two(value))):
        entry = EntryWay(way.frame, way.scope, way.names, place)
        form = form_of(entry.read(), numbering)
        if form is not None:
            found.append(TableCandidate(entry, entry.read(), form))
    return found if len(found) == _TWO else []


def _keys_of_two(holder: Any) -> list[Any]:
    kind = type(holder)
    if kind in (list, tuple) or (kind is np.ndarray and holder.ndim > 1):
        return list(range(_TWO)) if len(holder) == _TWO else []
    keys = list(dict.keys(holder)) if issubclass(kind, dict) and dict.__len__(holder) == _TWO else []
    return [] if any(isinstance(key, str) and NO_TABLE.search(key) for key in keys) else keys


def _entry(holder: Any, key: Any) -> Any:
    return dict.get(holder, key) if issubclass(type(holder), dict) else holder[key]


def twin_of(table: TableCandidate) -> TableCandidate | None:
    """Return a table whose name differs only in a part such as 1 and 2, or a dict that may become one."""
    numbering = table.form.numbering
    for way in _ways_of_twins(table.way):
        value = way.read()
        if type(value) is type(table.value) and value is not table.value:
            form = form_of(value, numbering)
            if form is None and issubclass(type(value), dict) and not dict.__len__(value):
                form = copy(table.form)
            if form is not None and form.name == table.form.name:
                return TableCandidate(way, value, form)
    return None


def _ways_of_twins(way: Way) -> Iterator[Way]:
    if isinstance(way, EntryWay):
        yield EntryWay(way.frame, way.scope, way.names, 1 - way.place)
        return
    *path, name = way.names
    others = [f"{name}2", f"{name}_2"]
    for one, two in _TWINS:
        for part, other in ((one, two), (two, one)):
            begins = [each.start() for each in re.finditer(part, name)]
            others += [name[:begin] + other + name[begin + len(part) :] for begin in begins]
    yield from (replace(way, names=(*path, each)) for each in others)


def turned_table(frame: types.FrameType | None, numbering: Numbering) -> tuple[str, tuple[int, ...]] | None:
    """Return name and shape of an array of actions × states, which is no table."""
    turned = (numbering.actions, numbering.states)
    for way, value in ways(frame):
        is_turned = type(value) is np.ndarray and value.shape == turned and turned[0] != turned[1]
        if is_turned and not NO_TABLE.search(way.names[-1]):
            return way.name(), turned
    return None


def ways(frame: types.FrameType | None) -> Iterator[tuple[Way, Any]]:
    """Yield variables above `frame`, the nearest first, and their attributes."""
    seen: set[int] = set()
    for each in with_callers(frame):
        if not each.f_globals.get("__name__", "").startswith(_OURS):
            if each.f_locals is not each.f_globals:
                yield from _in_scope(each, each.f_locals, seen)
            if id(each.f_globals) not in seen:
                seen.add(id(each.f_globals))
                yield from _in_scope(None, each.f_globals, seen)


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
                inside = {**_tables_of_class(value), **attributes(value)}
                if inside:
                    seen.add(id(value))
                deeper += [((*names, name), each) for name, each in list(inside.items()) if type(name) is str]
        level = deeper


def rank(name: str, value: object) -> tuple[bool, int, bool]:
    """Return a sort key, smaller for a more likely table."""
    liking = 0 if LIKE_Q.search(name) else 1 if GOOD.search(name) else 2
    is_whole = type(value) is np.ndarray and value.dtype.kind in "iu"
    return (bool(_SECOND_CHOICE.search(name)), liking, is_whole)


def _is_policy(value: object, name: str) -> bool:
    if type(value) is not np.ndarray or value.dtype.kind != "f" or LIKE_Q.search(name):
        return False
    return bool((value >= 0).all() and np.allclose(value.sum(axis=-1), 1.0))
