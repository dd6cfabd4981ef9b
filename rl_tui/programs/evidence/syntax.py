"""Static queries on the syntax tree of a script."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Final, TypeVar

from rl_tui.common.errors import UserError
from rl_tui.common.limits import LARGEST_NOTEBOOK, LARGEST_SOURCE
from rl_tui.programs.watched.child.script import parsed, source_of
from rl_tui.programs.watched.notebook import is_notebook

_WRITING: Final = frozenset({"itemset", "put", "update", "__setitem__", "setdefault"})
_CHOOSING: Final = frozenset({"argmax", "max", "nanargmax", "argsort", "argmin"})
Node = TypeVar("Node", bound=ast.AST)


def parsed_file(file: str) -> ast.Module | None:
    """Return the syntax tree of a readable file."""
    try:
        path = Path(file)
        found = path.stat()
        most = LARGEST_NOTEBOOK if is_notebook(path) else LARGEST_SOURCE
        return None if found.st_size > most else _parsed(path, found.st_mtime_ns)
    except (OSError, ValueError):
        return None


@lru_cache(maxsize=32)
def _parsed(path: Path, changed: int) -> ast.Module | None:
    del changed  # a new key after each save
    try:
        return parsed(source_of(path), str(path))[0]
    except (UserError, SyntaxError, ValueError, RecursionError, MemoryError):
        return None


def imported_modules(tree: ast.Module) -> Iterator[str]:
    """Yield the full names of all imported modules."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (each.name for each in node.names)
        elif isinstance(node, ast.ImportFrom):
            if node.module:
                yield node.module
            else:
                yield from (each.name for each in node.names)  # from . import module


def of_type(tree: ast.AST, kind: type[Node]) -> Iterator[Node]:
    """Yield the nodes of a kind, ordered by line."""
    found = [node for node in ast.walk(tree) if isinstance(node, kind)]
    return iter(sorted(found, key=lambda node: (getattr(node, "lineno", 0), getattr(node, "col_offset", 0))))


def name_of(node: ast.AST | None) -> str:
    """Return the last part of a name, or ""."""
    if isinstance(node, ast.Name):
        return node.id
    return node.attr if isinstance(node, ast.Attribute) else ""


def names_in(expression: ast.expr) -> set[str]:
    """Return all plain names in `expression`."""
    return {node.id for node in of_type(expression, ast.Name)}


def base_of(node: ast.expr) -> ast.expr:
    """Return the object under all indexes and copies."""
    while True:
        if isinstance(node, ast.Subscript):
            node = node.value
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "copy":
            node = node.func.value
        else:
            return node


def assigned(node: ast.AST) -> tuple[ast.expr | None, ast.expr | None]:
    """Return target and value of an assignment."""
    if isinstance(node, ast.Assign) and len(node.targets) == 1:
        return node.targets[0], node.value
    if isinstance(node, ast.AnnAssign):
        return node.target, node.value
    return None, None


def targets_of(node: ast.stmt) -> Sequence[str]:
    """Return the plain names that an assignment sets."""
    target, _ = assigned(node)
    elements = target.elts if isinstance(target, ast.Tuple) else [target]
    return [each.id for each in elements if isinstance(each, ast.Name)]


def is_part_of(value: ast.expr, names: set[str]) -> bool:
    """Return True for a copy, row or cell of the table."""
    if isinstance(value, ast.Subscript):
        return name_of(base_of(value)) in names
    if not isinstance(value, ast.Call):
        return False
    if isinstance(value.func, ast.Attribute) and value.func.attr in ("copy", "tolist", "astype"):
        return name_of(base_of(value.func.value)) in names
    is_copy = name_of(value.func) in ("copy", "deepcopy", "array", "list", "dict")
    return is_copy and any(name_of(base_of(each)) in names for each in value.args)


def is_write(node: ast.stmt, names: frozenset[str]) -> bool:
    """Return True for an attempt to write to the table."""
    if isinstance(node, ast.AugAssign):
        return name_of(base_of(node.target)) in names
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Compare):  # == in place of =
        left = node.value.left
        return isinstance(left, ast.Subscript) and name_of(base_of(left)) in names
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
        function = node.value.func
        is_writing = isinstance(function, ast.Attribute) and function.attr in _WRITING
        return is_writing and name_of(base_of(function.value)) in names  # type: ignore[attr-defined]
    target, value = assigned(node)
    if not isinstance(target, ast.Subscript) or name_of(base_of(target)) not in names or value is None:
        return False
    mentions = any(name_of(each) in names for each in ast.walk(value))
    return mentions or isinstance(value, ast.Name | ast.BinOp)


def is_set_to_constant(node: ast.stmt, names: frozenset[str]) -> bool:
    """Return True if a cell is set to a constant."""
    target, value = assigned(node)
    if isinstance(value, ast.UnaryOp):
        value = value.operand
    is_cell = isinstance(target, ast.Subscript) and name_of(base_of(target)) in names
    return is_cell and isinstance(value, ast.Constant)


def is_main_guard(node: ast.If) -> bool:
    """Recognize `if __name__ == "__main__"`."""
    return any(each.id == "__name__" for each in of_type(node.test, ast.Name))


def inner_statements(node: ast.stmt) -> Iterator[ast.stmt]:
    """Yield the statements in a loop, `with` or `try`."""
    for part in ("body", "orelse", "finalbody"):
        yield from getattr(node, part, ())


def calls_of_step(node: ast.stmt) -> Iterator[ast.Call]:
    """Yield calls of `step` in a simple statement."""
    if not is_simple(node):
        return
    for call in of_type(node, ast.Call):
        if isinstance(call.func, ast.Attribute) and call.func.attr == "step":
            yield call


def is_simple(node: ast.stmt) -> bool:
    """Return True if `node` contains no statements."""
    return not hasattr(node, "body")


def chooses(node: ast.AST) -> bool:
    """Return True if `node` contains a maximum."""
    return any(name_of(call.func) in _CHOOSING for call in of_type(node, ast.Call))


def first_name(node: ast.expr) -> str:
    """Return the first name in an expression, or ""."""
    return next((each.id for each in of_type(node, ast.Name) if each.id != "int"), "")
