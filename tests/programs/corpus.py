"""The programs written for tests, faulty or correct, with their expected findings."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Final

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.evidence.verdict import CodeFinding, ProgramVerdict
from rl_tui.programs.watched.program_log import ProgramLog
from rl_tui.programs.watched.program_process import ProgramRequest, watched_to_the_end

SCRIPTS: Final = Path(__file__).parent / "scripts"
FAULTY: Final = sorted((SCRIPTS / "faulty").glob("*.py"))
CORRECT: Final = sorted((SCRIPTS / "correct").glob("*.py"))


def expected(script: Path, what: str = "expect") -> Any:
    """Return the value of the line ``# WHAT: JSON`` at the top of ``script``, or None without that line."""
    for line in script.read_text(encoding="utf-8").splitlines():
        if not line.startswith("#"):
            return None
        name, _, value = line.removeprefix("#").partition(":")
        if name.strip() == what:
            return json.loads(value)
    return None


def watched(script: Path, seed: int) -> tuple[ProgramLog, ProgramVerdict]:
    """Return the messages of ``script`` and the findings about it."""
    log = watched_to_the_end(ProgramRequest(script, seed=seed))
    return log, verdict_of(log)


def line_of(finding: CodeFinding) -> str:
    """Return the source line that a finding names, or an empty text."""
    if finding.line is None:
        return ""
    return Path(finding.file).read_text(encoding="utf-8").splitlines()[finding.line - 1].strip()
