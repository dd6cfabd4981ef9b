"""Finding the agents in a file's source, and running it as a module."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterable, Iterator
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path
from types import CodeType, ModuleType
from typing import Final, NamedTuple

from rl_tui.common.errors import UserError
from rl_tui.common.findings import near, shown
from rl_tui.common.text_file import UnreadableError, read_bytes
from rl_tui.programs.own_agents.binding import (
    CHOOSING,
    LEARNING,
    OF_FUNCTION,
    OF_LEARNING,
    SHAPE_OF,
    AgentShape,
    Style,
    role_of,
    shape_with,
    shapes_in_words,
    style_of_methods,
)

_DEEPEST: Final = 8
_MOST_NAMED: Final = 6
_Function = ast.FunctionDef | ast.AsyncFunctionDef
_DEFINITIONS: Final = (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


class AgentPlace(NamedTuple):
    """An agent in a file, with the unusual names of its methods if any."""

    name: str
    style: Style
    line: int
    methods: tuple[str, str] | None = None

    @property
    def shape(self) -> AgentShape:
        """Its shape, with those names."""
        return SHAPE_OF[self.style] if self.methods is None else shape_with(*self.methods)


class AgentName(NamedTuple):
    """Parts of `FILE.py[:NAME]`. `name` may be empty."""

    path: Path
    name: str

    @classmethod
    def read(cls, text: str) -> AgentName:
        """Parse `text`. Only a colon after `.py` separates the name."""
        path, colon, name = text.rpartition(".py:")
        return cls(Path(f"{path}.py"), name) if colon else cls(Path(text), "")


def agents_in(tree: ast.Module, folder: Path) -> list[AgentPlace]:
    """Return the concrete agents in a file, in order.

    Bare functions count only without an agent's class, and without an environment, because they belong to a
    script there.
    """
    found = (_place_of(each, tree, folder) for each in _classes(tree))
    classes = [each for each in found if each is not None]
    if classes or makes_environment(tree):
        return classes
    functions = (each for each in tree.body if isinstance(each, ast.FunctionDef))
    return [
        AgentPlace(each.name, Style.FUNCTION, each.lineno) for each in functions if _is_update_function(each)
    ]


def the_agent(tree: ast.Module, path: Path, name: str = "") -> AgentPlace:
    """Return the agent `name`, the only one for "". Raises UserError if there is none or several."""
    file, places = shown(path.name), agents_in(tree, path.parent)
    if name:
        named = _named(tree, path.parent, name)
        if named is not None:
            return named
        others = [each.name for each in tree.body if isinstance(each, (ast.ClassDef, ast.FunctionDef))]
        if name in others:
            raise UserError(f"{file}: {shown(name)} is not an agent. {shapes_in_words()}")
        raise UserError(f"{file}: there is no {shown(name)}{near(name, others)}")
    if len(places) == 1:
        return places[0]
    if places:
        names = ", ".join(each.name for each in places[:_MOST_NAMED])
        raise UserError(
            f"{file} has several agents ({names}); choose one, as in {path.name}:{places[0].name}"
        )
    raise UserError(f"{file}: found no agent. {shapes_in_words()}")


def runs_when_imported(tree: ast.Module) -> bool:
    """Return True if importing the file would take steps.

    It makes an environment on import, or loops on import and makes one somewhere. Code below a test of
    `__name__` does not count.
    """
    run = [each for each in tree.body if not (isinstance(each, _DEFINITIONS) or _asks_for_name(each))]
    if any(makes_environment(each) for each in run):
        return True
    loops = any(isinstance(each, (ast.For, ast.While)) for top in run for each in ast.walk(top))
    return loops and makes_environment(tree)


def load_module(code: CodeType, path: Path) -> ModuleType:
    """Run a file as a module named after it.

    Guarded loops do not run, and modules in its folder can be imported. Raises any exception of the file.
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


def _place_of(node: ast.ClassDef, tree: ast.Module, folder: Path) -> AgentPlace | None:
    methods = _methods(node, tree, folder, _DEEPEST)
    style = style_of_methods(frozenset(methods))
    if style is not None:
        place = AgentPlace(node.name, style, node.lineno)
    else:
        choose = next((name for name in CHOOSING if name in methods), None)
        update = next(
            (name for name in LEARNING if name in methods and _has_roles(methods[name], OF_LEARNING)), None
        )
        if choose is None or update is None:
            return None
        place = AgentPlace(node.name, Style.GYMNASIUM, node.lineno, (choose, update))
    return None if any(_is_abstract(methods[name]) for name in place.shape.methods) else place


def _has_roles(function: _Function, wanted: Iterable[str]) -> bool:
    parameters = (*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs)
    return {role_of(each.arg) for each in parameters}.issuperset(wanted)


def _methods(node: ast.ClassDef, tree: ast.Module, folder: Path, deepest: int) -> dict[str, _Function]:
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
        return None  # its error is reported when it is imported


def _is_abstract(method: _Function) -> bool:
    if any(_last_name(each) == "abstractmethod" for each in method.decorator_list):
        return True
    last = method.body[-1]
    raised = last.exc if isinstance(last, ast.Raise) else None
    return _last_name(raised.func if isinstance(raised, ast.Call) else raised) == "NotImplementedError"


def _last_name(node: ast.AST | None) -> str:
    return node.attr if isinstance(node, ast.Attribute) else getattr(node, "id", "")


def _named(tree: ast.Module, folder: Path, name: str) -> AgentPlace | None:
    for each in tree.body:
        if isinstance(each, ast.ClassDef) and each.name == name:
            return _place_of(each, tree, folder)
        if isinstance(each, ast.FunctionDef) and each.name == name and _has_roles(each, OF_FUNCTION):
            return AgentPlace(name, Style.FUNCTION, each.lineno)
    return None


def _is_update_function(node: ast.FunctionDef) -> bool:
    return ("update" in node.name.lower() or "learn" in node.name.lower()) and _has_roles(node, OF_FUNCTION)


def _asks_for_name(node: ast.stmt) -> bool:
    return isinstance(node, ast.If) and any(_last_name(each) == "__name__" for each in ast.walk(node.test))


def makes_environment(tree: ast.AST) -> bool:
    """Return True if `make` is called anywhere."""
    return any(_last_name(each.func) == "make" for each in ast.walk(tree) if isinstance(each, ast.Call))
