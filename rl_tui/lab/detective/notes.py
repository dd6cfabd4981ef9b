"""What cannot be told of a program, and why; how it departs from the book without a fault."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np

from rl_tui.common.findings import one_line
from rl_tui.lab.detective.evidence import Evidence
from rl_tui.lab.detective.faults.proof import FEWEST_STEPS, step_text
from rl_tui.lab.detective.source.code_names import declared_discount
from rl_tui.lab.detective.verdict import MovedCell, Rule, UpdateFound, UpdateTarget
from rl_tui.lab.programs.program_log import ProgramLog

MOVES_WITHOUT_GAMMA: Final = "The table moves as with γ 0"
_LONGEST: Final = 80
_UNUSUAL: Final = (UpdateTarget.SAME_ACTION, UpdateTarget.OWN_STATE, UpdateTarget.INDEX, UpdateTarget.NOTHING)


def notes_on(
    evidence: Evidence, update: UpdateFound, dtype: str, numbers: Mapping[str, float]
) -> tuple[str, ...]:
    """Return plain sentences, none where all is told; ``numbers`` are those of the code, by name."""
    return tuple(_notes(evidence, update, dtype, numbers))


def note_on_other_worlds(log: ProgramLog) -> tuple[str, ...]:
    """Return a sentence on environments of other sizes than the table has, if steps are taken there."""
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
        f"Of the steps in {one_line(ids, _LONGEST)} nothing is told: {name} has no row for them; "
        "--table NAME follows another table.",
    )


def _notes(
    evidence: Evidence, update: UpdateFound, dtype: str, numbers: Mapping[str, float]
) -> Iterator[str]:
    if not evidence.changes.step.size:
        rewards = int(np.count_nonzero(evidence.reward))
        came = f", though {rewards:,} rewards came" if rewards else ", and no reward came"
        yield f"No number of the table has moved yet{came}: nothing can be told of the update."
        return
    discount = declared_discount(numbers)
    if update.gamma == 0.0 and discount is not None and discount[1] > 0.0:
        yield _without_discount(evidence, *discount)
    elif update.reason:
        yield update.reason
    if update.rule is Rule.UNKNOWN:
        yield from _few_of_the_next_state(evidence)
    if update.rule in (Rule.UNKNOWN, Rule.MONTE_CARLO):
        yield "What is done at the end of an episode cannot be told without a known update."
        return
    if update.gamma is None:
        yield "No step yet tells γ: the values of the next states were 0, or always the same."
    elif update.target in _UNUSUAL:
        yield f"The target takes {update.target} for the value of the next state."
    if update.reward == "own":
        yield "The reward is the program's own: what is done at the end of an episode cannot be told."
    if update.place is MovedCell.ONE_LATE:
        yield "Each update comes one step late: it is that of the step before."
    if dtype.startswith("float16"):
        yield "The table holds float16: estimates have three digits."


def _without_discount(evidence: Evidence, name: str, gamma: float) -> str:
    """Return what is to be said where the table moves as with γ 0, but the code holds ``gamma``."""
    table = np.nan_to_num(evidence.recording.table_at(evidence.recording.count))
    highest = table.reshape(-1, evidence.actions).max(0)
    text = (
        f"{MOVES_WITHOUT_GAMMA}, though `{one_line(name, _LONGEST)}` in your code is {gamma:g}: the "
        "value of the next state never enters the target."
    )
    if np.all(highest == 0.0) and np.all(evidence.changes.after <= 0.0):
        text += (
            " A maximum over all states in place of the actions, as in max(Q[:, a]), would explain it: it "
            "was always 0 here."
        )
    return text


def _few_of_the_next_state(evidence: Evidence) -> Iterator[str]:
    """Yield a sentence where less steps than prove it moved the row of the next state, and none their own."""
    cell = evidence.only_change[0]
    at = np.flatnonzero((cell >= 0) & (evidence.state != evidence.next_state))
    moved = evidence.next_state[at] * evidence.actions + evidence.action[at]
    if 0 < len(at) < FEWEST_STEPS and np.array_equal(cell[at], moved):
        first = evidence.number[at[0]]
        yield (
            f"At {step_text(first)} it was Q(s′, a) that moved, not Q(s, a): {len(at)} such "
            f"{'step' if len(at) == 1 else 'steps'} so far, {FEWEST_STEPS} would prove that the state "
            "is moved on before the update."
        )
