"""Numbers that the code of a program holds, by name: what it calls its step size and its discount."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from types import CodeType, FrameType, FunctionType
from typing import Any, Final

import numpy as np

from rl_tui.lab.programs.child.faults import is_users_file
from rl_tui.lab.programs.child.tables.search import attributes

_OF_THE_STEP: Final = ("r", "reward", "info")  # what the environment said, not the code
_MOST: Final = 500
_MOST_OF_A_DICT: Final = 100
_DEEPEST_CODE: Final = 8


def numbers_in(frame: FrameType | None, scope: Mapping[str, Any]) -> dict[str, float]:
    """Return floats by name: variables of user code above ``frame``, and of ``scope``.

    Attributes and entries are called ``agent.gamma`` and ``config.gamma``, defaults of functions
    ``train.gamma``; constants in the code by what stands there, ``0.99``.
    """
    found: dict[str, float] = {}
    for names, code in _scopes(frame, scope):
        if code is not None:
            found.update({repr(each): each for each in _constants(code)})
        for name, value in list(names.items()):
            if not (name.startswith("_") or name in _OF_THE_STEP):
                for inner, each in _inside(name, value):
                    if (number := _number(each)) is not None:
                        found[inner] = number
        if len(found) >= _MOST:
            break
    return dict(list(found.items())[:_MOST])


def _scopes(
    frame: FrameType | None, scope: Mapping[str, Any]
) -> Iterator[tuple[Mapping[str, Any], CodeType | None]]:
    yield scope, None
    seen: set[int] = {id(scope)}
    while frame is not None:
        if is_users_file(frame.f_code.co_filename):
            yield frame.f_locals, frame.f_code
            if id(frame.f_globals) not in seen and frame.f_locals is not frame.f_globals:
                yield frame.f_globals, None
            seen.add(id(frame.f_globals))
        frame = frame.f_back


def _inside(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    yield name, value
    if type(value) is FunctionType:
        if is_users_file(value.__code__.co_filename):
            code, defaults = value.__code__, value.__defaults__ or ()
            last = code.co_varnames[code.co_argcount - len(defaults) : code.co_argcount]
            given = [*zip(last, defaults, strict=True), *(value.__kwdefaults__ or {}).items()]
            yield from ((f"{name}.{each}", default) for each, default in given)
            yield from ((repr(each), each) for each in _constants(code))
    elif type(value) is dict:
        if len(value) <= _MOST_OF_A_DICT:
            yield from ((f"{name}.{key}", each) for key, each in value.items() if type(key) is str)
    else:
        yield from ((f"{name}.{key}", each) for key, each in list(attributes(value).items()))


def _constants(code: CodeType, depth: int = 0) -> Iterator[float]:
    for each in code.co_consts:
        if type(each) is float:
            yield each
        elif isinstance(each, CodeType) and depth < _DEEPEST_CODE:
            yield from _constants(each, depth + 1)
        elif type(each) is tuple:
            yield from (part for part in each if type(part) is float)


def _number(value: Any) -> float | None:
    if type(value) is float or issubclass(type(value), np.floating):
        return float(value) if math.isfinite(value) else None
    return None
