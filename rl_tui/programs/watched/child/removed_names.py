"""Names that NumPy, pandas and Python have removed, for older scripts."""

from __future__ import annotations

import ast
import builtins
import collections
import collections.abc
import math
import random
import sys
import time
from collections.abc import Callable, Mapping
from types import ModuleType
from typing import Any, Final

import numpy as np

from rl_tui.common.after_import import after_import
from rl_tui.programs.watched.child.errors import is_users_file

Note = Callable[[str], None]
_NUMPY: Final[Mapping[str, tuple[Any, str]]] = {
    "int": (int, "int"),
    "float": (float, "float"),
    "bool": (bool, "bool"),
    "object": (object, "object"),
    "str": (str, "str"),
    "complex": (complex, "complex"),
    "float_": (np.float64, "numpy.float64"),
    "bool8": (np.bool_, "numpy.bool_"),
    "int0": (np.intp, "numpy.intp"),
    "unicode_": (np.str_, "numpy.str_"),
    **dict.fromkeys(("Inf", "Infinity", "PINF", "infty"), (np.inf, "numpy.inf")),
    "NINF": (-np.inf, "-numpy.inf"),
    "NaN": (np.nan, "numpy.nan"),
    "alltrue": (np.all, "numpy.all"),
    "sometrue": (np.any, "numpy.any"),
    "product": (np.prod, "numpy.prod"),
    "cumproduct": (np.cumprod, "numpy.cumprod"),
}
_COLLECTIONS: Final = {
    name: (getattr(collections.abc, name), f"collections.abc.{name}") for name in collections.abc.__all__
}
_GCD: Final = {"gcd": (math.gcd, "math.gcd")}
_SEED: Final = "random accepts a {} as seed only in older versions of Python: its text was used instead"
_FRAME: Final = "pandas.DataFrame"
_ONE_NUMBER: Final = "__rl_tui_one_number__"
_NO_NUMBER: Final = (
    "this version of NumPy does not turn an array into a number: its only entry was used instead"
)


def give_back_removed_names(note: Note) -> None:
    """Let removed names work, and `note` the first use of each."""
    _give_back(np, _NUMPY, "NumPy", note)
    _give_back(collections, _COLLECTIONS, "Python", note)
    _give_back(time, {"clock": (time.perf_counter, "time.perf_counter")}, "Python", note)
    after_import("fractions", lambda module: _give_back(module, _GCD, "Python", note))
    after_import("pandas", lambda pandas: _give_back_to_frames(pandas, note))

    def xrange(*numbers: int) -> range:
        note(_said("xrange", "range", "Python"))
        return range(*numbers)

    builtins.xrange = xrange  # type: ignore[attr-defined]
    seed_with = random.Random.seed

    def seed(it: random.Random, a: Any = None, version: int = 2) -> None:
        try:
            seed_with(it, a, version)
        except TypeError:
            note(_SEED.format(type(a).__name__))
            seed_with(it, str(a), version)

    random.Random.seed = seed  # type: ignore[method-assign, assignment]
    random.seed = random.random.__self__.seed  # type: ignore[attr-defined]


def _give_back(module: ModuleType, names: Mapping[str, tuple[Any, str]], owner: str, note: Note) -> None:
    before = vars(module).get("__getattr__")

    def found(name: str) -> Any:
        if name in names and is_users_file(sys._getframe(1).f_code.co_filename):  # libraries look for names
            value, now = names[name]
            note(_said(f"{module.__name__}.{name}", now, owner))
            return value
        if before is not None:
            return before(name)
        raise AttributeError(f"module {module.__name__!r} has no attribute {name!r}")

    module.__getattr__ = found  # type: ignore[method-assign]


def _said(name: str, now: str, owner: str) -> str:
    return f"{name} is not in this {owner}: {now} was used instead"


def _give_back_to_frames(pandas: Any, note: Note) -> None:
    def append(frame: Any, other: Any, ignore_index: bool = False, **_: Any) -> Any:
        note(_said(f"{_FRAME}.append", "pandas.concat", "pandas"))
        if isinstance(other, dict):
            other = pandas.Series(other)
        if isinstance(other, pandas.Series):
            other = other.to_frame().T
        return pandas.concat([frame, other], ignore_index=ignore_index)

    def ix(frame: Any) -> Any:
        note(_said(f"{_FRAME}.ix", "loc", "pandas"))
        return frame.loc

    for name, value in (("append", append), ("ix", property(ix))):
        if not hasattr(pandas.DataFrame, name):
            setattr(pandas.DataFrame, name, value)


def give_back_conversions(tree: ast.Module, note: Note) -> None:
    """Let `int(np.random.choice(a, 1))` and similar calls work as before."""

    def one_number(value: Any) -> Any:
        if type(value) is not np.ndarray or value.ndim == 0 or value.size != 1:
            return value
        note(_NO_NUMBER)
        return value.item()

    found = [each for each in ast.walk(tree) if isinstance(each, ast.Call) and _may_convert(each)]
    setattr(builtins, _ONE_NUMBER, one_number)
    for each in found:
        inner = each.args[0]
        name = ast.copy_location(ast.Name(_ONE_NUMBER, ast.Load()), inner)
        each.args = [ast.copy_location(ast.Call(name, [inner], []), inner)]


def _may_convert(call: ast.Call) -> bool:
    """Return True for `int` or `float` of a method's result. With one argument, it is usually a number."""
    match call:
        case ast.Call(ast.Name("int" | "float"), [ast.Call(ast.Attribute(), arguments, keywords)], []):
            return len(arguments) + len(keywords) > 1
    return False
