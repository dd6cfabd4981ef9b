"""Values and tables of a scenario file, written in the style of the shipped ones."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

from rl_tui.worlds.grid.map import lines_of

_THREE: Final = ("'''", '"""')
_LINE_ENDS: Final = re.compile(r"\A(\n*).*?(\n*)\Z", re.DOTALL)


def value_text(value: Any) -> str:
    """Return a value of TOML on one line."""
    import tomlkit

    if isinstance(value, Mapping):
        inside = ", ".join(f"{key_text(key)} = {value_text(each)}" for key, each in value.items())
        return f"{{ {inside} }}" if inside else "{}"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(value_text, value))}]"
    return str(tomlkit.item(value).as_string())


def key_text(key: str) -> str:
    """Return a key as TOML wants it, in quotes where it has to be."""
    import tomlkit

    return tomlkit.key(key).as_string()


def map_text(lines: Sequence[str], like: str = "") -> str:
    """Return a map as a string of TOML, quoted as the one that is written ``like`` that if it can be.

    Else it is a block of lines between three quotes.
    """
    return next(each for each in _map_texts(lines, like) if _says(each, lines))


def _says(text: str, lines: Sequence[str]) -> bool:
    try:
        return lines_of(tomllib.loads(f"map = {text}")["map"]) == list(lines)
    except tomllib.TOMLDecodeError:
        return False


def _map_texts(lines: Sequence[str], like: str) -> Iterator[str]:
    quotes = like[:3]
    if quotes in _THREE:
        inside = like[3:-3]
        ends = _LINE_ENDS.match(inside)
        assert ends is not None  # whatever it is
        yield quotes + ends[1] + "\n".join(lines) + ends[2] + quotes
    elif like:
        before = tomllib.loads(f"map = {like}")["map"]
        if len(lines_of(before)) == len(lines):
            text = before.replace(before.strip("\n"), "\n".join(lines))
            yield like[0] + text + like[0]
            yield value_text(text)
    block = "\n".join(lines)
    for three in _THREE:
        yield f"{three}\n{block}\n{three}"
    yield value_text(f"{block}\n")


def section_text(kind: str, table: Mapping[str, Any]) -> str:
    """Return the table ``kind`` of a scenario file, its own tables below it."""
    tables = {key: value for key, value in table.items() if _is_table_of_its_own(value)}
    parts = [f"[{kind}]\n"]
    for key, value in table.items():
        if key not in tables:
            text = map_text(lines_of(value)) if key == "map" else value_text(value)
            parts.append(f"{key_text(key)} = {text}\n")
    for key, value in tables.items():
        name = f"{kind}.{key_text(key)}"
        if isinstance(value, Mapping):
            parts.append(f"\n[{name}]\n{_lines_text(value)}")
        else:
            parts.extend(f"\n[[{name}]]\n{_lines_text(each)}" for each in value)
    return "".join(parts)


def _is_table_of_its_own(value: Any) -> bool:
    """Return whether ``value`` is a table of tables or lists, or a list of tables."""
    inside = value.values() if isinstance(value, Mapping) else value
    wanted = (Mapping, list) if isinstance(value, Mapping) else Mapping
    is_nested = isinstance(value, (Mapping, list)) and len(value) > 0
    return is_nested and all(isinstance(each, wanted) for each in inside)


def _lines_text(table: Mapping[str, Any]) -> str:
    return "".join(f"{key_text(key)} = {value_text(value)}\n" for key, value in table.items())
