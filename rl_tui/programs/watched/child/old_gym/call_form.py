"""The form in which a call of `reset` or `step` expects its result, read from the code around it.

The old Gym returned (observation, reward, done, info) from `step`, and the observation from `reset`. Since
version 0.26 they are (observation, reward, terminated, truncated, info) and (observation, info).
"""

from __future__ import annotations

import ast
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from enum import Enum, auto
from functools import lru_cache
from itertools import islice
from types import CodeType, FrameType
from typing import Any, Final, NamedTuple

from rl_tui.programs.watched.child.errors import is_users_file, with_callers
from rl_tui.programs.watched.child.script import loaded_tree

OLD: Final = 4
NEW: Final = 5
"""Numbers of values that `step` returns."""
_MOST_FRAMES: Final = 30
_Scope = ast.Module | ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda


class Use(Enum):
    """The use of a result."""

    UNPACKED = auto()
    """It is unpacked into `number` names."""
    INDEXED = auto()
    """Its item `number` is taken."""
    OBSERVATION = auto()
    """Its name gets the observations of `step` too."""
    AS_IT_IS = auto()


class CallForm(NamedTuple):
    """A use of a result, with its number."""

    use: Use
    number: int = 0


def step_result(frame: FrameType, result: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return the five values as the call in `frame` expects."""
    form = form_of(frame)
    if form.use is Use.UNPACKED and form.number in (OLD, NEW):
        values = form.number
    elif form == (Use.INDEXED, NEW - 1):
        values = NEW
    else:
        values = values_around(frame)
    if values == NEW:
        return result
    observation, reward, terminated, truncated, info = result
    if truncated and not terminated:
        info = {**info, "TimeLimit.truncated": True}
    return observation, reward, bool(terminated or truncated), info


def reset_result(frame: FrameType, result: tuple[Any, Any]) -> Any:
    """Return (observation, info) as the call in `frame` expects."""
    form, is_new = form_of(frame), values_around(frame) == NEW
    observation = result[0]
    parts = len(observation) if hasattr(observation, "__len__") else 0
    if form.use is Use.UNPACKED:
        is_of_observation = form.number == parts and (form.number != len(result) or not is_new)
        return observation if is_of_observation else result
    if form.use is Use.INDEXED and not parts:
        return result
    if form.use is Use.OBSERVATION:
        return observation
    return result if is_new else observation


def values_around(frame: FrameType | None) -> int:
    """Return how many values most calls of `step` unpack, in the file of `frame` or a caller's."""
    seen = set()
    for each in islice(with_callers(frame), _MOST_FRAMES):
        file = each.f_code.co_filename
        if file not in seen and is_users_file(file):
            seen.add(file)
            if found := values_in(file):
                return found
    main = getattr(sys.modules.get("__main__"), "__file__", None)
    return (values_in(main) if main else 0) or OLD


def values_in(file: str) -> int:
    """Return the number that most calls of `step` unpack, or 0."""
    forms = (form for method, form in _forms(file).values() if method == "step")
    counted = Counter(form.number for form in forms if form.use is Use.UNPACKED)
    known = {number: counted[number] for number in (OLD, NEW) if counted[number]}
    return max(known, key=known.__getitem__, default=0)


def form_of(frame: FrameType) -> CallForm:
    """Return the form that the call in `frame` expects."""
    return _form_at(frame.f_code, frame.f_lasti)


@lru_cache(maxsize=4096)
def _form_at(code: CodeType, instruction: int) -> CallForm:
    """Find the call by the end of its text, which it shares with no other call."""
    _, end_line, _, end_column = next(islice(code.co_positions(), instruction // 2, None))
    if end_line is None:
        return CallForm(Use.AS_IT_IS)
    return _forms(code.co_filename).get((end_line, end_column or 0), ("", CallForm(Use.AS_IT_IS)))[1]


@lru_cache(maxsize=64)
def _forms(file: str) -> Mapping[tuple[int, int], tuple[str, CallForm]]:
    """Return the methods `step` and `reset`, and the forms of their calls, by the ends of these."""
    tree = loaded_tree(file)
    found: dict[tuple[int, int], tuple[str, CallForm]] = {}
    for scope, parent, call in [] if tree is None else _calls(tree, tree, tree):
        if isinstance(call.func, ast.Attribute) and call.func.attr in ("step", "reset"):
            form = _use_in(parent, call, scope)
            found[call.end_lineno or 0, call.end_col_offset or 0] = call.func.attr, form
    return found


def _calls(node: ast.AST, parent: ast.AST, scope: _Scope) -> Iterator[tuple[_Scope, ast.AST, ast.Call]]:
    if isinstance(node, ast.Call):
        yield scope, parent, node
    inner = node if isinstance(node, _Scope) else scope
    for each in ast.iter_child_nodes(node):
        yield from _calls(each, node, inner)


def _use_in(parent: ast.AST, value: ast.expr, scope: _Scope) -> CallForm:
    form = _use_by(parent, value)
    name = _name_of(parent, value)
    if form.use is not Use.AS_IT_IS or not name:
        return form
    uses = [
        _use_by(node, each)
        for node in ast.walk(scope)
        for each in ast.iter_child_nodes(node)
        if isinstance(each, ast.Name) and each.id == name and isinstance(each.ctx, ast.Load)
    ]
    unpacked = [each for each in uses if each.use is Use.UNPACKED]
    indexed = [each for each in uses if each.use is Use.INDEXED]
    if name in _observations_in(scope):
        form = CallForm(Use.OBSERVATION)
    return max(unpacked or indexed, key=lambda each: each.number, default=form)


def _observations_in(scope: ast.AST) -> set[str]:
    """Return the names that get the first of several values of `step`, and those that get them in turn."""
    found, given = set[str](), dict[str, str]()
    for node in ast.walk(scope):
        match node:
            case ast.Assign(
                targets=[ast.Tuple(elts=[ast.Name(id=name), *_])],
                value=ast.Call(func=ast.Attribute(attr="step")),
            ):
                found.add(name)
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Name(id=source)):
                given[name] = source
    return found | {name for name, source in given.items() if source in found}


def _use_by(parent: ast.AST, value: ast.AST) -> CallForm:
    match parent:
        case ast.Assign(targets=[ast.Tuple(elts=names) | ast.List(elts=names), *_]) if parent.value is value:
            stars = sum(isinstance(each, ast.Starred) for each in names)
            return CallForm(Use.UNPACKED, 0 if stars else len(names))
        case ast.Subscript(slice=ast.Constant(value=int(place))) if parent.value is value:
            return CallForm(Use.INDEXED, place)
    return CallForm(Use.AS_IT_IS)


def _name_of(parent: ast.AST, value: ast.expr) -> str:
    match parent:
        case ast.Assign(targets=[ast.Name(id=name)]) | ast.AnnAssign(target=ast.Name(id=name)):
            return name
        case ast.NamedExpr(target=ast.Name(id=name)) if parent.value is value:
            return name
    return ""
