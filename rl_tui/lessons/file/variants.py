"""Variants of a lesson: other numbers for each learner."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, Final

from rl_tui.common.findings import near, shown
from rl_tui.common.text_file import UnreadableError
from rl_tui.lessons.file.schema import LONGEST_LESSON

_NAMED: Final = re.compile(r"\$\{([a-z][a-z0-9_-]*)\}")
MOST_VARIANTS: Final = 1_000


def variants_of(raw: Mapping[str, Any]) -> tuple[str, ...]:
    """Return names from "1" on, if any. Raises UnreadableError for lists of unequal length."""
    table = raw.get("variants")
    if not isinstance(table, dict) or not table:
        return ()
    lists = [value for value in table.values() if isinstance(value, list)]
    lengths = {len(each) for each in lists}
    if len(lists) != len(table) or len(lengths) != 1 or not 1 <= min(lengths) <= MOST_VARIANTS:
        expected = f"lists of equal length, 1 to {MOST_VARIANTS:,}: a value for each variant"
        raise UnreadableError("variants", shown(table), expected)
    return tuple(str(number) for number in range(1, lengths.pop() + 1))


def readable(text: str) -> str:
    """Replace each `${name}` by a number, for valid TOML."""
    return _NAMED.sub("0", text)


def variant_text(text: str, raw: Mapping[str, Any], variant: str) -> str:
    """Fill in a variant's values. Raises UnreadableError without any."""
    known = variants_of(raw)
    if variant not in known:
        expected = f"a variant, 1 to {len(known)}"
        raise UnreadableError("variants", shown(variant), expected)
    values = {name: _in_toml(each[known.index(variant)]) for name, each in raw["variants"].items()}
    if len(text) + sum(len(values.get(match[1], "")) for match in _NAMED.finditer(text)) > LONGEST_LESSON:
        found = f"a text that is too long in variant {variant}"
        raise UnreadableError("variants", found, f"at most {LONGEST_LESSON:,} characters")

    def put_in(match: re.Match[str]) -> str:
        if match[1] not in values:
            raise UnreadableError("", match[0], f"a name of [variants]{near(match[1], values)}")
        return values[match[1]]

    return _NAMED.sub(put_in, text)


def _in_toml(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
