"""What is wrong with a program: each told only from steps that tell two hypotheses apart."""

from __future__ import annotations

from rl_tui.lab.detective.evidence import Evidence
from rl_tui.lab.detective.verdict import Finding, UpdateFound
from rl_tui.lab.programs.program_log import ProgramLog


def findings_of(
    evidence: Evidence, update: UpdateFound, log: ProgramLog
) -> tuple[tuple[Finding, ...], tuple[str, ...]]:
    """Return the findings about the program of ``log`` and the notes on what cannot be told."""
    del evidence, update, log
    return (), ()
