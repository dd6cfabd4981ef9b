"""Variants of a lesson: one file with different numbers for each learner of a class."""

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
    """Return the names of the variants, "1" first, or none without a table. Raises UnreadableError if its
    lists differ in length.
    """
    table = raw.get("variants")
    if not isinstance(table, dict) or not table:
        return ()
    lists = [value for value in table.values() if isinstance(value, list)]
    lengths = {len(each) for each in lists}
    if len(lists) != len(table) or len(lengths) != 1 or not 1 <= min(lengths) <= MOST_VARIANTS:
        expected = f"lists of one length, 1 to {MOST_VARIANTS:,}: a value for each variant"
        raise UnreadableError("variants", shown(table), expected)
    return tuple(str(number) for number in range(1, lengths.pop() + 1))


def readable(text: str) -> str:
    """Replace each `${name}` in `text` by a number, so that it is valid TOML."""
    return _NAMED.sub("0", text)


def variant_text(text: str, raw: Mapping[str, Any], variant: str) -> str:
    """Return `text` with the values of `variant`. Raises UnreadableError if there is no such variant."""
    known = variants_of(raw)
    if variant not in known:
        expected = f"a variant, 1 to {len(known)}"
        raise UnreadableError("variants", shown(variant), expected)
    values = {name: _in_toml(each[known.index(variant)]) for name, each in raw["variants"].items()}
    if len(text) + sum(len(values.get(match[1], "")) for match in _NAMED.finditer(text)) > LONGEST_LESSON:
        found = f"a longer text once variant {variant} is put in"
        raise UnreadableError("variants", found, f"at most {LONGEST_LESSON:,} characters")

    def put_in(match: re.Match[str]) -> str:
        if match[1] not in values:
            raise UnreadableError("", match[0], f"a name of [variants]{near(match[1], values)}")
        return values[match[1]]

    return _NAMED.sub(put_in, text)


def _in_toml(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
