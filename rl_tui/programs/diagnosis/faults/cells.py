"""Bugs in which cell of the table moves, proved without knowing the update rule."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from rl_tui.programs.evidence.code_names import CodeNames
from rl_tui.programs.evidence.code_places import CodeLine, ProgramCode
from rl_tui.programs.evidence.evidence import NO_ACTION, Evidence
from rl_tui.programs.evidence.verdict import RISKS, CodeFault, UpdateTarget, step_number
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

# A proof


FEWEST_STEPS: Final = 3
"""Steps that must support a fault, with none against it."""
MOST_STEPS: Final = 50_000
"""Most steps for one question: half of them the first, half the latest."""
_SHARE_OF_OTHERS: Final = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Proof:
    """The form of every proved bug. `steps` support it, oldest first.

    `against` counts opposing steps (0 for a fault), `neither` those with another result. `place` returns the
    line to which the bug belongs.
    """

    fault: CodeFault
    steps: IntArray
    against: int
    text: str
    correction: str
    place: Callable[[ProgramCode], CodeLine | None] = ProgramCode.update_line
    certainty: Literal["proven", "declared"] = "proven"
    neither: int = 0

    @property
    def is_enough(self) -> bool:
        """True if it may be reported."""
        few = self.neither <= len(self.steps) * _SHARE_OF_OTHERS
        is_clear = self.against == 0 or self.fault in RISKS
        return len(self.steps) >= FEWEST_STEPS and is_clear and few


def some_of(places: IntArray, most: int = MOST_STEPS) -> IntArray:
    """Return the first and last of too many `places`."""
    if len(places) <= most:
        return places
    return np.concatenate((places[: most // 2], places[-(most - most // 2) :]))


def step_text(step: int) -> str:
    """Name `step` in a sentence, counted from 1."""
    return f"step {step_number(step):,}"


def written(number: float) -> str:
    """Format `number` with four significant digits."""
    return f"{number:.4g}".replace("-", "−")


# Wrong and shared cells


_ONE_CELL: Final = 0.95
"""Share of changing steps that must change exactly one cell."""
_MOST_FIXED: Final = 32
_MOVED: Final = "(s′, a)"
_SWAPPED: Final = {_MOVED: "the maximum of Q(s), not of Q(s′)", "(s′, a′)": "Q(s, a), not Q(s′, a′)"}
"""Cells that move if s and s′ are swapped, with the value in the target."""
_MOST_SOLVED: Final = 2_000
_UNKNOWNS: Final = 3
_PATIENCE: Final = 1_000.0
"""Tolerance of a solution, as a multiple of the table's precision."""


def proof_of_cell(evidence: Evidence, names: CodeNames, *, plans: bool = False) -> Proof | None:
    """Prove that always a wrong cell moves. A program that `plans` may move any."""
    if plans:
        return None
    cell = evidence.only_change[0]
    rebound = np.isin(evidence.number, np.asarray(evidence.recording.rebound, np.int64))
    single = (cell >= 0) & ~rebound
    if single.sum() < _ONE_CELL * (evidence.changes_of > 0).sum():
        return None
    at = some_of(np.flatnonzero(single))
    if (cell[at] != evidence.cell[at]).sum() < FEWEST_STEPS or _is_renumbered(evidence, at):
        return None
    for place, wrong in _wrong_cells(evidence, at).items():
        proof = _proof(evidence, at, wrong, place, names)
        if proof.is_enough:
            return proof
    untaken = at[_is_untaken(evidence, at)]
    for place, wrong in _mixed_cells(evidence, at).items():
        proof = _proof(evidence, at, wrong, place, names, untaken)
        if proof.is_enough:
            return proof
    return None


def _is_renumbered(evidence: Evidence, at: IntArray) -> bool:
    """Return True if the table may number states and actions in another way."""
    state, moved = evidence.state[at], evidence.only_change[0][at]
    if state.min() == state.max() and (moved // evidence.actions != state).any():
        return False
    states = _is_one_to_one(state, moved // evidence.actions)
    return states and _is_one_to_one(evidence.action[at], moved % evidence.actions)


def _is_one_to_one(one: IntArray, other: IntArray) -> bool:
    pairs, counts = np.unique(np.column_stack((one, other)), axis=0, return_counts=True)
    order = np.lexsort((-counts, pairs[:, 0]))
    usual = order[np.flatnonzero(np.diff(pairs[order, 0], prepend=-1))]
    exceptions = len(one) - counts[usual].sum()
    return bool(exceptions < FEWEST_STEPS) and len(np.unique(pairs[usual, 1])) == len(usual)


def _wrong_cells(evidence: Evidence, at: IntArray) -> dict[str, IntArray]:
    actions, state, action = evidence.actions, evidence.state[at], evidence.action[at]
    following, next_state = evidence.next_action[at], evidence.next_state[at]
    has_next = following != NO_ACTION
    fits = (state < actions) & (action < evidence.states)
    cells = {
        _MOVED: next_state * actions + action,
        "(a, s)": np.where(fits, action * actions + state, -1),
        "(s′, a′)": np.where(has_next, next_state * actions + following, -1),
        "(s, a′)": np.where(has_next, state * actions + following, -1),
    }
    for fixed in range(min(actions, _MOST_FIXED)):
        cells[f"(s, {fixed})"] = state * actions + fixed
    return cells


def _mixed_cells(evidence: Evidence, at: IntArray) -> dict[str, IntArray]:
    """Return the cells, `[n]`, that mix this step with the one before or with the best action."""
    actions, state, action = evidence.actions, evidence.state[at], evidence.action[at]
    next_state, before = evidence.next_state[at], evidence.previous_cell[at]
    has_before = before != NO_ACTION
    return {
        "(s, a before)": np.where(has_before, state * actions + before % actions, -1),
        "(s before, a)": np.where(has_before, before // actions * actions + action, -1),
        "(s, argmax Q(s))": state * actions + evidence.rows(state, at).argmax(1),
        "(s′, argmax Q(s′))": next_state * actions + evidence.rows(next_state, at).argmax(1),
    }


def _is_untaken(evidence: Evidence, at: IntArray) -> BoolArray:
    recording, steps = evidence.recording, evidence.recording.steps
    if recording.first:
        return np.zeros(len(at), np.bool_)
    taken_at = np.full(len(evidence.initial), recording.count)
    np.minimum.at(taken_at, steps.state * evidence.actions + steps.action, np.arange(len(steps.state)))
    untaken: BoolArray = taken_at[evidence.only_change[0][at]] > evidence.number[at]
    return untaken


def _proof(
    evidence: Evidence,
    at: IntArray,
    wrong: IntArray,
    place: str,
    names: CodeNames,
    telling: IntArray | None = None,
) -> Proof:
    moved, own = evidence.only_change[0][at], evidence.cell[at]
    known = wrong >= 0
    differ = known & (wrong != own)
    speaking = at[differ & (moved == wrong)]
    if telling is not None:
        speaking = np.intersect1d(speaking, telling)
    text = ""
    if len(speaking):
        first = speaking[0]
        state, action = divmod(int(evidence.cell[first]), evidence.actions)
        other = divmod(int(evidence.only_change[0][first]), evidence.actions)
        text = (
            f"At {step_text(evidence.number[first])} action {action} was taken in state {state}. "
            f"Q({other[0]}, {other[1]}) changed, which is Q{place}. It should be Q({state}, {action}), which "
            f"is Q(s, a)."
        )
    is_swapped = place in _SWAPPED and _takes_own_value(evidence, speaking, place)
    if is_swapped:
        text += f" The target has {_SWAPPED[place]}."
    return Proof(
        CodeFault.UPDATES_AFTER_MOVING if place == _MOVED and not is_swapped else CodeFault.WRONG_CELL,
        evidence.number[speaking],
        int((differ & (moved == own)).sum()),
        text,
        _correction(names, place, is_swapped=is_swapped),
        neither=int((known & (moved != wrong) & (moved != own)).sum()),
    )


def _correction(names: CodeNames, place: str, *, is_swapped: bool) -> str:
    cell = names.cell()
    if not is_swapped and place != _MOVED:
        # the line may name the right variables, which another line has changed
        held = f"{names.state} is the state before the step and {names.action} the action taken in it"
        return f"update {cell} while {held}"
    start = ""
    if names.next_state == names.state:  # env.step overwrites it
        names = replace(names, next_state=f"next_{names.state}")
        start = f"call the next state {names.next_state}, then "
    if is_swapped:
        if place != _MOVED:
            names = replace(names, value=UpdateTarget.NEXT_ACTION)
        return f"{start}swap {names.state} and {names.next_state}: {names.target()}; {names.update()}"
    other = replace(names, state=names.next_state).cell()
    return f"{start}update {cell}, not {other}, and set {names.state} = {names.next_state} after that"


def _takes_own_value(evidence: Evidence, at: IntArray, place: str) -> bool:
    """Return True if only a value of s, in place of one of s′, gives constant factors."""
    at = at[~evidence.ends[at]][:_MOST_SOLVED]
    if len(at) < FEWEST_STEPS:
        return False
    own = evidence.rows(evidence.state[at], at)
    following = evidence.rows(evidence.next_state[at], at)
    if place == _MOVED:
        own, following = own.max(1), following.max(1)
    else:
        own = own[np.arange(len(at)), evidence.action[at]]
        following = following[np.arange(len(at)), evidence.next_action[at]]
    if (own != following).sum() < FEWEST_STEPS + _UNKNOWNS:
        return False
    return _is_solved_by(evidence, at, own) and not _is_solved_by(evidence, at, following)


def _is_solved_by(evidence: Evidence, at: IntArray, maximum: FloatArray) -> bool:
    _, before, after = (column[at] for column in evidence.only_change)
    parts = np.column_stack((evidence.reward[at], maximum, before))
    if not (np.isfinite(parts).all() and np.isfinite(after).all()):
        return False
    factors = np.linalg.lstsq(parts, after, rcond=None)[0]
    largest = max(float(np.abs(parts).max()), float(np.abs(after).max()))
    return bool(np.abs(parts @ factors - after).max() <= _PATIENCE * evidence.precision * largest)


def proof_of_sharing(evidence: Evidence, shared_at: int | None, names: CodeNames) -> Proof | None:
    """Prove that rows are the same object."""
    if shared_at is None:
        return None
    changes = evidence.recording.changes
    actions = evidence.actions
    order = np.lexsort((changes.cell, changes.cell % actions, changes.step))
    step, action = changes.step[order], changes.cell[order] % actions
    after = changes.after[order]
    alike = (step[1:] == step[:-1]) & (action[1:] == action[:-1]) & (after[1:] == after[:-1])
    if not alike.any():
        return None
    steps = np.unique(step[1:][alike])
    first = int(np.argmax(alike))
    one, other = (int(changes.cell[order][place]) // actions for place in (first, first + 1))
    return Proof(
        CodeFault.SHARED_TABLE,
        steps,
        0,
        f"Rows of the table are the same object. At {step_text(step[first])} states {one} and {other} got "
        f"the same new value. Only one of them should change.",
        f"create a separate row for each state: {names.table} = {names.rows(actions)}",
        ProgramCode.table_line,
    )
