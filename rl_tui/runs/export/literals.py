"""Python literals as a person would write them."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterable, Mapping
from typing import Any, Final

WIDEST: Final = 96
_INDENT: Final = "    "


def literal(value: object) -> str:
    """Format `value` in Python, with double quotes."""
    if isinstance(value, bool) or value is None:
        return repr(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{literal(key)}: {literal(each)}" for key, each in value.items()) + "}"
    if isinstance(value, tuple):
        inside = ", ".join(map(literal, value))
        return f"({inside},)" if len(value) == 1 else f"({inside})"
    if isinstance(value, list):
        return "[" + ", ".join(map(literal, value)) + "]"
    return repr(value)


def listed(items: Iterable[str], opening: str = "[", closing: str = "]", before: str = "") -> str:
    """Format `before` and a list, on one line or one item per line."""
    items = list(items)
    line = f"{before}{opening}{', '.join(items)}{closing}"
    if len(line) <= WIDEST:
        return line
    return "\n".join([f"{before}{opening}", *(f"{_INDENT}{item}," for item in items), closing])


def packed(items: Iterable[str], before: str) -> str:
    """Format `before` and a list with many items per line."""
    items = list(items)
    line = f"{before}[{', '.join(items)}]"
    if len(line) <= WIDEST:
        return line
    lines = textwrap.wrap(
        ", ".join(items) + ",",
        WIDEST - 1,
        initial_indent=_INDENT,
        subsequent_indent=_INDENT,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return "\n".join([f"{before}[", *lines, "]"])


def table(entries: Mapping[str, Any], before: str) -> str:
    """Format `before` and a dictionary of literals."""
    items = (f"{literal(key)}: {literal(value)}" for key, value in entries.items())
    return listed(items, "{", "}", before)
