"""What a learner's program has come to once it was watched to its end."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

from rl_tui.common.findings import one_line
from rl_tui.lab.detective.source.code_places import program_code
from rl_tui.lab.detective.step_story import update_of_step
from rl_tui.lab.detective.verdict import CodeFinding, ProgramVerdict, Rule, step_number
from rl_tui.lab.grading.watch_report import environment_of, episodes_of, error_of, learned_figures
from rl_tui.lab.programs.program_log import ProgramError, ProgramLog

_LONGEST: Final = 900
_MOST_REMARKS: Final = 8


@dataclass(frozen=True, slots=True)
class SeenProgram:
    """What was seen of a program: the ``verdict`` of the detective, and how far it went.

    ``environment`` is the id of the one that its table belongs to, empty without one. ``expected_return`` is
    what the greedy policy of its table earns, undiscounted; None where that is not known. ``error`` is what
    kept it from its end, in a line; empty where nothing did. ``remarks`` are sentences for its author: where
    it departs from its rule, what is wrong and how to mend it, each with its line.
    """

    verdict: ProgramVerdict = field(default_factory=ProgramVerdict)
    steps: int = 0
    episodes: int = 0
    environment: str = ""
    expected_return: float | None = None
    error: str = ""
    remarks: tuple[str, ...] = ()


def seen_program(log: ProgramLog, verdict: ProgramVerdict) -> SeenProgram:
    """Return what the program that told ``log`` has come to."""
    environment, error = environment_of(log), error_of(log)
    remarks = [*_departure(log, verdict), *(_of_finding(each) for each in verdict.findings)]
    if error is None:  # what is not known of half a program is no news
        remarks += verdict.notes
    remarks += log.notes
    return SeenProgram(
        verdict,
        log.recording.count,
        episodes_of(log),
        "" if environment is None else environment.id,
        learned_figures(log, verdict.update.gamma).expected_return,
        "" if error is None else _in_a_line(error),
        tuple(one_line(each, _LONGEST) for each in dict.fromkeys(remarks))[:_MOST_REMARKS],
    )


def _in_a_line(error: ProgramError) -> str:
    place = "" if error.line is None else f"line {error.line}: "
    return one_line(f"{place}{error.type}: {error.text}", _LONGEST)


def _of_finding(finding: CodeFinding) -> str:
    place = "" if finding.line is None else f"line {finding.line}: "
    return f"{place}{finding.text.rstrip('.')}. Mend it: {finding.correction.rstrip('.')}."


def _departure(log: ProgramLog, verdict: ProgramVerdict) -> list[str]:
    """Return, as one sentence if any, the first step that the rule found does not explain."""
    update = verdict.update
    if update.rule is Rule.UNKNOWN or update.departs_at is None:
        return []
    code = program_code(log).update_line()
    place = "" if code is None else f"line {code.line}: "
    step = step_number(update.departs_at)
    try:
        moved = update_of_step(log.recording, update, update.departs_at).moved
    except ValueError:  # the step is kept no more
        moved = ()
    actions = max(1, log.recording.actions)
    cells = ", ".join(
        f"Q({each.cell // actions}, {each.cell % actions}) from {each.before:.4g} to {each.after:.4g}"
        for each in moved[:3]
    )
    what = f"moved {cells}" if cells else "moved nothing"
    return [f"{place}step {step:,} {what}, which {update.rule.value} does not explain."]
