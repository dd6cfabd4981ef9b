"""Whether a function only reads: then the update that it should make is not written yet."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from typing import Final

from rl_tui.lab.detective.source.syntax import base_of, name_of

_Function = ast.FunctionDef | ast.AsyncFunctionDef
_DEEPEST: Final = 3
"""Calls that are followed from one function to the next."""
_MODULES: Final = frozenset({"np", "numpy", "math", "random"})
_READING: Final = frozenset(
    {
        "abs",
        "all",
        "any",
        "argmax",
        "bool",
        "choice",
        "dict",
        "enumerate",
        "flatnonzero",
        "float",
        "get",
        "getLegalActions",
        "int",
        "integers",
        "items",
        "keys",
        "len",
        "list",
        "max",
        "mean",
        "min",
        "rand",
        "randint",
        "random",
        "randrange",
        "range",
        "reversed",
        "round",
        "sample",
        "set",
        "sorted",
        "sum",
        "tolist",
        "tuple",
        "uniform",
        "values",
        "where",
        "zip",
        "print",
    }
)
"""Functions and methods that change no table."""


def only_reads(function: _Function, functions: Mapping[str, _Function], table: str) -> bool:
    """Return whether ``function`` puts nothing into any table, nor do the ``functions`` that it calls.

    ``table`` is the table's name, empty where none was found: then it may keep nothing at all. False wherever
    that is not certain.
    """
    return _reads(function, functions, table, _DEEPEST)


def _reads(function: _Function, functions: Mapping[str, _Function], table: str, depth: int) -> bool:
    return all(
        _is_harmless(node, functions, table, depth) for part in function.body for node in ast.walk(part)
    )


def _is_harmless(node: ast.AST, functions: Mapping[str, _Function], table: str, depth: int) -> bool:
    match node:
        case ast.Assign(targets=targets):
            return all(_is_elsewhere(each, table) for each in targets)
        case ast.AnnAssign(target=target):
            return _is_elsewhere(target, table)
        case ast.AugAssign(target=target):
            return isinstance(target, ast.Attribute) and _is_elsewhere(target, table)
        case ast.Call(func=called):
            name = name_of(called)
            if isinstance(called, ast.Attribute) and name_of(base_of(called.value)) in _MODULES:
                return name != "put"
            if name in functions:
                return depth > 0 and _reads(functions[name], functions, table, depth - 1)
            return name in _READING
        case ast.Delete() | ast.Global() | ast.Nonlocal() | ast.Yield() | ast.YieldFrom() | ast.Await():
            return False
        case ast.With() | ast.Import() | ast.ImportFrom():
            return False
        case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.ClassDef():
            return False
    return True


def _is_elsewhere(target: ast.expr, table: str) -> bool:
    """Return whether giving ``target`` a value leaves all that may be a table as it is."""
    if isinstance(target, ast.Tuple):
        return all(_is_elsewhere(each, table) for each in target.elts)
    if isinstance(target, ast.Attribute):
        return bool(table) and target.attr != table
    return isinstance(target, ast.Name)
