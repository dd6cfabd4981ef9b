"""Which class or function of a file is an agent, and the file as a module.

The file is read before it is run: what its text says is enough to tell its agents. A base class may stand in
another file of the same folder; of other base classes nothing is known.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path
from types import CodeType, ModuleType
from typing import Final, NamedTuple

from rl_tui.common.errors import UserError
from rl_tui.common.findings import near, shown
from rl_tui.common.text_file import UnreadableError, read_bytes
from rl_tui.programs.own_agents.binding import (
    OF_FUNCTION,
    SHAPE_OF,
    Style,
    role_of,
    shapes_in_words,
    style_of_methods,
)

_DEEPEST: Final = 8
"""Base classes behind base classes that are followed."""
_MOST_NAMED: Final = 6
_Function = ast.FunctionDef | ast.AsyncFunctionDef
_DEFINITIONS: Final = (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


class AgentPlace(NamedTuple):
    """An agent in a file: the ``name`` of its class or function, and the line where that begins."""

    name: str
    style: Style
    line: int


class AgentName(NamedTuple):
    """What ``FILE.py[:NAME]`` says: ``name`` is empty where the file has only one agent."""

    path: Path
    name: str

    @classmethod
    def read(cls, text: str) -> AgentName:
        """Return what ``text`` says. A colon in the path is part of it, unless ``.py:`` comes before it."""
        path, colon, name = text.rpartition(".py:")
        return cls(Path(f"{path}.py"), name) if colon else cls(Path(text), "")


def agents_in(tree: ast.Module, folder: Path) -> list[AgentPlace]:
    """Return the agents that the file of ``tree`` has, in its order; ``folder`` is where it lies.

    An abstract class is none. A bare function counts only in a file that has no class of a shape, and makes
    no environment of its own: there it belongs to a script.
    """
    classes = [
        AgentPlace(each.name, style, each.lineno)
        for each in _classes(tree)
        if (style := _style(each, tree, folder)) is not None
    ]
    if classes or makes_environment(tree):
        return classes
    functions = (each for each in tree.body if isinstance(each, ast.FunctionDef))
    return [
        AgentPlace(each.name, Style.FUNCTION, each.lineno) for each in functions if _is_update_function(each)
    ]


def the_agent(tree: ast.Module, path: Path, name: str = "") -> AgentPlace:
    """Return the agent called ``name`` in the file of ``tree`` at ``path``, the only one if that is empty.

    Raises UserError where there is none, or there are several.
    """
    file, places = shown(path.name), agents_in(tree, path.parent)
    if name:
        named = _named(tree, path.parent, name)
        if named is not None:
            return named
        others = [each.name for each in tree.body if isinstance(each, (ast.ClassDef, ast.FunctionDef))]
        if name in others:
            raise UserError(f"{file}: {shown(name)} has no shape of an agent: {shapes_in_words()}")
        raise UserError(f"{file}: there is no {shown(name)}{near(name, others)}")
    if len(places) == 1:
        return places[0]
    if places:
        names = ", ".join(each.name for each in places[:_MOST_NAMED])
        raise UserError(f"{file} has several agents ({names}): say which, as in {path.name}:{places[0].name}")
    raise UserError(f"{file}: no class or function in it has the shape of an agent: {shapes_in_words()}")


def runs_when_imported(tree: ast.Module) -> bool:
    """Return whether the file of ``tree`` is a script, whatever classes it has: importing it takes steps.

    It makes an environment where it is imported, or loops there and makes one somewhere. What stands below a
    question for ``__name__`` does not run then.
    """
    run = [each for each in tree.body if not (isinstance(each, _DEFINITIONS) or _asks_for_name(each))]
    if any(makes_environment(each) for each in run):
        return True
    loops = any(isinstance(each, (ast.For, ast.While)) for top in run for each in ast.walk(top))
    return loops and makes_environment(tree)


def load_module(code: CodeType, path: Path) -> ModuleType:
    """Run ``code``, that of the file ``path``, as a module of the file's name, and return it.

    Its ``__name__`` is not ``__main__``, so that a loop below that question does not run. Modules of its
    folder can be imported. Raises what the file raises.
    """
    folder = str(path.absolute().parent)
    if folder not in sys.path:
        sys.path.insert(0, folder)
    name = path.stem if path.stem.isidentifier() and path.stem not in sys.modules else "agent_of_a_file"
    spec = spec_from_loader(name, loader=None, origin=str(path.absolute()))
    assert spec is not None
    module = module_from_spec(spec)
    module.__file__ = str(path.absolute())
    sys.modules[name] = module
    exec(code, module.__dict__)
    return module


def _classes(tree: ast.Module) -> Iterator[ast.ClassDef]:
    return (each for each in tree.body if isinstance(each, ast.ClassDef))


def _style(node: ast.ClassDef, tree: ast.Module, folder: Path) -> Style | None:
    """Return the style of a class, None where it is no agent or an abstract one."""
    methods = _methods(node, tree, folder, _DEEPEST)
    style = style_of_methods(frozenset(methods))
    if style is None or any(_is_abstract(methods[name]) for name in SHAPE_OF[style].methods):
        return None
    return style


def _methods(node: ast.ClassDef, tree: ast.Module, folder: Path, deepest: int) -> dict[str, _Function]:
    """Return the methods of a class by name, with those of base classes that can be found."""
    methods: dict[str, _Function] = {}
    for base in reversed(node.bases):
        if isinstance(base, ast.Name) and deepest:
            for known, where in _class_called(base.id, node, tree, folder):
                methods |= _methods(known, where, folder, deepest - 1)
    own = (each for each in node.body if isinstance(each, _Function))
    return methods | {each.name: each for each in own}


def _class_called(
    name: str, but: ast.ClassDef, tree: ast.Module, folder: Path
) -> Iterator[tuple[ast.ClassDef, ast.Module]]:
    """Yield the class of that name in the file, or in the file of the folder that it is imported from."""
    for each in _classes(tree):
        if each.name == name and each is not but:
            yield each, tree
            return
    for imported in ast.walk(tree):
        if isinstance(imported, ast.ImportFrom) and imported.module and not imported.level:
            for alias in imported.names:
                if (alias.asname or alias.name) == name:
                    other = _parsed(folder.joinpath(*imported.module.split(".")).with_suffix(".py"))
                    if other is not None:
                        yield from ((each, other) for each in _classes(other) if each.name == alias.name)
                    return


def _parsed(path: Path) -> ast.Module | None:
    try:
        return ast.parse(read_bytes(path, "a Python file")[0])
    except (UnreadableError, SyntaxError, ValueError, RecursionError, MemoryError):
        return None  # what is wrong with it is said when it is imported


def _is_abstract(method: _Function) -> bool:
    """Return whether a method only stands for those of derived classes."""
    if any(_last_name(each) == "abstractmethod" for each in method.decorator_list):
        return True
    last = method.body[-1]
    raised = last.exc if isinstance(last, ast.Raise) else None
    return _last_name(raised.func if isinstance(raised, ast.Call) else raised) == "NotImplementedError"


def _last_name(node: ast.AST | None) -> str:
    """Return the name at the end of ``node``: that of a variable or attribute; else nothing."""
    return node.attr if isinstance(node, ast.Attribute) else getattr(node, "id", "")


def _named(tree: ast.Module, folder: Path, name: str) -> AgentPlace | None:
    """Return the agent of that name. A function that is named may be called anything."""
    for each in tree.body:
        if isinstance(each, ast.ClassDef) and each.name == name:
            style = _style(each, tree, folder)
            return None if style is None else AgentPlace(name, style, each.lineno)
        if isinstance(each, ast.FunctionDef) and each.name == name and _has_roles_of_function(each):
            return AgentPlace(name, Style.FUNCTION, each.lineno)
    return None


def _is_update_function(node: ast.FunctionDef) -> bool:
    return ("update" in node.name.lower() or "learn" in node.name.lower()) and _has_roles_of_function(node)


def _has_roles_of_function(node: ast.FunctionDef) -> bool:
    parameters = (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)
    return {role_of(each.arg) for each in parameters}.issuperset(OF_FUNCTION)


def _asks_for_name(node: ast.stmt) -> bool:
    return isinstance(node, ast.If) and any(_last_name(each) == "__name__" for each in ast.walk(node.test))


def makes_environment(tree: ast.AST) -> bool:
    """Return whether a ``make`` is called anywhere: ``gymnasium.make(…)`` or the name alone."""
    return any(_last_name(each.func) == "make" for each in ast.walk(tree) if isinstance(each, ast.Call))
