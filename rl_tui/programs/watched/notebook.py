"""A Jupyter notebook as a script, with the line numbers of its file."""

from __future__ import annotations

import json
import re
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from functools import lru_cache
from operator import ne
from pathlib import Path
from typing import Any, Final, NamedTuple

from rl_tui.common.errors import UserError
from rl_tui.common.findings import printable
from rl_tui.common.limits import LARGEST_NOTEBOOK
from rl_tui.common.text_file import UnreadableError, read_text

SUFFIX: Final = ".ipynb"
_KIND: Final = "a notebook"
_OF_PYTHON: Final = re.compile(r"%%(time|timeit|capture|prun)\b")
"""First line of a cell with Python below it. A cell with another one is in another language."""
_NO_PYTHON: Final = re.compile(r"^(\s*)(?:[\w.]+\s*=\s*[!%].*|\?{1,2}[\w.]+|[\w.]+\?{1,2})\s*$")
"""A line such as `files = !ls` or `help?`."""


class CodeCell(NamedTuple):
    """A code cell: its number, from 1, the line of the script before it, and its Python."""

    number: int
    before: int
    code: tuple[str, ...] = ()


class Notebook(NamedTuple):
    """A notebook's script, its cells, and the number of skipped lines."""

    text: str
    cells: tuple[CodeCell, ...]
    skipped: int

    def place(self, line: int) -> tuple[CodeCell, int]:
        """Return a line's cell, and the line in it."""
        found = bisect_right([each.before for each in self.cells], line - 1) - 1
        cell = self.cells[max(found, 0)] if self.cells else CodeCell(1, 0)
        return cell, line - cell.before

    def place_in_words(self, line: int) -> str:
        """Return "cell 5, line 3"."""
        cell, within = self.place(line)
        return f"cell {cell.number}, line {within}"


def is_notebook(file: str | Path) -> bool:
    """Recognize a notebook by its name."""
    return str(file).endswith(SUFFIX)


def read_notebook(path: Path) -> Notebook:
    """Return a notebook's script. Raises UserError if it has no readable Python."""
    name = printable(str(path))
    try:
        return _script(read_text(path, _KIND, LARGEST_NOTEBOOK))
    except UnreadableError as reason:
        raise UserError(f"{name}: {reason}") from reason
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        raise UserError(f"{name}: not a Jupyter notebook in Python; choose another file") from error


def cell_of(file: str, line: int) -> tuple[int, int] | None:
    """Return the cell and its line, None without a notebook."""
    if not is_notebook(file):
        return None
    try:
        cell, within = _known(file, Path(file).stat().st_mtime_ns).place(line)
    except (OSError, UserError, ValueError):
        return None
    return cell.number, within


def place_in_words(file: str, line: int) -> str:
    """Return "line 57", or "cell 5, line 3"."""
    found = cell_of(file, line)
    return f"line {line}" if found is None else f"cell {found[0]}, line {found[1]}"


@lru_cache(maxsize=4)
def _known(file: str, changed: int) -> Notebook:
    del changed  # a new key after each save
    return read_notebook(Path(file))


def _script(raw: str) -> Notebook:
    document = json.loads(raw)
    language = document.get("metadata", {}).get("kernelspec", {}).get("language", "python")
    if language != "python":
        raise ValueError(language)
    search = _LinesOfFile(raw)
    lines: list[str] = []
    cells: list[CodeCell] = []
    skipped = 0
    for number, (kind, source) in enumerate(_cells(document), 1):
        begin = search.find(source, len(lines))
        if kind != "code":
            continue
        code, left_out = _python(source)
        skipped += left_out
        lines += [""] * (begin - len(lines))
        cells.append(CodeCell(number, begin, tuple(code)))
        lines += code
    return Notebook("\n".join(lines) + "\n", tuple(cells), skipped)


def _cells(document: Any) -> Iterator[tuple[str, list[str]]]:
    """Yield the kind and the lines of each cell, also of notebooks before 2015."""
    found = document.get("cells")
    if found is None:
        found = [each for sheet in document["worksheets"] for each in sheet["cells"]]
    for cell in found:
        source = cell.get("source", cell.get("input", ""))
        text = source if isinstance(source, str) else "".join(source)
        yield cell["cell_type"], text.removesuffix("\n").split("\n")


def _python(source: Sequence[str]) -> tuple[list[str], int]:
    first = next((place for place, line in enumerate(source) if line.strip()), 0)
    is_magic = source[first].lstrip().startswith("%%")
    if is_magic and not _OF_PYTHON.match(source[first].lstrip()):
        return [""] * len(source), len(source)
    code = [_NO_PYTHON.sub(r"\1pass", line) for line in source]
    if is_magic:
        code[first] = "pass"
    return code, sum(map(ne, code, source))


class _LinesOfFile:
    def __init__(self, raw: str) -> None:
        self._lines = [each.strip().removesuffix(",") for each in raw.split("\n")]
        self._next = 0

    def find(self, source: Sequence[str], least: int) -> int:
        *whole, last = source
        for ascii_only in (False, True):
            wanted = [json.dumps(f"{line}\n", ensure_ascii=ascii_only) for line in whole]
            wanted.append(json.dumps(last, ensure_ascii=ascii_only))
            for begin in range(self._next, len(self._lines) - len(wanted) + 1):
                if self._lines[begin : begin + len(wanted)] == wanted and begin >= least:
                    self._next = begin + len(wanted)
                    return begin
        return least
