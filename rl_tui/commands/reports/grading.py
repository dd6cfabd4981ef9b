"""The report of ``grade`` on submissions."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from rl_tui.commands.line.output import columns, number
from rl_tui.common.findings import printable
from rl_tui.common.words import counted
from rl_tui.programs.grading.grade import GradedSubmission, Grading
from rl_tui.programs.own_agents.loading import AgentName

_MOST_ERRORS: Final = 3
_HEAD: Final = ("submission", "", "share of best", "least share", "return", "best return", "failed")


def grades(grading: Grading, graded: Sequence[GradedSubmission]) -> str:
    """Return a table of all submissions, followed by the findings for each."""
    recipe, seeds = grading.recipe, counted(grading.seeds, "seed")
    head = f"{recipe.scenario.title}: {seeds}, {grading.threshold:g} of the best needed"
    rows = [_HEAD, *(_row(each, grading.yardstick.best) for each in graded)]
    parts = [head, "", columns(rows, right=(2, 3, 4, 5, 6))]
    for each in graded:
        remarks = _remarks(each)
        if remarks:
            parts += ["", printable(each.name), *(f"  {line}" for line in remarks)]
    return "\n".join(parts)


def result_line(each: GradedSubmission) -> str:
    """Return the result of one submission as a line."""
    name, verdict, mean, *_, failed = _row(each, 0.0)
    share = "" if each.mean_share is None else f", {mean} of the best"
    return f"{name}: {verdict}{share}" + (
        f", failed in {counted(int(failed.replace(',', '')), 'seed')}" if failed else ""
    )


def _row(each: GradedSubmission, best: float) -> tuple[str, ...]:
    returns = [run.expected_return for run in each.runs if run.expected_return is not None]
    failed = len(each.runs) - len(returns)
    return (
        printable(each.name),
        "passed" if each.passed else "not passed",
        number(each.mean_share, ".4f"),
        number(min(each.shares, default=None), ".4f"),
        number(sum(returns) / len(returns) if returns else None),
        number(best),
        f"{failed:,}" if failed else "",
    )


def _remarks(each: GradedSubmission) -> list[str]:
    of = f"of {len(each.runs):,}"
    lines = []
    for finding, seeds in each.findings:
        place = "" if finding.line is None else f", line {finding.line}{_of_another(finding.file, each.name)}"
        lines.append(f"{finding.noun} in {seeds:,} {of} seeds, {finding.fault}{place}: {finding.account}")
    errors = dict[str, int]()
    for run in each.runs:
        if run.error:
            errors[run.error] = errors.get(run.error, 0) + 1
    lines += [f"error in {count:,} {of} seeds: {text}" for text, count in list(errors.items())[:_MOST_ERRORS]]
    if len(errors) > _MOST_ERRORS:
        lines.append(f"and {len(errors) - _MOST_ERRORS:,} other errors: --json has all")
    endless = sum(not run.error and run.expected_return is None for run in each.runs)
    if endless:
        lines.append(f"in {endless:,} {of} seeds the greedy policy may never end, and so has no return")
    return [printable(line) for line in lines]


def _of_another(file: str, submission: str) -> str:
    # " of FILE" if the line is not in the submission's own file
    name = Path(file).name
    return "" if not name or name == AgentName.read(submission).path.name else f" of {name}"
