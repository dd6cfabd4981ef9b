"""Safe reading of TOML files written by people."""

from __future__ import annotations

import re
import tomllib
from typing import Any, Final

from rl_tui.common.findings import one_line
from rl_tui.common.limits import (
    LONGEST_WORD,
    MOST_KEY_PARTS,
    MOST_NAMED_TABLES,
    MOST_TABLES,
    MOST_VALUES,
)
from rl_tui.common.text_file import UnreadableError

# Strings and comments, which have no structure. Unterminated ones match too: searching on from every quote
# would take quadratic time. No alternation is repeated possessively: before 3.11.5 Python matched too much
# there (python/cpython #106052)
_NO_STRUCTURE: Final = re.compile(
    r""""{3}.*?(?:(?<!\\)(?:\\\\)*+"{3,5}|\Z)|'{3}.*?(?:'{3,5}|\Z)"""
    r"""|"[^"\\\n]*+(?:\\.[^"\\\n]*+)*+"?|'[^'\n]*+'?|\#[^\n]*+""",
    re.DOTALL,
)
_UNCLOSED: Final = ("Unterminated string", "Expected \"'''\"")  # a string's end is missing
_HEADER: Final = re.compile(r"^[ \t]*\[(?!\[)[^\[\]{},=\n]*\][ \t]*s?\r?$", re.MULTILINE)
_LIST_HEADER: Final = re.compile(r"""^[ \t]*\[\[(?:"[^"\n]*+"|'[^'\n]*+'|[^\]"'\n]++)*+\]\]""", re.MULTILINE)
_FLOAT: Final = re.compile(r"(?<![\w.-])[-+]?\d[\d_]*+\.\d[\d_]*+(?:[eE][-+]?[\d_]++)?(?!\w|[ \t]*[.=-])")
_DECIMAL_COMMA: Final = re.compile(r"(?<![\w.,])[-+]?[0-9]+,[0-9]+(?![\w.])[ \t]*+")
_LONG_KEY: Final = re.compile(rf"(?<![\w-])(?:[\w-]++[ \t]*+\.[ \t]*+){{{MOST_KEY_PARTS}}}")
_LONG_WORD: Final = re.compile(rf"(?<!\w)\w{{{LONGEST_WORD + 1}}}")


def tables_in(text: str) -> dict[str, Any]:
    """Parse `text` as TOML.

    Raises:
        UnreadableError: It is not valid TOML, or exceeds a limit.
    """
    _check_structure(text)
    try:
        return tomllib.loads(text)
    except RecursionError as error:
        raise UnreadableError("", "tables are nested too deeply; use fewer levels") from error
    except ValueError as error:  # not only TOMLDecodeError: a number with 5,000 digits is a plain ValueError
        message, where = _split(str(error), text)
        comma = _decimal_comma(message, where, text)
        if comma is not None:
            raise comma from error
        raise UnreadableError(where, message, "") from error


def _check_structure(text: str) -> None:
    # A quick estimate, since parsing could take minutes and gigabytes
    structure = _NO_STRUCTURE.sub("s", text)
    if _LONG_KEY.search(structure):
        raise UnreadableError("", f"a key has too many parts; use at most {MOST_KEY_PARTS} parts, a.b.c")
    if _LONG_WORD.search(structure):
        raise UnreadableError("", f"a number or key is too long; use at most {LONGEST_WORD:,} characters")
    # an inline table has a comma per key, a table two brackets
    values = max(structure.count("="), structure.count(",")) + structure.count("[") // 2
    if values > MOST_VALUES:
        raise UnreadableError("", f"about {values:,} values", f"at most {MOST_VALUES:,}")
    named = len(_HEADER.findall(structure)) + len(set(_LIST_HEADER.findall(text)))
    if named > MOST_NAMED_TABLES:
        expected = f"at most {MOST_NAMED_TABLES:,} (a list of tables counts as one)"
        raise UnreadableError("", f"{named:,} tables", expected)
    # all parts of a key except the last are tables; [[mdp.transition]] has one per entry
    parts = structure.count(".") - sum(1 for _ in _FLOAT.finditer(structure))
    tables = named + structure.count("{") + max(parts, structure.count("[["))
    if tables > MOST_TABLES:
        raise UnreadableError("", f"about {tables:,} tables", f"at most {MOST_TABLES:,}")


def _decimal_comma(message: str, place: str, text: str) -> UnreadableError | None:
    match = re.fullmatch(r"line (\d+), column (\d+)", place)
    if match is None or not re.search("Expected (newline|'=')|Unclosed array", message):
        return None
    line, column = text.split("\n")[int(match[1]) - 1], int(match[2]) - 1
    for number in _DECIMAL_COMMA.finditer(line):
        if number.start() < column <= number.end():
            whole, _, part = number[0].rstrip().partition(",")
            thousands = f", or {whole}{part} without a comma" if len(part) == 3 else ""
            return UnreadableError(
                place, number[0].rstrip(), f"{whole}.{part}, with a decimal point{thousands}"
            )
    return None


def _split(message: str, text: str) -> tuple[str, str]:
    match = re.fullmatch(r"(.*) \(at (line \d+, column \d+|end of document)\)", message, re.DOTALL)
    if match is None:
        return f"not valid TOML ({one_line(message, 200)})", ""
    where = match[2]
    if where == "end of document":
        place = len(text.rstrip("\n"))
        if match[1] in _UNCLOSED:
            place = max(each.start() for each in _NO_STRUCTURE.finditer(text))
        where = f"line {text.count(chr(10), 0, place) + 1}"
    return f"not valid TOML ({one_line(match[1], 200)})", where
