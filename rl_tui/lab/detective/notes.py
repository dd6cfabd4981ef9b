"""What cannot be told of a program, and why; how it departs from the book without a fault."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from rl_tui.lab.detective.evidence import Evidence
from rl_tui.lab.detective.verdict import MovedCell, Rule, UpdateFound, UpdateTarget

_UNUSUAL: Final = (UpdateTarget.SAME_ACTION, UpdateTarget.OWN_STATE, UpdateTarget.INDEX, UpdateTarget.NOTHING)


def notes_on(evidence: Evidence, update: UpdateFound, dtype: str) -> tuple[str, ...]:
    """Return plain sentences, none where all is told."""
    return tuple(_notes(evidence, update, dtype))


def _notes(evidence: Evidence, update: UpdateFound, dtype: str) -> Iterator[str]:
    if not evidence.recording.changes.step.size:
        yield "No number of the table has moved yet: nothing can be told of the update."
        return
    if update.reason:
        yield update.reason
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
