"""The report on a program watched to its end, `watch --json`."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from rl_tui.programs.evidence.code_names import DISCOUNTS, declared
from rl_tui.programs.evidence.verdict import CodeFinding, ProgramVerdict, UpdateFound, step_number
from rl_tui.programs.watched.notebook import cell_of
from rl_tui.programs.watched.program_log import FoundTable, ProgramEnvironment, ProgramError, ProgramLog
from rl_tui.runs.figures import MOST_STATES, finite


@dataclass(frozen=True, slots=True)
class LearnedFigures:
    """Exact results of the greedy policy, or None.

    `expected_return` is undiscounted, within the time limit. `value_at_start` is discounted by the γ found,
    or by the γ in the code if that is 0.
    """

    expected_return: float | None = None
    best_expected_return: float | None = None
    value_at_start: float | None = None


def watch_report(script: str, log: ProgramLog, verdict: ProgramVerdict) -> dict[str, Any]:
    """Return the report on the program as JSON data."""
    gamma, written = verdict.update.gamma, declared(log.numbers, DISCOUNTS)
    if gamma == 0.0 and written is not None:  # without the next state in the update, the intended γ counts
        gamma = written[1]
    environment, learned = environment_of(log), learned_figures(log, gamma)
    document: dict[str, Any] = finite(
        {
            "script": script,
            "environment": None if environment is None else _environment(environment, log),
            "table": None if log.table_now is None else _table(log.table_now),
            "steps": log.recording.count,
            "episodes": episodes_of(log),
            "expected_return": learned.expected_return,
            "best_expected_return": learned.best_expected_return,
            "value_at_start": learned.value_at_start,
            "update": _update(verdict.update),
            "exploration": None if verdict.exploration is None else asdict(verdict.exploration),
            "findings": [finding_as_json(finding) for finding in verdict.findings],
            "notes": [*log.notes, *verdict.notes],
            "error": _error(error_of(log)),
        }
    )
    return document


def environment_of(log: ProgramLog) -> ProgramEnvironment | None:
    """Return the table's environment, or the first one."""
    cells = None if log.recording.initial is None else len(log.recording.initial)
    fitting = (each for each in log.environments if each.states * each.actions == cells)
    return next(fitting, log.environments[0] if log.environments else None)


def episodes_of(log: ProgramLog) -> int:
    """Count the episodes that ended or were left."""
    steps = log.recording.steps
    if not log.episodes:
        return 0
    return log.episodes - (not (steps.terminated[-1] or steps.truncated[-1]))


def error_of(log: ProgramLog) -> ProgramError | None:
    """Return the program's exception or refusal, if any."""
    return ProgramError("Refused", log.refused) if log.refused else log.error


def learned_figures(log: ProgramLog, gamma: float | None) -> LearnedFigures:
    """Return exact results of a table of at most 50,000 states, with ties shared equally."""
    from rl_tui.agents.exact.policy_figures import expected_return, figures, greedy_policy
    from rl_tui.agents.exact.solve import best_expected_return
    from rl_tui.common.errors import UserError
    from rl_tui.programs.watched.program_world import world_of_program

    environment = environment_of(log)
    if environment is None:
        return LearnedFigures()
    try:
        known = world_of_program(environment)
    except UserError:  # too large
        return LearnedFigures()
    mdp = known.world.mdp
    if mdp is None or mdp.states > MOST_STATES:
        return LearnedFigures()
    best = best_expected_return(mdp)
    if not _fits(log, environment):
        return LearnedFigures(best_expected_return=best)
    q = known.q_of(log.recording.table_at(log.recording.count))
    policy = greedy_policy(mdp, q, "random")
    if gamma is None or not 0.0 <= gamma <= 1.0:
        return LearnedFigures(expected_return(mdp, policy), best)
    of_policy = figures(mdp, policy, gamma)
    return LearnedFigures(of_policy.expected_return, best, of_policy.value_at_start)


def _fits(log: ProgramLog, environment: ProgramEnvironment) -> bool:
    initial = log.recording.initial
    return initial is not None and len(initial) == environment.states * environment.actions


def _environment(environment: ProgramEnvironment, log: ProgramLog) -> dict[str, Any]:
    states = environment.states
    if environment.state_names:
        steps = log.recording.steps
        states = len(np.union1d(steps.state, steps.next_state))
    return {"id": environment.id, "states": states, "actions": environment.actions}


def _table(table: FoundTable) -> dict[str, Any]:
    return {
        "name": table.name,
        "kind": table.form,
        "shape": list(table.shape),
        "dtype": table.dtype,
        "others": list(table.others),
    }


def _update(update: UpdateFound) -> dict[str, Any]:
    return {
        "rule": update.rule.value,
        "alpha": update.alpha,
        "alpha_schedule": update.alpha_schedule,
        "gamma": update.gamma,
        "epsilon": update.epsilon,
        "reward": update.reward,
        "fits": update.fits,
        "informative": update.informative,
        "departs_at": None if update.departs_at is None else step_number(update.departs_at),
    }


def finding_as_json(finding: CodeFinding) -> dict[str, Any]:
    """Return `finding` as JSON data."""
    return {
        "fault": finding.fault.value,
        "kind": finding.kind,
        "certainty": finding.certainty,
        "step": step_number(finding.step),
        "steps_for": finding.steps_for,
        "steps_against": finding.steps_against,
        **_place(finding.file, finding.line),
        "text": finding.text,
        "correction": finding.correction,
    }


def _error(error: ProgramError | None) -> dict[str, Any] | None:
    if error is None:
        return None
    return {"type": error.type, "text": error.text, **_place(error.file, error.line)}


def _place(file: str, line: int | None) -> dict[str, Any]:
    cell = None if line is None else cell_of(file, line)
    if cell is None:
        return {"file": file or None, "line": line}
    return {"file": file, "cell": cell[0], "line": cell[1]}
