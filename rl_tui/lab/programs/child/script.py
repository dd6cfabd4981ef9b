"""Running a script as Python would, with its file, its arguments and its folder."""

from __future__ import annotations

import builtins
import sys
import threading
from collections.abc import Callable, Sequence
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import ModuleType

from rl_tui.common.findings import one_line
from rl_tui.common.words import counted
from rl_tui.lab.programs.child.source import Script

_LONGEST_STATUS = 200


def run_script(script: Script, path: Path, arguments: Sequence[str], note: Callable[[str], None]) -> None:
    """Run ``script``, read from ``path``, as the module ``__main__``; ``note`` tells what was done otherwise.

    Also waits for the threads that it leaves behind. Raises what the script raises, but for SystemExit, which
    is an end like any other.
    """
    file = path.absolute()
    if script.notebook_lines:
        what = counted(script.notebook_lines, "line")
        note(f"{what} of a notebook, with ! or %, {'is' if script.notebook_lines == 1 else 'are'} skipped")
    sys.argv = [str(path), *arguments]
    sys.path.insert(0, str(file.parent))
    module = _main_module(file)
    sys.modules["__main__"] = module
    try:
        exec(script.code, module.__dict__)
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
    """Tell how the script ended itself, where that was not simply the end."""
    if isinstance(status, str):
        print(status, file=sys.stderr)  # as Python does
    if status is not None and status != 0:
        note(f"the script ended itself with sys.exit({one_line(ascii(status), _LONGEST_STATUS)})")
