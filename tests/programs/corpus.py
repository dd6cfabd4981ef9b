"""The faulty and correct programs of tests: loops, and files that begin with ``# expect: JSON``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Final, NamedTuple

import loops
from watched_scripts import script_in, watched

from rl_tui.programs.evidence.verdict import CodeFinding
from rl_tui.programs.watched.program_log import ProgramLog

SCRIPTS: Final = Path(__file__).parent / "scripts"


class Program(NamedTuple):
    name: str
    expect: Any
    text: str

    @property
    def line(self) -> str:
        """The line of the fault. It ends in ``#!``."""
        return next(each.strip() for each in self.text.splitlines() if each.endswith("  #!"))

    def watched(self, folder: Path, seed: int) -> ProgramLog:
        return watched(script_in(folder, self.text), seed=seed)


def _programs(group: str, written: dict[str, loops.Loop]) -> list[Program]:
    found = [Program(name, loop.expect, loop.text) for name, loop in written.items()]
    for path in (SCRIPTS / group).glob("*.py"):
        text = path.read_text(encoding="utf-8")
        found.append(Program(path.stem, json.loads(text.splitlines()[0].removeprefix("# expect: ")), text))
    return sorted(found)


FAULTY: Final = _programs("faulty", loops.FAULTY)
CORRECT: Final = _programs("correct", loops.CORRECT)


def line_of(finding: CodeFinding) -> str:
    if finding.line is None:
        return ""
    return Path(finding.file).read_text(encoding="utf-8").splitlines()[finding.line - 1].strip()
