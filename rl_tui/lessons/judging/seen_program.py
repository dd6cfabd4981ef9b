"""A learner's program, watched to its end."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line
from rl_tui.common.text_file import UnreadableError, read_text
from rl_tui.lessons.file.schema import LONGEST_PROGRAM
from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.diagnosis.step_story import update_of_step
from rl_tui.programs.evidence.code_places import program_code
from rl_tui.programs.evidence.verdict import CodeFinding, ProgramVerdict, Rule, step_number
from rl_tui.programs.grading.watch_report import environment_of, episodes_of, error_of, learned_figures
from rl_tui.programs.watched.child.script import check_script
from rl_tui.programs.watched.program_log import ProgramError, ProgramLog
from rl_tui.programs.watched.program_process import ProgramRequest, watched_to_the_end

# The result


_LONGEST: Final = 900
_MOST_REMARKS: Final = 8


@dataclass(frozen=True, slots=True)
class SeenProgram:
    """The result of watching a program.

    Attributes:
        environment: Id of the environment of its table, or "".
        expected_return: Undiscounted return of its greedy policy.
        error: The error that stopped it in one line, or "".
        remarks: Sentences for its author, with lines.
    """

    verdict: ProgramVerdict = field(default_factory=ProgramVerdict)
    steps: int = 0
    episodes: int = 0
    environment: str = ""
    expected_return: float | None = None
    error: str = ""
    remarks: tuple[str, ...] = ()


def seen_program(log: ProgramLog, verdict: ProgramVerdict) -> SeenProgram:
    """Summarize the program of `log`."""
    environment, error = environment_of(log), error_of(log)
    remarks = [*_departure(log, verdict), *(_of_finding(each) for each in verdict.findings)]
    if error is None:  # half a program naturally leaves facts unknown
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
    return f"{place}{finding.account}"


def _departure(log: ProgramLog, verdict: ProgramVerdict) -> list[str]:
    update = verdict.update
    if update.rule is Rule.UNKNOWN or update.departs_at is None:
        return []
    code = program_code(log).update_line()
    place = "" if code is None else f"line {code.line}: "
    step = step_number(update.departs_at)
    try:
        moved = update_of_step(log.recording, update, update.departs_at).moved
    except ValueError:  # the step is no longer stored
        moved = ()
    actions = max(1, log.recording.actions)
    cells = ", ".join(
        f"Q({each.cell // actions}, {each.cell % actions}) from {each.before:.4g} to {each.after:.4g}"
        for each in moved[:3]
    )
    what = f"changed {cells}" if cells else "changed nothing"
    return [f"{place}step {step:,} {what}, which {update.rule.value} does not explain."]


# Watching in a separate process


MOST_SECONDS: Final = 60.0
MOST_STEPS: Final = 500_000
"""Steps after which it is ended and judged."""
MOST_MEMORY: Final = 2048 * 2**20
_LONGEST_ERROR: Final = 400

OnSteps = Callable[[int, int], None]
"""Called with the number of steps taken and episodes begun."""


def read_code(path: Path) -> str:
    """Read a program. Raises UserError, in one line."""
    try:
        code = read_text(path, "a Python file")
    except UnreadableError as reason:
        place = f"{path.name}, {reason.place}" if reason.place else path.name
        raise UserError(f"{place}: {reason}") from reason
    if len(code) > LONGEST_PROGRAM:
        raise UserError(
            f"{path.name}: found {len(code):,} characters; expected a program of at most {LONGEST_PROGRAM:,}"
        )
    return code


def watched_code(
    code: str, name: str, on_steps: OnSteps = lambda steps, episodes: None, seconds: float = MOST_SECONDS
) -> SeenProgram:
    """Run `code` in a temporary folder and watch it.

    `seconds` is a limit besides 500,000 steps and 2 GB of memory.
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
        except Exception as fault:  # a program may send anything
            text = f"its result cannot be read ({type(fault).__name__}: {fault})"
            return SeenProgram(error=one_line(text, _LONGEST_ERROR))
