"""The expressions of figures: arithmetic with names and calls.

They are data, parsed by Python and evaluated node by node. Anything not listed is refused.
"""

from __future__ import annotations

import ast
import math
import operator
import warnings
from collections.abc import Callable, Mapping
from typing import Any, Final

from rl_tui.common.errors import UserError, complaint
from rl_tui.common.findings import shown

MOST_NODES: Final = 300
MOST_DEPTH: Final = 20
LARGEST: Final = 1e15
"""Largest number in an expression."""

Value = Any
"""The value of an expression: number, text or truth value. An argument may be a list or a table."""
Call = Callable[[str, list[Value], dict[str, Value]], Value]
"""Computes a function from its name, arguments and named arguments."""
Look = Callable[[str], Value]
"""Returns the value of a name."""

FORM: Final = "numbers, strings in quotes, names, calls, + − * / ** and brackets"
_BINARY: Final[Mapping[type[ast.operator], Callable[[float, float], Any]]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}


class FigureError(UserError):
    """A figure that cannot be computed, and why."""

    def __init__(self, found: str, expected: str = "") -> None:
        self.found, self.expected = found, expected
        super().__init__(complaint(found, expected))


class SeedMean(float):
    """A mean over seeds with its standard `error`."""

    error: float

    def __new__(cls, value: float, error: float) -> SeedMean:
        """Return the mean `value` with its `error`."""
        made = super().__new__(cls, value)
        made.error = error
        return made


def read_expression(text: str) -> ast.expr:
    """Parse a bounded expression. Raises FigureError."""
    plain = text.replace("−", "-").strip()
    try:
        with warnings.catch_warnings(action="ignore"):  # about text that is not Python
            tree = ast.parse(plain, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise FigureError(shown(text), f"an expression of {FORM}") from error
    if sum(1 for _ in ast.walk(tree)) > MOST_NODES:
        raise FigureError(f"the expression is too long; use at most {MOST_NODES} numbers, names and signs")
    _check(tree, 0)
    return tree


def evaluate(tree: ast.expr, look: Look, call: Call) -> Value:
    """Evaluate `tree` with names from `look` and functions from `call`. Raises FigureError."""
    return _Evaluation(look, call).value(tree)


def _check(node: ast.expr, depth: int) -> None:
    if depth > MOST_DEPTH:
        raise FigureError(f"brackets are nested too deeply; use at most {MOST_DEPTH} levels")
    inner: list[ast.expr] = []
    match node:
        case ast.Constant(value=bool() | str()) | ast.Name():
            pass
        case ast.Constant(value=int() | float() as number) if abs(number) <= LARGEST:
            pass
        case ast.Constant(value=int() | float()):
            raise FigureError(f"a number is too large; use numbers up to {LARGEST:g}")
        case ast.UnaryOp(op=ast.USub() | ast.UAdd(), operand=operand):
            inner = [operand]
        case ast.BinOp(op=op, left=left, right=right) if type(op) in _BINARY:
            inner = [left, right]
        case ast.List(elts=elements) | ast.Tuple(elts=elements):
            inner = elements
        case ast.Dict(keys=keys, values=values) if all(isinstance(key, ast.Constant) for key in keys):
            inner = [*(key for key in keys if key is not None), *values]
        case ast.Call(func=ast.Name(), args=arguments, keywords=by_name) if all(
            each.arg is not None for each in by_name
        ):
            inner = [*arguments, *(each.value for each in by_name)]
        case _:
            raise FigureError(f"{shown(ast.unparse(node))} is not possible here; use {FORM}")
    for each in inner:
        _check(each, depth + 1)


class _Evaluation:
    def __init__(self, look: Look, call: Call) -> None:
        self._look = look
        self._call = call

    def value(self, node: ast.expr) -> Value:
        match node:
            case ast.Constant(value=constant):
                return constant
            case ast.Name(id=name):
                return self._look(name)
            case ast.UnaryOp(op=op, operand=operand):
                number = self._number(operand)
                return self._arithmetic(ast.Mult(), -1.0, number) if isinstance(op, ast.USub) else number
            case ast.BinOp(op=op, left=left, right=right):
                return self._arithmetic(op, self._number(left), self._number(right))
            case ast.List(elts=elements) | ast.Tuple(elts=elements):
                return [self.value(each) for each in elements]
            case ast.Dict(keys=keys, values=values):
                return {
                    self.value(key): self.value(value)
                    for key, value in zip(keys, values, strict=True)
                    if key is not None
                }
            case ast.Call(func=ast.Name(id=name), args=arguments, keywords=by_name):
                named = {each.arg: self.value(each.value) for each in by_name if each.arg is not None}
                return self._call(name, [self.value(each) for each in arguments], named)
        raise FigureError(f"{shown(ast.unparse(node))} is not possible here; use {FORM}")

    def _number(self, node: ast.expr) -> float:
        value = self.value(node)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise FigureError(f"{shown(ast.unparse(node))} is {shown(value)}; use a number")
        return value if isinstance(value, SeedMean) else float(value)

    def _arithmetic(self, op: ast.operator, left: float, right: float) -> float:
        try:
            result = _BINARY[type(op)](left, right)
        except ZeroDivisionError:
            raise FigureError("division by 0; use another divisor") from None
        except OverflowError:
            result = math.inf
        if not isinstance(result, float) or not math.isfinite(result):
            raise FigureError("the result is not a finite number; use other numbers")
        error = _error_of(op, left, right)
        return result if error is None else SeedMean(result, error)


def _error_of(op: ast.operator, left: float, right: float) -> float | None:
    """Return the standard error of `op` on one mean over seeds and one number, else None."""
    if isinstance(left, SeedMean) == isinstance(right, SeedMean):
        return None
    error = left.error if isinstance(left, SeedMean) else getattr(right, "error", 0.0)
    other = right if isinstance(left, SeedMean) else left
    match op:
        case ast.Add() | ast.Sub():
            return error
        case ast.Mult():
            return error * abs(other)
        case ast.Div() if isinstance(left, SeedMean):
            return error / abs(other)
    return None
