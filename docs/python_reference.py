"""The reference of the Python functions, from their signatures and docstrings."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Callable, Iterator, Sequence
from textwrap import dedent, fill

import rl_tui
from rl_tui.commands.python import results

_ROLE = re.compile(r":(?:class|func):`~?(?P<path>[\w.]+)`")
_SECTION = re.compile(r"^(Args|Returns|Raises):\n", re.MULTILINE)
_ITEM = re.compile(r"^(?P<name>[*\w.]+): (?P<text>.*?)(?=^\S|\Z)", re.MULTILINE | re.DOTALL)


def python_api() -> str:
    """Return all functions of the package and the classes of their results."""
    offered = [getattr(rl_tui, name) for name in rl_tui.__all__]
    functions = sorted((each for each in offered if inspect.isfunction(each)), key=_line)
    shown = [each for each in vars(results).values() if inspect.isclass(each)]
    bases = (results.ShortTable, results.Drawable)
    classes = [each for each in shown if issubclass(each, results.ShortTable) and each not in bases]
    parts = [
        *map(_function, functions),
        *map(_class, classes),
        f"### rl_tui.Error\n\n{_summary(rl_tui.Error)}",
    ]
    return "\n\n".join(parts)


def _line(function: Callable[..., object]) -> tuple[str, int]:
    return function.__module__, inspect.unwrap(function).__code__.co_firstlineno


def _summary(thing: object) -> str:
    return linked(inspect.getdoc(thing) or "")


def _function(function: Callable[..., object]) -> str:
    signature = inspect.signature(function)
    names = [each.replace(annotation=inspect.Parameter.empty) for each in signature.parameters.values()]
    call = fill(
        f"rl_tui.{function.__name__}{signature.replace(parameters=names, return_annotation=signature.empty)}",
        80,
        subsequent_indent="    ",
    )
    summary, *sections = _SECTION.split(inspect.getdoc(function) or "")
    parts = [f"### rl_tui.{function.__name__}", f"```text\n{call}\n```", linked(summary.strip())]
    for title, body in zip(sections[::2], sections[1::2], strict=True):
        text = dedent(body).strip()
        items = list(_ITEM.finditer(text)) if title != "Returns" else []
        listed = [_item(f"`{item['name']}`: {linked(_joined(item['text']))}") for item in items]
        parts.append(f"**{title.replace('Args', 'Arguments')}**")
        parts.append("\n".join(listed) if listed else linked(text))
    return "\n\n".join(parts)


def _item(text: str) -> str:
    return fill(f"* {text}", 110, subsequent_indent="  ", break_on_hyphens=False, break_long_words=False)


def _joined(text: str) -> str:
    return " ".join(text.split())


def _class(kind: type) -> str:
    rows = [
        f"| `{name}` | {type_} | {linked(meaning).replace('|', chr(92) + '|')} |"
        for name, type_, meaning in _fields(kind)
    ]
    table = ["| field | type | meaning |", "|---|---|---|", *rows] if rows else []
    blocks = ["\n".join(lines) for lines in (table, list(_methods(kind))) if lines]
    return "\n\n".join([f"### {kind.__name__}", _summary(kind), *blocks])


def _methods(kind: type) -> Iterator[str]:
    """Yield an item for each public method: its call, and the first paragraph of its docstring."""
    for name, method in vars(kind).items():
        if inspect.isfunction(method) and not name.startswith("_"):
            _, *arguments = inspect.signature(method).parameters.values()
            call = ", ".join(str(each.replace(annotation=inspect.Parameter.empty)) for each in arguments)
            summary = (inspect.getdoc(method) or "").split("\n\n")[0]
            yield _item(f"`{name}({call})`: {linked(_joined(summary))}")


def _fields(kind: type) -> Iterator[tuple[str, str, str]]:
    """Yield name, type and meaning of each field: the text below it in the source."""
    [parsed] = ast.parse(dedent(inspect.getsource(kind))).body
    body: Sequence[ast.stmt] = parsed.body if isinstance(parsed, ast.ClassDef) else ()
    for statement, following in zip(body, [*body[1:], ast.Pass()], strict=True):
        if isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name):
            is_text = isinstance(following, ast.Expr) and isinstance(following.value, ast.Constant)
            meaning = _joined(str(following.value.value)) if is_text else ""
            yield statement.target.id, ast.unparse(statement.annotation).replace(" | ", " or "), meaning


def linked(text: str) -> str:
    """Return the text of a docstring as Markdown, with links to what it names."""
    return _ROLE.sub(_link, text).replace("``", "`")


def _link(role: re.Match[str]) -> str:
    path = role["path"] if role["path"].startswith("rl_tui.") and role["path"].count(".") == 1 else ""
    name = path or role["path"].rpartition(".")[2]
    return f"[`{name}`](#{name.replace('.', '').lower()})"
