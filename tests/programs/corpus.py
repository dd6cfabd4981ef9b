"""The faulty and correct programs of tests."""

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
    """Return the value of the line ``# WHAT: JSON`` at the top of ``script``, or None."""
    for line in script.read_text(encoding="utf-8").splitlines():
        if not line.startswith("#"):
            return None
        name, _, value = line.removeprefix("#").partition(":")
        if name.strip() == what:
            return json.loads(value)
    return None


def watched(script: Path, seed: int) -> tuple[ProgramLog, ProgramVerdict]:
    log = watched_to_the_end(ProgramRequest(script, seed=seed))
    return log, verdict_of(log)


def line_of(finding: CodeFinding) -> str:
    if finding.line is None:
        return ""
    return Path(finding.file).read_text(encoding="utf-8").splitlines()[finding.line - 1].strip()
