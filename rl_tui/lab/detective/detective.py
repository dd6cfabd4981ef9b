"""What can be said of a program, from all that it has told so far."""

from __future__ import annotations

import numpy as np

from rl_tui.lab.detective.evidence import Evidence
from rl_tui.lab.detective.findings import findings_of, findings_without_table
from rl_tui.lab.detective.notes import note_on_other_worlds
from rl_tui.lab.detective.update_rule import update_of
from rl_tui.lab.detective.verdict import ProgramVerdict
from rl_tui.lab.programs.program_log import ProgramLog


def verdict_of(log: ProgramLog) -> ProgramVerdict:
    """Return the verdict on the program that told ``log``; it claims nothing that steps do not prove."""
    if log.table is None or log.recording.initial is None:
        return ProgramVerdict(findings=findings_without_table(log))
    is_either = log.agent is not None and log.agent.done_is_either
    with np.errstate(all="ignore"):  # somebody's table may hold anything
        evidence = Evidence(log.recording)
        update = update_of(evidence, log.numbers, log.table.dtype)
        findings, notes = findings_of(evidence, update, log, done_is_either=is_either)
    return ProgramVerdict(update, findings, (*notes, *note_on_other_worlds(log)))
