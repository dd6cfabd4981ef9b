"""Assignments to a subscript, with a call before and after each. The calls read its index, and call nothing
of the program's.
"""

from __future__ import annotations

import ast
import builtins
import copy
import math
import operator
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from enum import Enum
from functools import cached_property
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from pathlib import Path
from types import CodeType, FrameType, ModuleType
from typing import Any, Final, NamedTuple

import numpy as np

from rl_tui.programs.watched.child.errors import is_users_file
from rl_tui.programs.watched.child.script import Script
from rl_tui.programs.watched.child.tables.forms import number_of
from rl_tui.programs.watched.child.tables.search import MISSING, NO_TABLE, attribute
from rl_tui.programs.watched.child.worlds.met import Key, key_of

# Reading an index


_CONVERSIONS: Final[Mapping[str, Callable[[Any], Any]]] = {"int": int, "str": str, "tuple": tuple}
_OPERATORS: Final[Mapping[type, Callable[[Any, Any], Any]]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
}
_PLAIN: Final = (int, float, str, bool, tuple, list, np.ndarray)
_PANDAS: Final = ("loc", "at")
_MOST_READS: Final = 16


def _is_readable(node: ast.AST) -> bool:
    match node:
        case ast.Name() | ast.Constant():
            return True
        case ast.Attribute(value=inner) | ast.Starred(value=inner):
            return _is_readable(inner)
        case ast.Tuple(elts=parts):
            return all(map(_is_readable, parts))
        case ast.Subscript(value=left, slice=right):
            return _is_readable(left) and _is_readable(right)
        case ast.BinOp(left=left, op=sign, right=right):
            return type(sign) in _OPERATORS and _is_readable(left) and _is_readable(right)
        case ast.Call(func=ast.Name(id=name), args=[inner], keywords=[]):
            return name in _CONVERSIONS and _is_readable(inner)
    return False


def _value_of(node: ast.expr, frame: FrameType) -> Any:
    """Read a value without a call. Raises LookupError, TypeError or ValueError if it needs one."""
    match node:
        case ast.Constant(value=value):
            return value
        case ast.Name(id=name):
            return frame.f_locals[name] if name in frame.f_locals else frame.f_globals[name]
        case ast.Attribute(value=inner, attr=name):
            holder = _value_of(inner, frame)
            if type(holder) is ModuleType:
                return vars(holder)[name]
            is_value = name == "value" and issubclass(type(holder), Enum)
            found = attribute(holder, "_value_" if is_value else name)
            if found is MISSING:
                raise LookupError(name)
            return found
        case ast.Tuple(elts=parts):
            return tuple(each for part in parts for each in _elements(part, frame))
        case ast.Subscript(value=inner, slice=index):
            return _plain(_value_of(inner, frame))[_plain(_value_of(index, frame))]
        case ast.BinOp(left=left, op=sign, right=right):
            sides = _plain(_value_of(left, frame)), _plain(_value_of(right, frame))
            return _OPERATORS[type(sign)](*sides)
        case ast.Call(func=ast.Name(id=name), args=[inner]) if name not in frame.f_globals:
            return _CONVERSIONS[name](_plain(_value_of(inner, frame)))
    raise ValueError("an expression that rl-tui cannot read")


def _known_value(node: ast.expr | None, frame: FrameType) -> Any:
    try:
        return None if node is None else _value_of(node, frame)
    except (LookupError, TypeError, ValueError, ArithmeticError):
        return None


def _elements(node: ast.expr, frame: FrameType) -> tuple[Any, ...]:
    if isinstance(node, ast.Starred):
        return tuple(_plain(_value_of(node.value, frame)))
    return (_value_of(node, frame),)


def _plain(value: Any) -> Any:
    """Return `value` if its type is not the program's, else raise TypeError."""
    if type(value) in _PLAIN or issubclass(type(value), np.generic):
        key_of(value)  # its parts are plain too
        return value
    raise TypeError(f"an index cannot be a {type(value).__name__}")


class Index:
    """An index such as `[s][a]` of the variable or attribute `base`, perhaps `row[a]`."""

    def __init__(self, base: ast.expr, parts: Sequence[ast.expr], row: str | None = None) -> None:
        self.name = ast.unparse(base)
        self.parts, self._base, self._row = parts, base, row

    def table(self, frame: FrameType) -> Any:
        """Return the indexed object, or None."""
        return _known_value(self._base, frame)

    def keys(self, frame: FrameType) -> tuple[Any, ...] | None:
        """Return all parts of the index, if they can be read."""
        try:
            keys = tuple(_flat(key_of(_value_of(each, frame)) for each in self.parts))
            return keys if self._row is None or self._is_row(frame, keys[:-1]) else None
        except (LookupError, TypeError, ValueError, ArithmeticError):
            return None

    def _is_row(self, frame: FrameType, keys: Sequence[Any]) -> bool:
        named, row = frame.f_locals[str(self._row)], _value_of(self._base, frame)
        if issubclass(type(row), dict):
            row = dict.get(row, keys[0] if len(keys) == 1 else keys)
        elif type(row) in (list, np.ndarray):
            for key in keys:
                row = row[key]
        is_view = type(named) is np.ndarray and type(row) is np.ndarray
        return named is row or (is_view and named.ctypes.data == row.ctypes.data)


def _flat(keys: Iterator[Key]) -> Iterator[Any]:
    for each in keys:
        yield from each if type(each) is tuple else (each,)


Assigned = Mapping[str, Sequence[ast.expr | None]]
"""Values that a function assigns to each of its variables, None for one that is not written there."""


def _index_of(node: ast.expr, assigned: Assigned) -> Index | None:
    """Return the index of `T[a][b, c]` if all of it can be read. `T[a]` may be a variable, assigned once."""
    parts: list[ast.expr] = []
    row = None
    while isinstance(node, ast.Subscript):
        parts = [*(node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]), *parts]
        node = node.value
        values = assigned.get(node.id, ()) if isinstance(node, ast.Name) and row is None else ()
        if len(values) == 1 and isinstance(values[0], ast.Subscript):
            row, node = getattr(node, "id", None), values[0]
    if isinstance(node, ast.Attribute) and node.attr in _PANDAS:
        node = node.value
    if parts and isinstance(parts[-1], ast.Slice) and ast.unparse(parts[-1]) == ":":  # the whole row
        parts.pop()
    is_base = isinstance(node, ast.Name | ast.Attribute) and _is_readable(node)
    if not (parts and is_base and all(map(_is_readable, parts))):
        return None
    return Index(copy.deepcopy(node), copy.deepcopy(parts), row)


def _reads_in(scope: ast.AST) -> Iterator[Index]:
    """Yield each index that a function reads. `T[s]` in `T[s][a]` is not one."""
    inside: set[int] = set()
    for node in ast.walk(scope):  # outer nodes come first
        if isinstance(node, ast.Subscript) and id(node) not in inside:
            index = _index_of(node, {}) if isinstance(node.ctx, ast.Load) else None
            if index is not None:
                yield index
            inner: ast.expr = node
            while (index or isinstance(node.ctx, ast.Store)) and isinstance(inner, ast.Subscript):
                inner = inner.value
                inside.add(id(inner))


_REWARD: Final = re.compile(r"^_*(r|rw|rew)_?(t|\d|t_?plus_?1)?$|reward|payoff", re.IGNORECASE)
_NO_REWARD: Final = re.compile(r"total|sum|cum|mean|av|episode|list|hist|max|min|return", re.IGNORECASE)


_OF_TABLE: Final = re.compile(r"(?i:^predict$|(^|_)q(_|\d|$)|value|best)|^[qQ][A-Z]|[a-z]Q(?![a-z])")
_NO_REWARD_CALL: Final = re.compile(rf"^(get|int|float|dot|abs|round)$|{_NO_REWARD.pattern}", re.IGNORECASE)
_CALLED: Final = "_rl_tui_reward_"
"""Begin of the variable for a reward that a call returns inside of an assignment."""
ACTION_NAME: Final = re.compile(r"^_*a_?\d?$|ac[tcçã]|move|dir|choice|arm", re.IGNORECASE)


def _reward_in(node: ast.AST, assigned: Assigned, known: set[str]) -> ast.expr | None:
    base = node
    while isinstance(base, ast.Subscript):
        base = base.value
    name = base.id if isinstance(base, ast.Name) else base.attr if isinstance(base, ast.Attribute) else ""
    if _REWARD.search(name) and not _NO_REWARD.search(name):
        return copy.deepcopy(node) if isinstance(node, ast.expr) and _is_readable(node) else None
    inner: list[ast.AST | None] = list(ast.iter_child_nodes(node))
    if isinstance(node, ast.Call):
        inner.remove(node.func)
    if isinstance(node, ast.Name) and name not in known:
        known.add(name)
        inner = list(assigned.get(name, ()))
    found = (_reward_in(each, assigned, known) for each in inner if each is not None)
    return next((each for each in found if each is not None), None)


def _reward_beside(assigned: Assigned) -> ast.expr | None:
    names = [each for each in assigned if _REWARD.search(each) and not _NO_REWARD.search(each)]
    return ast.Name(names[0], ast.Load()) if len(names) == 1 else None


class _Term(NamedTuple):
    node: ast.expr
    holder: ast.BinOp | None
    side: str
    is_added: bool


def _terms(term: _Term) -> Iterator[_Term]:
    node = term.node
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        is_same = isinstance(node.op, ast.Add)
        yield from _terms(_Term(node.left, node, "left", term.is_added))
        yield from _terms(_Term(node.right, node, "right", term.is_added == is_same))
    else:
        yield term


def _reward_of_call(value: ast.expr, assigned: Assigned, index: Index) -> ast.expr | None:
    """Give a name to the only call that is added to numbers of the table, one of them of another cell.

    A call without such a number may return the whole target.
    """
    values, known, found = [value], set[str](), list[_Term]()
    while values:
        terms = list(_terms(_Term(values.pop(), None, "", is_added=True)))
        for node in (each.node for each in terms):
            values += [node.left, node.right] if isinstance(node, ast.BinOp) else []
            values += _written(node, assigned, known)
        others = [each for each in terms if not _reads(each.node, index, assigned, or_own=True)]
        is_beside = any(each.is_added and _reads(each.node, index, assigned, or_own=False) for each in terms)
        if len(others) == 1 and is_beside and _may_be_reward(others[0], value):
            found += others
    if len(found) != 1:
        return None
    ((call, holder, side, _),) = found
    if isinstance(call, ast.Call):
        name = ast.Name(f"{_CALLED}{call.lineno}_{call.col_offset}", ast.Store())
        call = ast.copy_location(ast.NamedExpr(ast.copy_location(name, call), call), call)
        setattr(holder, side, call)
    assert isinstance(call, ast.NamedExpr)
    return ast.Name(call.target.id, ast.Load())


def _may_be_reward(term: _Term, value: ast.expr) -> bool:
    node = term.node
    if not (isinstance(node, ast.Call) and term.is_added and term.holder is not None):
        return isinstance(node, ast.NamedExpr) and node.target.id.startswith(_CALLED)
    calls = [ast.unparse(each) for each in ast.walk(value) if isinstance(each, ast.Call)]
    return not _NO_REWARD_CALL.search(_last_name(node.func)) and calls.count(ast.unparse(node)) <= 1


def _written(node: ast.AST, assigned: Assigned, known: set[str]) -> list[ast.expr]:
    """Return the only value of a variable, the first time."""
    if not isinstance(node, ast.Name) or node.id in known:
        return []
    known.add(node.id)
    written = assigned.get(node.id, ())
    return [each for each in written if each is not None and len(written) == 1]


def _reads(node: ast.AST, index: Index, assigned: Assigned, *, or_own: bool, is_given: bool = False) -> bool:
    """Return True if an expression has a number of the table that is not at `index`, or any with `or_own`.

    Of variables that are given to a call only those with an entry are looked up, because others may be
    actions that depend on the table.
    """
    parts: Sequence[ast.expr] | None = None
    if isinstance(node, ast.Subscript):
        read = _index_of(node, assigned)
        parts = read.parts if read is not None and read.name == index.name else None
    elif isinstance(node, ast.Call) and _OF_TABLE.search(_last_name(node.func)):
        parts = node.args
    elif isinstance(node, ast.Name | ast.Attribute) and ast.unparse(node) == index.name:
        parts = []
    if parts is not None:
        return or_own or list(map(ast.unparse, parts)) != list(map(ast.unparse, index.parts))
    if isinstance(node, ast.Name):
        inner: list[ast.AST] = [*_written(node, assigned, set())]
        inner = [each for each in inner if isinstance(each, ast.Subscript) or not is_given]
        assigned = {name: each for name, each in assigned.items() if name != node.id}
    else:
        inner = [node.value] if isinstance(node, ast.Subscript) else [*ast.iter_child_nodes(node)]
    is_given = is_given or isinstance(node, ast.Call)
    return any(_reads(each, index, assigned, or_own=or_own, is_given=is_given) for each in inner)


def _last_name(function: ast.expr) -> str:
    return ast.unparse(function).rsplit(".", 1)[-1]


def _assigned_in(scope: ast.AST) -> Assigned:
    found: dict[str, list[ast.expr | None]] = {}
    nodes = list(ast.iter_child_nodes(scope))
    while nodes:
        node = nodes.pop()
        if isinstance(node, ast.FunctionDef | ast.ClassDef | ast.Lambda):
            continue
        nodes += ast.iter_child_nodes(node)
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            found.setdefault(node.id, []).append(None)
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            found.setdefault(node.targets[0].id, []).append(node.value)
    return {name: [each for each in values if each is not None] or [None] for name, values in found.items()}


class IndexSite:
    """An assignment to `index`. Its function reads other indexes of the same table."""

    def __init__(self, index: Index, line: int, reward: ast.expr | None) -> None:
        self.index, self.line, self._reward = index, line, reward
        self.reads: list[Index] = []
        self.is_called = isinstance(reward, ast.Name) and reward.id.startswith(_CALLED)
        """True if the reward is known after the assignment only."""

    @cached_property
    def has_action(self) -> bool:
        """True if the last part is an action and not a column of a grid, by its name or other indexes."""
        names = {each.id for each in ast.walk(self.index.parts[-1]) if isinstance(each, ast.Name)}
        names |= {each.attr for each in ast.walk(self.index.parts[-1]) if isinstance(each, ast.Attribute)}
        is_row_read = any(len(each.parts) < len(self.index.parts) for each in self.reads)
        return is_row_read or any(map(ACTION_NAME.search, names))

    def reward(self, frame: FrameType) -> float | None:
        """Return the reward, or None."""
        found = number_of(_known_value(self._reward, frame))
        return found if math.isfinite(found) else None


# The calls


BEFORE: Final = "__rl_tui_before_put__"
AFTER: Final = "__rl_tui_after_put__"


class _Calls(ast.NodeTransformer):
    def __init__(self, first: int) -> None:
        self._first = first
        self.sites: list[IndexSite] = []
        self._here: list[IndexSite] = []
        self._assigned: Assigned = {}

    def visit_Assign(self, node: ast.Assign) -> Any:
        return self._around(node, node.targets[0], node.value)

    def visit_AugAssign(self, node: ast.AugAssign) -> Any:
        return self._around(node, node.target, node.value)

    def _scope(self, node: ast.AST) -> ast.AST:
        outer = self._here, self._assigned
        self._here, self._assigned = [], _assigned_in(node)
        self.generic_visit(node)
        if self._here:
            found = list(_reads_in(node))
            for site in self._here:
                site.reads = [each for each in found if each.name == site.index.name][:_MOST_READS]
        self._here, self._assigned = outer
        return node

    visit_Module = visit_FunctionDef = _scope  # noqa: N815

    def _around(self, node: ast.stmt, target: ast.expr, value: ast.expr) -> Any:
        index = _index_of(target, self._assigned) if isinstance(target, ast.Subscript) else None
        if index is None or NO_TABLE.search(index.name.split(".")[-1]):
            return node
        number = self._first + len(self.sites)
        reward = _reward_in(value, self._assigned, set()) or _reward_beside(self._assigned)
        reward = reward or _reward_of_call(value, self._assigned, index)
        self.sites.append(IndexSite(index, node.lineno, reward))
        self._here.append(self.sites[-1])
        before, after = (_call(name, number, node) for name in (BEFORE, AFTER))
        return [before, node, after]


def _call(name: str, number: int, beside: ast.stmt) -> ast.stmt:
    made = ast.Expr(ast.Call(ast.Name(name, ast.Load()), [ast.Constant(number)], []))
    for each in ast.walk(made):
        if isinstance(each, ast.expr | ast.stmt):
            ast.copy_location(each, beside)
    return made


_BOX: Final = re.compile(
    r"""["'](CartPole|MountainCar|Acrobot|LunarLander|Pendulum)|^class \w+\([\w.]*\bEnv\)""", re.MULTILINE
)
_GYM: Final = re.compile(r"^\s*(?:from|import)\s+gym", re.MULTILINE)
_IMPORTED: Final = re.compile(r"^\s*(?:from|import)\s+(\w+)", re.MULTILINE)
_MOST_FILES: Final = 20


class Sites:
    """All sites of the program's files.

    They have calls only if a file makes such an environment or defines one, another one has made it, or no
    file imports Gymnasium.
    """

    def __init__(self) -> None:
        self._sites: list[IndexSite] = []
        self._is_on = False

    def __getitem__(self, number: int) -> IndexSite:
        return self._sites[number]

    def add_calls(self, script: Script) -> None:
        """Add calls to `script`, unless it or an import makes other environments."""
        texts = list(_texts(script.text, script.path.absolute().parent))
        if any(map(_BOX.search, texts)) or not any(map(_GYM.search, texts)):
            self.begin()
            self.add_calls_to(script.tree)

    def begin(self) -> None:
        """Add calls to files imported from now on."""
        if not self._is_on:
            self._is_on = True
            sys.meta_path.insert(sys.meta_path.index(PathFinder), _Finder(self))

    def add_calls_to(self, tree: ast.Module) -> None:
        """Add calls to a file's tree."""
        calls = _Calls(len(self._sites))
        calls.visit(tree)
        self._sites += calls.sites

    @staticmethod
    def call(before: Callable[[int], None], after: Callable[[int], None]) -> None:
        """Let `before` and `after` receive the calls."""
        setattr(builtins, BEFORE, before)
        setattr(builtins, AFTER, after)


def _texts(text: str, folder: Path) -> Iterator[str]:
    texts, known = [text], {""}
    while texts:
        text = texts.pop()
        yield text
        for name in set(_IMPORTED.findall(text)) - known:
            known.add(name)
            file = folder / f"{name}.py"
            if len(known) < _MOST_FILES and file.is_file():
                texts.append(file.read_text(encoding="utf-8", errors="replace"))


class _Finder:
    def __init__(self, sites: Sites) -> None:
        self._sites = sites

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: Any = None
    ) -> ModuleSpec | None:
        found = PathFinder.find_spec(name, path, target)
        is_source = found is not None and type(found.loader) is SourceFileLoader and found.origin is not None
        if found is None or not is_source or not is_users_file(str(found.origin)):
            return None
        found.loader = _Loader(name, str(found.origin), self._sites)
        return found


class _Loader(SourceFileLoader):
    def __init__(self, name: str, path: str, sites: Sites) -> None:
        super().__init__(name, path)
        self._sites = sites

    def get_code(self, fullname: str) -> CodeType:
        del fullname
        tree = ast.parse(self.get_data(self.path), self.path)
        self._sites.add_calls_to(tree)
        return compile(tree, self.path, "exec", dont_inherit=True)
