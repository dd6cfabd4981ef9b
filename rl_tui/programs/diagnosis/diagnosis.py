"""The verdict on a watched program."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np

from rl_tui.common.findings import command_line, one_line
from rl_tui.programs.diagnosis.exploration import exploration_of
from rl_tui.programs.diagnosis.faults.cells import (
    FEWEST_STEPS,
    Proof,
    proof_of_cell,
    proof_of_sharing,
    step_text,
)
from rl_tui.programs.diagnosis.faults.choices import proof_of_risk, proof_of_steps_after_end, risk_of_choices
from rl_tui.programs.diagnosis.faults.formula import proof_of_formula
from rl_tui.programs.diagnosis.faults.hypotheses import Case, proofs_of
from rl_tui.programs.diagnosis.faults.lost_updates import (
    proof_of_missing_update,
    proof_of_no_update,
    proof_of_rounding,
)
from rl_tui.programs.diagnosis.faults.predictions import by_the_environment
from rl_tui.programs.diagnosis.update_rule import update_of
from rl_tui.programs.evidence.code_names import DISCOUNTS, declared, names_of
from rl_tui.programs.evidence.code_places import ProgramCode, program_code
from rl_tui.programs.evidence.evidence import Evidence
from rl_tui.programs.evidence.verdict import (
    UNUSUAL_TARGETS,
    CodeFault,
    CodeFinding,
    CountedVisits,
    MovedCell,
    ProgramVerdict,
    Rule,
    SuspectedRisk,
    UpdateFound,
    UpdateTarget,
)
from rl_tui.programs.watched.program_log import FoundTable, ProgramLog

# Notes on unknown facts


MOVES_WITHOUT_GAMMA: Final = "The table changes as if γ = 0"
_LONGEST: Final = 80


_VISITS: Final[Mapping[CountedVisits, str]] = {
    "first": "Only the first visit to a pair in an episode counts: first-visit Monte Carlo.",
    "every": "Every visit to a pair in an episode counts: every-visit Monte Carlo.",
    "last": (
        "Only the last visit to a pair in an episode counts. First-visit Monte Carlo counts only the first."
    ),
}


def _note_on_two_tables(evidence: Evidence, table: FoundTable) -> Iterator[str]:
    if evidence.is_pair:
        name, other = one_line(table.name, _LONGEST), one_line(table.other, _LONGEST)
        option = one_line(command_line(("--table", table.name)), _LONGEST)
        yield f"{name} and {other} change in turn. Their mean is shown. {option} shows only {name}."


def notes_on(evidence: Evidence, update: UpdateFound) -> Iterator[str]:
    """Yield sentences about unknown facts."""
    if not evidence.changes.step.size:
        rewards = int(np.count_nonzero(evidence.reward))
        came = f"{rewards:,} rewards arrived" if rewards else "No reward arrived"
        yield f"{came}, and the table has not changed yet."
        return
    discount = declared(evidence.numbers, DISCOUNTS)
    if update.gamma == 0.0 and discount is not None and discount[1] > 0.0:
        yield _without_discount(evidence, *discount)
    elif update.reason:
        yield update.reason
    if update.rule is Rule.UNKNOWN:
        yield from _few_of_the_next_state(evidence)
    if update.visits is not None:
        yield _VISITS[update.visits]
    if update.rule in (Rule.UNKNOWN, Rule.MONTE_CARLO):
        yield "The ends of episodes are not checked for this update."
        return
    if update.gamma is None:
        yield "γ is not known yet: the values of the next states were 0, or always the same."
    elif update.target is UpdateTarget.DRAWN:
        yield (
            "The target contains Q(s′, b), but action b is not always the best or the next one, as if it was "
            "drawn separately. SARSA takes the action that its target contains."
        )
    elif update.target in UNUSUAL_TARGETS:
        yield f"The target uses {update.target} as the value of the next state."
    if update.reward == "own":
        yield "The program uses its own reward, so the ends of episodes are not checked."
    if update.place is MovedCell.ONE_LATE:
        yield "Each update comes one step late."
    if evidence.dtype.startswith("float16"):
        yield "The table has the type float16, so estimates have only three digits."


def _note_on_other_worlds(log: ProgramLog) -> tuple[str, ...]:
    """Describe steps in environments of other sizes."""
    if log.table is None or log.recording.initial is None:
        return ()
    cells = len(log.recording.initial)
    used = set(np.unique(log.recording.steps.environment).tolist())
    others = [
        each for each in log.environments if each.number in used and each.states * each.actions != cells
    ]
    if not others:
        return ()
    ids = ", ".join(dict.fromkeys(f"{each.id} ({each.states} × {each.actions})" for each in others))
    name = one_line(log.table.name, _LONGEST)
    return (
        f"Steps in {one_line(ids, _LONGEST)} are ignored: {name} has no row for them. --table NAME follows "
        "another table.",
    )


def _without_discount(evidence: Evidence, name: str, gamma: float) -> str:
    table = np.nan_to_num(evidence.recording.table_at(evidence.recording.count))
    highest = table.reshape(-1, evidence.actions).max(0)
    text = (
        f"{MOVES_WITHOUT_GAMMA}, but `{one_line(name, _LONGEST)}` in your code is {gamma:g}. The target "
        "never contains the value of the next state."
    )
    if np.all(highest == 0.0) and np.all(evidence.changes.after <= 0.0):
        text += (
            " A maximum over states instead of actions, as in max(Q[:, a]), would explain this: that "
            "maximum was always 0."
        )
    return text


def _few_of_the_next_state(evidence: Evidence) -> Iterator[str]:
    cell = evidence.only_change[0]
    at = np.flatnonzero((cell >= 0) & (evidence.state != evidence.next_state))
    moved = evidence.next_state[at] * evidence.actions + evidence.action[at]
    if 0 < len(at) < FEWEST_STEPS and np.array_equal(cell[at], moved):
        first = evidence.number[at[0]]
        yield (
            f"At {step_text(first)} Q(s′, a) changed, not Q(s, a). {FEWEST_STEPS} such steps would prove "
            f"that the state changes before the update. So far: {len(at)}."
        )


# Findings with proof


_LONGEST_TEXT: Final = 600
"""Longest sentence in characters, since it contains names from the program."""
_HIDDEN_BY: Final = {
    CodeFault.ROUNDING_TABLE: frozenset(
        {CodeFault.LOSES_UPDATE, CodeFault.FIRST_OF_TIES, CodeFault.NEVER_EXPLORES}
    ),
    CodeFault.SHARED_TABLE: frozenset({CodeFault.WRONG_CELL, CodeFault.UPDATES_AFTER_MOVING}),
    CodeFault.WRONG_FORMULA: frozenset({CodeFault.STEP_SIZE_OUT_OF_RANGE}),
    CodeFault.UPDATES_AFTER_MOVING: frozenset({CodeFault.BOOTSTRAPS_AFTER_END}),
}
"""Faults that are consequences of another, which is reported alone."""


def findings_of(
    evidence: Evidence, update: UpdateFound, log: ProgramLog
) -> tuple[tuple[CodeFinding, ...], tuple[str, ...]]:
    """Return findings about a program, and notes about unknown facts."""
    table = log.table
    if table is None or not len(evidence):
        return (), ()
    code = program_code(log)
    names = names_of(code, table, update, log.numbers)
    with np.errstate(over="ignore", invalid="ignore"):  # of a table whose numbers diverge
        predictions = by_the_environment(evidence, update)
        proofs = [
            proof_of_sharing(evidence, log.shared_at, names),
            proof_of_rounding(evidence, names, writes=code.always_writes),
            proof_of_no_update(evidence, names, code, is_over=log.ended),
            proof_of_cell(evidence, names, plans=code.reads_transitions),
            proof_of_formula(evidence, update, log.environments, names),
            proof_of_steps_after_end(evidence, log, names),
            proof_of_risk(evidence, log, names),
        ]
        if predictions.is_known:
            is_other = predictions.update != update and code.gives_other(names.reward)
            case = Case(
                predictions,
                evidence.reward,
                names,
                done_is_either=log.agent is not None and log.agent.done_is_either,
                may_be_own=code.sets_a_constant or is_other,
            )
            proofs += proofs_of(case)
        notes = tuple(notes_on(evidence, predictions.update))
    enough = [proof for proof in proofs if proof is not None and proof.is_enough]
    hidden = frozenset().union(*(_HIDDEN_BY.get(proof.fault, frozenset()) for proof in enough))
    findings = tuple(_finding(proof, code) for proof in enough if proof.fault not in hidden)
    return findings, (*_note_on_two_tables(evidence, table), *notes)


def _findings_without_table(log: ProgramLog) -> tuple[CodeFinding, ...]:
    if log.agent is None:
        return ()
    code = program_code(log)
    proof = proof_of_missing_update(log, code)
    return () if proof is None else (_finding(proof, code),)


def _finding(proof: Proof, code: ProgramCode) -> CodeFinding:
    line = proof.place(code)
    return CodeFinding(
        proof.fault,
        proof.certainty,
        int(proof.steps[0]),
        len(proof.steps),
        proof.against,
        one_line(proof.text, _LONGEST_TEXT),
        one_line(proof.correction, _LONGEST_TEXT),
        "" if line is None else line.file,
        None if line is None else line.line,
    )


# The verdict


def verdict_of(log: ProgramLog) -> ProgramVerdict:
    """Return the verdict, which claims only what steps prove."""
    if log.table is None or log.recording.initial is None:
        return ProgramVerdict(findings=_findings_without_table(log))
    with np.errstate(all="ignore"):  # a user's table may contain anything
        evidence = Evidence(log.recording, log.numbers, log.table.dtype)
        update = update_of(evidence)
        findings, notes = findings_of(evidence, update, log)
        code = program_code(log)
        risk = risk_of_choices(evidence, log, names_of(code, log.table, update, log.numbers))
        exploration = exploration_of(evidence, update)
    suspected = None if risk is None else SuspectedRisk(_finding(risk.proof, code), risk.luck)
    return ProgramVerdict(update, findings, (*notes, *_note_on_other_worlds(log)), suspected, exploration)
