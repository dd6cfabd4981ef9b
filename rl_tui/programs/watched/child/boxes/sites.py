"""Assignments to a subscript, with a call before and after each. The calls read the names of its index, and
call nothing of the program's.
"""

from __future__ import annotations

import ast
import builtins
import copy
import operator
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from enum import Enum
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from pathlib import Path
from types import CodeType, FrameType
from typing import Any, Final

import numpy as np

from rl_tui.programs.watched.child.errors import is_users_file
from rl_tui.programs.watched.child.script import Script
from rl_tui.programs.watched.child.tables.search import NO_TABLE, attributes
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


def value_of(node: ast.expr, frame: FrameType) -> Any:
    """Return the value of a readable expression in `frame`. Raises LookupError, TypeError or ValueError if
    it has none that can be known without the program's code.
    """
    match node:
        case ast.Constant(value=value):
            return value
        case ast.Name(id=name):
            return frame.f_locals[name] if name in frame.f_locals else frame.f_globals[name]
        case ast.Attribute(value=inner, attr=name):
            holder = value_of(inner, frame)
            is_value = name == "value" and issubclass(type(holder), Enum)
            return attributes(holder)["_value_" if is_value else name]
        case ast.Tuple(elts=parts):
            return tuple(each for part in parts for each in _elements(part, frame))
        case ast.Subscript(value=inner, slice=index):
            return _plain(value_of(inner, frame))[_plain(value_of(index, frame))]
        case ast.BinOp(left=left, op=sign, right=right):
            sides = _plain(value_of(left, frame)), _plain(value_of(right, frame))
            return _OPERATORS[type(sign)](*sides)
        case ast.Call(func=ast.Name(id=name), args=[inner]) if name not in frame.f_globals:
            return _CONVERSIONS[name](_plain(value_of(inner, frame)))
    raise ValueError("an expression that is not read")


def _elements(node: ast.expr, frame: FrameType) -> tuple[Any, ...]:
    if isinstance(node, ast.Starred):
        return tuple(_plain(value_of(node.value, frame)))
    return (value_of(node, frame),)


def _plain(value: Any) -> Any:
    """Return `value` if its type is not the program's. Raises TypeError for others."""
    if type(value) in _PLAIN or issubclass(type(value), np.generic):
        key_of(value)  # its parts are plain too
        return value
    raise TypeError(f"a {type(value).__name__} in an index")


class Index:
    """An index such as `[s][a]` of the variable or attribute `base`."""

    def __init__(self, base: ast.expr, parts: Sequence[ast.expr]) -> None:
        self.name = ast.unparse(base)
        self._base, self._parts = base, parts

    def table(self, frame: FrameType) -> Any:
        """Return the object that is indexed, or None."""
        try:
            return value_of(self._base, frame)
        except (LookupError, TypeError, ValueError, ArithmeticError):
            return None

    def keys(self, frame: FrameType) -> tuple[Any, ...] | None:
        """Return all parts of the index, those of tuples too, or None."""
        try:
            return tuple(_flat(key_of(value_of(each, frame)) for each in self._parts))
        except (LookupError, TypeError, ValueError, ArithmeticError):
            return None


def _flat(keys: Iterator[Key]) -> Iterator[Any]:
    for each in keys:
        if type(each) is tuple:
            yield from _flat(iter(each))
        else:
            yield each


def _index_of(node: ast.expr) -> Index | None:
    """Return the index of `T[a][b, c]` if all of it can be read, or None."""
    parts: list[ast.expr] = []
    while isinstance(node, ast.Subscript):
        parts = [*(node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]), *parts]
        node = node.value
    if isinstance(node, ast.Attribute) and node.attr in _PANDAS:
        node = node.value
    is_base = isinstance(node, ast.Name | ast.Attribute) and _is_readable(node)
    if not (parts and is_base and all(map(_is_readable, parts))):
        return None
    return Index(copy.deepcopy(node), copy.deepcopy(parts))


class IndexSite:
    """An assignment to `index` in a line of a file, and the indexes of the same table that its function
    reads.
    """

    def __init__(self, index: Index, line: int) -> None:
        self.index, self.line = index, line
        self.reads: list[Index] = []


# The calls


BEFORE: Final = "__rl_tui_before_put__"
AFTER: Final = "__rl_tui_after_put__"


class _Calls(ast.NodeTransformer):
    """Adds the calls, and lists the sites from `first` on."""

    def __init__(self, first: int) -> None:
        self._first = first
        self.sites: list[IndexSite] = []
        self._here: list[IndexSite] = []

    def visit_Module(self, node: ast.Module) -> ast.AST:
        return self._scope(node)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        return self._scope(node)

    def visit_Assign(self, node: ast.Assign) -> Any:
        return self._around(node, node.targets[0])

    def visit_AugAssign(self, node: ast.AugAssign) -> Any:
        return self._around(node, node.target)

    def _scope(self, node: ast.AST) -> ast.AST:
        outer, self._here = self._here, []
        self.generic_visit(node)
        if self._here:
            subscripts = [each for each in ast.walk(node) if isinstance(each, ast.Subscript)]
            found = [_index_of(each) for each in subscripts if isinstance(each.ctx, ast.Load)]
            for site in self._here:
                same = [each for each in found if each is not None and each.name == site.index.name]
                site.reads = same[:_MOST_READS]
        self._here = outer
        return node

    def _around(self, node: ast.stmt, target: ast.expr) -> Any:
        index = _index_of(target) if isinstance(target, ast.Subscript) else None
        if index is None or NO_TABLE.search(index.name.split(".")[-1]):
            return node
        number = self._first + len(self.sites)
        self.sites.append(IndexSite(index, node.lineno))
        self._here.append(self.sites[-1])
        before, after = (_call(name, number, node) for name in (BEFORE, AFTER))
        return [before, node, after]


def _call(name: str, number: int, beside: ast.stmt) -> ast.stmt:
    made = ast.Expr(ast.Call(ast.Name(name, ast.Load()), [ast.Constant(number)], []))
    for each in ast.walk(made):
        if isinstance(each, ast.expr | ast.stmt):
            ast.copy_location(each, beside)
    return made


_BOX: Final = re.compile(r"""["'](CartPole|MountainCar|Acrobot|LunarLander|Pendulum)""")
_IMPORTED: Final = re.compile(r"^\s*(?:from|import)\s+(\w+)", re.MULTILINE)
_MOST_FILES: Final = 20


class Sites:
    """All sites of the program's files. They have calls only if a file makes such an environment, or
    another one has made it.
    """

    def __init__(self) -> None:
        self._sites: list[IndexSite] = []
        self._is_on = False

    def __getitem__(self, number: int) -> IndexSite:
        return self._sites[number]

    def with_calls(self, script: Script, path: Path) -> Script:
        """Return `script` with calls, if it or a file that it imports makes such an environment."""
        if not _makes_a_box(script.text, path.absolute().parent):
            return script
        self.begin()
        return script._replace(code=self.compiled(script.tree, str(path.absolute())))

    def begin(self) -> None:
        """Add calls to files that are imported from now on."""
        if not self._is_on:
            self._is_on = True
            sys.meta_path.insert(0, _Finder(self))

    def compiled(self, tree: ast.Module, file: str) -> CodeType:
        """Compile `tree` with calls."""
        calls = _Calls(len(self._sites))
        calls.visit(tree)
        self._sites += calls.sites
        return compile(tree, file, "exec", dont_inherit=True)

    @staticmethod
    def call(before: Callable[[int], None], after: Callable[[int], None]) -> None:
        """Let `before` and `after` receive the calls."""
        setattr(builtins, BEFORE, before)
        setattr(builtins, AFTER, after)


def _makes_a_box(text: str, folder: Path) -> bool:
    texts, known = [text], {""}
    while texts:
        text = texts.pop()
        if _BOX.search(text):
            return True
        for name in set(_IMPORTED.findall(text)) - known:
            known.add(name)
            file = folder / f"{name}.py"
            if len(known) < _MOST_FILES and file.is_file():
                texts.append(file.read_text(errors="replace"))
    return False


class _Finder:
    def __init__(self, sites: Sites) -> None:
        self._sites = sites

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: Any = None
    ) -> ModuleSpec | None:
        """Return the specification of a module of the user's, with calls."""
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
        """Compile the module, never taken from a cache."""
        del fullname
        return self._sites.compiled(ast.parse(self.get_data(self.path), self.path), self.path)
