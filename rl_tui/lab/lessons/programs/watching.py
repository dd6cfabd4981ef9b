"""Watching the code that a learner wrote to its end, in a process of its own."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line
from rl_tui.common.text_file import UnreadableError, read_text
from rl_tui.lab.detective.detective import verdict_of
from rl_tui.lab.lessons.programs.seen_program import SeenProgram, seen_program
from rl_tui.lab.lessons.schema import LONGEST_PROGRAM
from rl_tui.lab.programs.child.source import check_script
from rl_tui.lab.programs.program_process import ProgramRequest
from rl_tui.lab.programs.to_the_end import watched_to_the_end

MOST_SECONDS: Final = 60.0
MOST_STEPS: Final = 500_000
"""After so many it is ended, and judged by them."""
MOST_MEMORY: Final = 2048 * 2**20
_LONGEST_ERROR: Final = 400

OnSteps = Callable[[int, int], None]
"""Hears how many steps were taken, and how many episodes are begun."""


def read_code(path: Path) -> str:
    """Return the program in a file. Raises UserError, in one line, where there is none."""
    try:
        code = read_text(path, "a Python file")
    except UnreadableError as reason:
        place = f"{path.name}, {reason.place}" if reason.place else path.name
        raise UserError(f"{place}: found {reason.found}; expected {reason.expected}") from reason
    if len(code) > LONGEST_PROGRAM:
        raise UserError(
            f"{path.name}: found {len(code):,} characters; expected a program of at most {LONGEST_PROGRAM:,}"
        )
    return code


def watched_code(
    code: str, name: str, on_steps: OnSteps = lambda steps, episodes: None, seconds: float = MOST_SECONDS
) -> SeenProgram:
    """Return what ``code`` comes to, run from a file called ``name`` in a temporary folder, alone.

    It is ended after ``seconds``, after 500,000 steps, and where it asks for more than 2 GB. What keeps it
    from its end is said in the result.
    """
    with tempfile.TemporaryDirectory(prefix="rl-tui-") as folder:
        path = Path(folder) / Path(name).name
        try:
            path.write_text(code, encoding="utf-8")
            check_script(path)
            log = watched_to_the_end(
                ProgramRequest(path, steps=MOST_STEPS, memory=MOST_MEMORY),
                lambda log: on_steps(log.recording.count, log.episodes),
                seconds,
            )
            return seen_program(log, verdict_of(log))
        except (UserError, OSError) as fault:
            text = str(fault).replace(f"{folder}{os.sep}", "")
            return SeenProgram(error=one_line(text, _LONGEST_ERROR))
        except Exception as fault:  # what a program sends may be anything
            text = f"what came of it cannot be read ({type(fault).__name__}: {fault})"
            return SeenProgram(error=one_line(text, _LONGEST_ERROR))
