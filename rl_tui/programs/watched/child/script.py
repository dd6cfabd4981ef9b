"""A user's script, run as Python would run it."""

from __future__ import annotations

import ast
import builtins
import io
import linecache
import sys
import threading
import tokenize
import warnings
from collections.abc import Callable, Sequence
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType, ModuleType
from typing import Final, NamedTuple

from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line, printable, shown
from rl_tui.common.text_file import UnreadableError, read_bytes
from rl_tui.common.words import counted
from rl_tui.programs.watched.notebook import is_notebook, place_in_words, read_notebook

# Reading the source


_LONGEST_REASON: Final = 120
_MOST_NOTEBOOK_LINES: Final = 500
_OF_NOTEBOOKS: Final = ("!", "%", "pip install ", "conda install ")
"""Beginnings of lines that only a notebook understands."""
_NOT_PYTHON: Final = (SyntaxError, ValueError, RecursionError, MemoryError, OverflowError)


class Script(NamedTuple):
    """A script, its syntax `tree`, and the number of skipped notebook lines."""

    path: Path
    text: str
    tree: ast.Module
    notebook_lines: int

    def compiled(self) -> CodeType:
        """Return the code of the tree as it is now."""
        return compile(self.tree, str(self.path.absolute()), "exec", dont_inherit=True)


def read_script(path: Path) -> Script:
    """Read a script or notebook, with `pass` for notebook lines that begin with `!` or `%`.

    Raises UserError, in one line, if the file is missing, or not Python.
    """
    notebook = read_notebook(path) if is_notebook(path) else None
    text = source_of(path) if notebook is None else notebook.text
    try:
        tree, text, count = parsed(text, str(path.absolute()))
        if notebook is not None:
            count += notebook.skipped
            _show_in_tracebacks(path, text)
        script = Script(path, text, tree, count)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # they appear when the script is compiled to run
            script.compiled()  # it finds mistakes that the parser does not
        return script
    except _NOT_PYTHON as error:
        raise UserError(_fault(path, error)) from error


def _show_in_tracebacks(path: Path, text: str) -> None:
    name = str(path.absolute())
    linecache.cache[name] = (len(text), None, text.splitlines(keepends=True), name)


def check_script(path: Path) -> None:
    """Raise UserError for an invalid script, without printing anything."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # they belong to the script, and appear when it runs
        read_script(path)


def source_of(path: Path) -> str:
    """Return a script's Python. Raises UserError if it cannot be read."""
    if is_notebook(path):
        return read_notebook(path).text
    name = printable(str(path))
    try:
        content, _ = read_bytes(path, "a Python file")
    except UnreadableError as reason:
        raise UserError(f"{name}: {reason}") from reason
    try:
        return io.IncrementalNewlineDecoder(None, translate=True).decode(_decoded(content))
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise UserError(
            f"{name}, line {line}: byte {content[error.start]:#04x} is not {error.encoding}; declare "
            "the encoding in the first line, such as # -*- coding: latin-1 -*-"
        ) from error
    except (SyntaxError, LookupError) as error:
        raise UserError(f"{name}: {one_line(str(error), _LONGEST_REASON)}") from error


def _decoded(content: bytes) -> str:
    """Decode with the encoding in the first lines, UTF-8 by default (PEP 263)."""
    try:
        encoding, _ = tokenize.detect_encoding(io.BytesIO(content).readline)
    except SyntaxError:
        content.decode("utf-8-sig")  # its error names the byte, if the encoding is wrong
        raise
    return content.decode(encoding)


def parsed(text: str, file: str) -> tuple[ast.Module, str, int]:
    """Return tree, parsed text and number of skipped notebook lines. Raises any exception of the parser.

    Lines are skipped only where Python fails, because a line with `%` may continue a calculation or a string.
    """
    lines: list[str] = []
    count = 0
    while True:
        try:
            return ast.parse(text, file), text, count
        except SyntaxError as error:
            lines = lines or text.split("\n")
            place = (error.lineno or 0) - 1
            if not 0 <= place < len(lines):
                raise
            error.text = lines[place]  # the parser reads it from the file, which may be a notebook
            if count >= _MOST_NOTEBOOK_LINES or not lines[place].lstrip().startswith(_OF_NOTEBOOKS):
                raise
            count += _leave_out(lines, place)
            text = "\n".join(lines)


def loaded_tree(file: str) -> ast.Module | None:
    """Return the syntax tree of a file that Python has read, or None."""
    try:
        return parsed("".join(linecache.getlines(file)), file)[0]
    except _NOT_PYTHON:
        return None


def _leave_out(lines: list[str], place: int) -> int:
    first, line = place, lines[place]
    indent = line[: len(line) - len(line.lstrip())]
    while True:
        goes_on = lines[place].rstrip().endswith("\\") and place + 1 < len(lines)
        lines[place] = f"{indent}pass"
        place += 1
        if not goes_on:
            return place - first


def _fault(path: Path, error: Exception) -> str:
    name = printable(str(path))
    if isinstance(error, SyntaxError) and error.lineno:
        what = one_line(error.msg or "invalid syntax", _LONGEST_REASON)
        line = f" in {shown(error.text.strip())}" if error.text else ""
        return f"{name}, {place_in_words(str(path), error.lineno)}: {what}{line}"
    if isinstance(error, RecursionError | MemoryError):
        return f"{name}: is nested too deeply for Python"
    return f"{name}: {one_line(str(error), _LONGEST_REASON)}"


# Running it


_LONGEST_STATUS = 200


def run_script(script: Script, arguments: Sequence[str], note: Callable[[str], None]) -> None:
    """Run `script` as `__main__`, wait for its threads, and `note` workarounds.

    Raises any exception of the script, except SystemExit, which is a normal end.
    """
    file = script.path.absolute()
    if script.notebook_lines:
        what = counted(script.notebook_lines, "line")
        note(f"{what} that only notebooks understand {'is' if script.notebook_lines == 1 else 'are'} skipped")
    sys.argv = [str(script.path), *arguments]
    sys.path.insert(0, str(file.parent))
    module = _main_module(file)
    sys.modules["__main__"] = module
    try:
        exec(script.compiled(), module.__dict__)
    except SystemExit as end:
        _tell_status(end.code, note)
    for thread in threading.enumerate():
        if thread is not threading.current_thread() and not thread.daemon:
            thread.join()


def _main_module(file: Path) -> ModuleType:
    module = ModuleType("__main__")
    module.__dict__.update(
        __file__=str(file),
        __builtins__=builtins,
        __loader__=SourceFileLoader("__main__", str(file)),
        __cached__=None,
        __annotations__={},
    )
    return module


def _tell_status(status: object, note: Callable[[str], None]) -> None:
    if isinstance(status, str):
        print(status, file=sys.stderr)  # as Python does
    if status is not None and status != 0:
        note(f"the script ended itself with sys.exit({one_line(ascii(status), _LONGEST_STATUS)})")
