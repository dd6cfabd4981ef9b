"""The program's functions step(state, action), which return (next state, reward)."""

from __future__ import annotations

import ast
import builtins
import sys
from functools import wraps
from types import FunctionType
from typing import Any, Final

from rl_tui.programs.watched.child.worlds.first_steps import function_step_of
from rl_tui.programs.watched.child.worlds.met import UnfitError, state_key
from rl_tui.programs.watched.child.worlds.own_worlds import FunctionWorld, OwnWorlds

_NAMES: Final = frozenset(
    {
        *("step", "move", "env_step", "step_env", "take_step", "make_step", "take_action", "interact"),
        *("get_env_feedback", "environment_step", "get_next_state_reward", "get_next_state_and_reward"),
    }
)
_OTHERS: Final = frozenset({"self", "cls", "env", "agent"})
"""Names of a first parameter that is not a state."""
_DECORATOR: Final = "__rl_tui_watched_function__"


def watch_functions(tree: ast.Module, worlds: OwnWorlds) -> None:
    """Put hooks around functions that may take a step."""
    setattr(builtins, _DECORATOR, lambda function: _watched(function, worlds))
    for each in tree.body:
        if isinstance(each, ast.FunctionDef) and _may_take_a_step(each):
            each.decorator_list.append(ast.copy_location(ast.Name(_DECORATOR, ast.Load()), each))


def _may_take_a_step(function: ast.FunctionDef) -> bool:
    names = [each.arg for each in function.args.args]
    is_named = function.name in _NAMES and len(names) >= 2 and names[0] not in _OTHERS
    return is_named and not function.decorator_list


def _watched(function: FunctionType, worlds: OwnWorlds) -> Any:
    world = FunctionWorld(function)

    @wraps(function)
    def step(*arguments: Any, **more: Any) -> Any:
        if len(arguments) < 2 or not worlds.may_report(world):
            return function(*arguments, **more)
        try:
            key = state_key(arguments[0])
        except UnfitError:
            return function(*arguments, **more)
        return worlds.step_from(
            world,
            key,
            arguments[:2],
            sys._getframe(1),
            lambda: function(*arguments, **more),
            lambda result: function_step_of(result, key),
        )

    return step
