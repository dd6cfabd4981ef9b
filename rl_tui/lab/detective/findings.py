"""What is wrong with a program: each told only from steps that tell two hypotheses apart."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from rl_tui.common.findings import one_line
from rl_tui.lab.detective.evidence import Evidence
from rl_tui.lab.detective.faults.axes import proof_of_axis
from rl_tui.lab.detective.faults.cells import proof_of_cell, proof_of_sharing
from rl_tui.lab.detective.faults.choices import risk_of_choices
from rl_tui.lab.detective.faults.constants import proof_of_gamma_twice, proof_of_step_size
from rl_tui.lab.detective.faults.ends import proofs_at_ends
from rl_tui.lab.detective.faults.lost_updates import (
    proof_of_missing_update,
    proof_of_no_update,
    proof_of_rounding,
)
from rl_tui.lab.detective.faults.predictions import Predictions, by_the_environment
from rl_tui.lab.detective.faults.proof import CodePlace, Proof
from rl_tui.lab.detective.faults.rewards import reward_used
from rl_tui.lab.detective.notes import notes_on
from rl_tui.lab.detective.source.code_names import CodeNames, names_of
from rl_tui.lab.detective.source.code_places import ProgramCode, program_code
from rl_tui.lab.detective.verdict import CodeFault, CodeFinding, UpdateFound
from rl_tui.lab.programs.program_log import FoundTable, ProgramLog

_LONGEST: Final = 600
"""Characters of a sentence; names of the program stand in it."""
_HIDDEN_BY: Final = {
    CodeFault.ROUNDING_TABLE: frozenset(
        {CodeFault.LOSES_UPDATE, CodeFault.FIRST_OF_TIES, CodeFault.NEVER_EXPLORES}
    ),
    CodeFault.SHARED_TABLE: frozenset({CodeFault.WRONG_CELL, CodeFault.UPDATES_AFTER_MOVING}),
    CodeFault.UPDATES_AFTER_MOVING: frozenset({CodeFault.BOOTSTRAPS_AFTER_END}),
}
"""Faults that follow from another, which alone is told."""


def findings_of(
    evidence: Evidence, update: UpdateFound, log: ProgramLog, *, done_is_either: bool = False
) -> tuple[tuple[CodeFinding, ...], tuple[str, ...]]:
    """Return the findings about the program of ``log`` and the notes on what cannot be told.

    ``done_is_either`` says that an agent is handed one flag for the end of an episode and its being cut off.
    """
    if log.table is None or not len(evidence):
        return (), ()
    with np.errstate(over="ignore", invalid="ignore"):  # of a table whose numbers run away
        return _found(evidence, update, log, log.table, done_is_either=done_is_either)


def _found(
    evidence: Evidence, update: UpdateFound, log: ProgramLog, table: FoundTable, *, done_is_either: bool
) -> tuple[tuple[CodeFinding, ...], tuple[str, ...]]:
    code = program_code(log)
    names = names_of(code, table, update, log.numbers)
    predictions = by_the_environment(evidence, update, table.dtype)
    proofs = [
        *_without_a_rule(evidence, log, table, code, names),
        *_by_the_rule(predictions, update, log, code, names, done_is_either=done_is_either),
    ]
    enough = [proof for proof in proofs if proof is not None and proof.is_enough]
    hidden = frozenset().union(*(_HIDDEN_BY.get(proof.fault, frozenset()) for proof in enough))
    findings = tuple(_finding(proof, code) for proof in enough if proof.fault not in hidden)
    return findings, notes_on(evidence, predictions.update, table.dtype, log.numbers)


def findings_without_table(log: ProgramLog) -> tuple[CodeFinding, ...]:
    """Return what may be told of an agent in which no table was found."""
    if log.agent is None:
        return ()
    code = program_code(log)
    proof = proof_of_missing_update(log, code)
    return () if proof is None else (_finding(proof, code),)


def _without_a_rule(
    evidence: Evidence, log: ProgramLog, table: FoundTable, code: ProgramCode, names: CodeNames
) -> Iterator[Proof | None]:
    """Yield what may be proven of any program."""
    writes = code.always_writes
    yield proof_of_sharing(evidence, log.shared_at, names)
    yield proof_of_rounding(evidence, table.dtype, log.numbers, names, writes=writes)
    yield proof_of_no_update(evidence, names, code, is_over=log.ended)
    yield proof_of_cell(evidence, names)
    yield risk_of_choices(evidence, log, names)


def _by_the_rule(
    predictions: Predictions,
    update: UpdateFound,
    log: ProgramLog,
    code: ProgramCode,
    names: CodeNames,
    *,
    done_is_either: bool,
) -> Iterator[Proof | None]:
    """Yield what may be proven where the update is known."""
    if not predictions.is_known:
        return
    reward, shifted = reward_used(predictions, names)
    yield shifted
    yield proof_of_axis(predictions, reward, names)
    yield from proofs_at_ends(
        predictions,
        reward,
        names,
        done_is_either=done_is_either,
        may_be_own=code.sets_a_constant or (predictions.update != update and code.gives_other(names.reward)),
    )
    yield proof_of_gamma_twice(predictions, reward, log.numbers, names)
    yield proof_of_step_size(predictions, reward, names)


def _finding(proof: Proof, code: ProgramCode) -> CodeFinding:
    match proof.place:
        case CodePlace.UPDATE:
            line = code.update_line()
        case CodePlace.TABLE:
            line = code.table_line()
        case CodePlace.CHOICE:
            line = code.choice_line()
        case CodePlace.CALL:
            line = code.call_line()
    return CodeFinding(
        proof.fault,
        proof.certainty,
        int(proof.steps[0]),
        len(proof.steps),
        proof.against,
        one_line(proof.text, _LONGEST),
        one_line(proof.correction, _LONGEST),
        "" if line is None else line.file,
        None if line is None else line.line,
    )
