"""Bugs that predict other new values than the correct update, as one table."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Final, Literal

import numpy as np

from rl_tui.programs.diagnosis.faults.cells import MOST_STEPS, Proof, some_of, step_text, written
from rl_tui.programs.diagnosis.faults.predictions import Predictions
from rl_tui.programs.evidence.code_names import DISCOUNT, CodeNames
from rl_tui.programs.evidence.code_places import CodeLine, ProgramCode
from rl_tui.programs.evidence.evidence import Evidence
from rl_tui.programs.evidence.verdict import CodeFault, MovedCell, Rule, UpdateFound, UpdateTarget
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

# A hypothesis


_NEAR: Final = 1e-6
_LEAST_DISCOUNT: Final = 1e-3
"""A smaller discount may be a rounding error."""
_MOST_REWARDS: Final = 20_000
_ONE_TABLE: Final = (UpdateTarget.BEST, UpdateTarget.OTHER_BEST)
"""Targets that read one of two tables only."""
_MOST_COLUMNS: Final = 2_000
"""Most steps checked with the maximum of a column, which is as long as the number of states."""
_EITHER_END: Final = "done"
"""Name of a flag that is also true at a truncation, if that is what it is found to do."""


@dataclass(frozen=True, eq=False)
class Case:
    """A program whose update is known, with the reward that it uses, `[N]`.

    Attributes:
        done_is_either: True if one flag is for terminal and truncated ends, so that a missing bootstrap is
            not its fault.
        may_be_own: True if its rewards may differ, or it sets estimates to a constant. An updated estimate
            may then stay the same.
    """

    predictions: Predictions
    reward: FloatArray
    names: CodeNames
    done_is_either: bool = False
    may_be_own: bool = False

    @property
    def evidence(self) -> Evidence:
        """The program's steps."""
        return self.predictions.evidence

    @property
    def update(self) -> UpdateFound:
        """The update of the program."""
        return self.predictions.update

    @property
    def uses_reward(self) -> bool:
        """True if the target has the environment's reward."""
        return self.update.reward != "own"

    @property
    def bootstraps(self) -> bool:
        """True if the target also has the next value."""
        update = self.update
        has_next = update.target is not UpdateTarget.NOTHING and (update.gamma or 0.0) >= _LEAST_DISCOUNT
        return self.uses_reward and has_next


class _Tested:
    """The n steps on which a hypothesis is tested."""

    def __init__(self, case: Case, which: BoolArray, most: int) -> None:
        self.case, self.evidence = case, case.evidence
        self.readings = case.predictions.readings(some_of(np.flatnonzero(which), most))
        self.at: IntArray = self.readings.at
        self.reward = case.reward[self.at]
        self.values = case.predictions.values(self.at)

    @property
    def before(self) -> FloatArray:
        """Old values, `[n, 1]`."""
        return self.readings.before[:, None]

    @cached_property
    def with_next(self) -> FloatArray:
        """New values with the next value, `[n, K]`."""
        return self.after(self.values)

    @cached_property
    def without(self) -> FloatArray:
        """New values without it, `[n, 1]`."""
        return self.after(np.zeros((len(self.at), 1)))

    def after(self, values: FloatArray, reward: FloatArray | None = None) -> FloatArray:
        """Return new values for the next `values`, `[n, K]`, and `reward`, `[n]`."""
        used = self.reward if reward is None else reward
        return self.case.predictions.after(self.readings, used, values)

    def step(self, place: int) -> str:
        return step_text(self.evidence.number[self.at[place]])

    def move(self, place: int) -> str:
        before, after = written(self.readings.before[place]), written(self.readings.after[place])
        return f"stayed {after}" if before == after else f"changed from {before} to {after}"


@dataclass(frozen=True)
class Hypothesis:
    """A bug with its predictions.

    Attributes:
        steps: Steps on which it is tested, `[N]`.
        wrong: New values with the bug, `[n, K]`.
        right: New values without it, `[n, L]`.
        text: Describes the tested step at a place.
        shows: Steps that may speak for it, `[n]`, all by default.
        any_other: True if steps with a third result oppose it.
    """

    fault: CodeFault
    applies: Callable[[Case], bool]
    steps: Callable[[Case], BoolArray]
    wrong: Callable[[_Tested], FloatArray]
    right: Callable[[_Tested], FloatArray]
    text: Callable[[_Tested, int], str]
    correction: Callable[[Case], str]
    place: Callable[[ProgramCode], CodeLine | None] = ProgramCode.update_line
    certainty: Literal["proven", "declared"] = "proven"
    most: int = MOST_STEPS
    shows: Callable[[_Tested], BoolArray] | None = None
    any_other: bool = False

    def proof(self, case: Case) -> Proof | None:
        """Count the steps for and against it, if it applies."""
        predictions = case.predictions
        is_late = case.update.place is MovedCell.ONE_LATE
        if not predictions.is_known or is_late or not self.applies(case):
            return None
        tested = _Tested(case, self.steps(case), self.most)
        seen = predictions.witnesses(tested.readings, self.wrong(tested), self.right(tested))
        speaking = seen.one if self.shows is None else seen.one & self.shows(tested)
        others, neither = int(seen.other.sum()), int(seen.neither.sum())
        return Proof(
            self.fault,
            tested.evidence.number[tested.at[speaking]],
            others + neither * self.any_other,
            self.text(tested, int(np.argmax(speaking))) if speaking.any() else "",
            self.correction(case),
            self.place,
            self.certainty,
            neither * (not self.any_other),
        )


# Steps


def _changed(case: Case) -> BoolArray:
    changed: BoolArray = case.evidence.changes_of == 1
    return changed


def _inner(case: Case) -> BoolArray:
    return case.evidence.inner


def _ended(case: Case) -> BoolArray:
    return case.evidence.surely_ended & case.evidence.learns


def _cut_off(case: Case) -> BoolArray:
    return case.evidence.truncated & ~case.evidence.terminated & case.evidence.learns


def _ended_after_a_change(case: Case) -> BoolArray:
    evidence = case.evidence
    changing = np.flatnonzero(evidence.changes_of > 0)
    first = np.full(int(evidence.episode.max(initial=0)) + 1, len(evidence))
    np.minimum.at(first, evidence.episode[changing], changing)
    follows: BoolArray = first[evidence.episode] < np.arange(len(evidence))
    return _ended(case) & follows


# Texts


def _bootstrap_text(tested: _Tested, place: int, *, what: str, has_next: bool) -> str:
    state, action = divmod(int(tested.case.predictions.moved_cell[tested.at[place]]), tested.evidence.actions)
    nearest = int(np.abs(tested.with_next[place] - tested.readings.after[place]).argmin())
    expected = tested.without[place, 0] if has_next else tested.with_next[place, nearest]
    return (
        f"At {tested.step(place)} {what}. Q({state}, {action}) {tested.move(place)}. It should be "
        f"{written(expected)}, {'without' if has_next else 'with'} γ · "
        f"{written(tested.values[place, nearest])}."
    )


def _kept_text(tested: _Tested, place: int) -> str:
    return (
        f"At {tested.step(place)} an episode ended with the reward {written(tested.reward[place])}. The "
        f"estimate {tested.move(place)}, by α r. It should become {written(tested.without[place, 0])}: the "
        "old estimate is not subtracted."
    )


def _lost_text(tested: _Tested, place: int) -> str:
    return (
        f"At {tested.step(place)} an episode ended with the reward {written(tested.reward[place])}, but the "
        f"table did not change. The estimate {written(tested.readings.before[place])} should become "
        f"{written(tested.without[place, 0])}."
    )


def _axis_text(tested: _Tested, place: int) -> str:
    return (
        f"At {tested.step(place)} the target contained {written(tested.values[place, 0])}, the largest value "
        f"of action {tested.evidence.action[tested.at[place]]} in any state. It should contain "
        f"{written(_best(tested)[place, 0])}, the largest value in the next state."
    )


def _own_state_text(tested: _Tested, place: int) -> str:
    at = tested.at[place]
    state, next_state = tested.evidence.state[at], tested.evidence.next_state[at]
    return (
        f"At {tested.step(place)} the target contained {written(tested.values[place, 0])}, the largest value "
        f"in state {state}, which the step left. It should contain {written(_best(tested)[place, 0])}, the "
        f"largest value in the next state {next_state}."
    )


def _table_text(tested: _Tested, place: int) -> str:
    names, predictions, at = tested.case.names, tested.case.predictions, tested.at[[place]]
    own, other = names.table, names.other
    if tested.evidence.table[at[0]]:
        own, other = other, own
    read = own if tested.case.update.target is UpdateTarget.BEST else other
    right = predictions.values(at, UpdateTarget.BEST_BY_OTHER)[0, 0]
    state = tested.evidence.next_state[at[0]]
    return (
        f"At {tested.step(place)} {own} changed. The target contained {written(tested.values[place, 0])}, "
        f"the maximum of {read} in state {state}. It should contain {written(right)}, the value in {other} "
        f"of the best action in {own}."
    )


def _twice_text(tested: _Tested, _: int) -> str:
    name, root = _root(tested.case)
    once, twice = written(root), written(tested.case.predictions.gamma)
    return f"The table changes as if γ = {twice}. Your `{name}` is {once}, and {once}² = {twice}."


def _step_size_text(tested: _Tested, _: int) -> str:
    alpha = tested.case.update.alpha or 0.0
    way = "beyond" if alpha > 1.0 else "away from"
    name = tested.case.names.alpha
    return f"{name} is {written(alpha)}, so each update moves the estimate {way} its target."


def _left_out_correction(case: Case) -> str:
    names = case.names
    if names.terminated == _EITHER_END:
        names = replace(names, terminated="terminated")
    return f"test only {names.terminated}, not truncated: {names.target()}"


# Values


def _best(tested: _Tested) -> FloatArray:
    return tested.case.predictions.values(tested.at, UpdateTarget.BEST)


def _of_both(tested: _Tested) -> FloatArray:
    """Let one table choose the next action, and the other one give its value."""
    of, at = tested.case.predictions.values, tested.at
    values = (of(at, UpdateTarget.BEST_BY_OTHER), of(at, UpdateTarget.OTHERS_CHOICE))
    return tested.after(np.concatenate(values, axis=1))


def _with_or_without(tested: _Tested) -> FloatArray:
    return np.concatenate((tested.with_next, tested.without), axis=1)


def _allowed(tested: _Tested) -> FloatArray:
    alpha = tested.case.update.alpha or 0.0
    nearest = 1.0 / alpha if alpha > 1.0 else 0.0
    return tested.before + nearest * (_with_or_without(tested) - tested.before)


def _is_out_of_range(case: Case) -> bool:
    update = case.update
    is_constant = case.uses_reward and update.alpha_schedule == "constant" and update.alpha is not None
    return is_constant and not 0.0 < (update.alpha or 0.0) <= 1.0 + _NEAR


def _root(case: Case) -> tuple[str, float]:
    """Return the discount whose square moves the table, or 1 if the code has the found discount."""
    gamma, numbers = case.update.gamma, case.evidence.numbers
    if (
        gamma is None
        or not 0.0 < gamma < 1.0
        or any(math.isclose(each, gamma, rel_tol=_NEAR) for each in numbers.values())
    ):
        return "", 1.0
    roots = [
        name
        for name, each in numbers.items()
        if math.isclose(each * each, gamma, rel_tol=_NEAR) and DISCOUNT.search(name.rpartition(".")[2])
    ]
    name = min(roots, key=len, default="")
    return name, numbers.get(name, 1.0)


# The table


HYPOTHESES: Final = (
    Hypothesis(
        CodeFault.WRONG_TABLE,
        applies=lambda case: case.update.rule is Rule.DOUBLE_Q and case.update.target in _ONE_TABLE,
        steps=_inner,
        wrong=lambda tested: tested.with_next,
        right=_of_both,
        text=_table_text,
        correction=lambda case: (
            f"choose the action by the table that changes, and take its value from the other one, so for "
            f"{case.names.table}: {case.names.target()}"
        ),
    ),
    Hypothesis(
        CodeFault.WRONG_AXIS,
        applies=lambda case: case.update.target is UpdateTarget.COLUMN,
        steps=_inner,
        wrong=lambda tested: tested.with_next,
        right=lambda tested: tested.after(_best(tested)),
        shows=lambda tested: tested.values[:, 0] != tested.readings.before,  # or both cancel, as in a sum
        text=_axis_text,
        correction=lambda case: (
            f"take the maximum over the actions of the next state, {case.names.best()}: {case.names.target()}"
        ),
        most=_MOST_COLUMNS,
    ),
    Hypothesis(
        CodeFault.WRONG_FORMULA,
        applies=lambda case: (
            case.bootstraps
            and case.update.target is UpdateTarget.OWN_STATE
            and case.update.place is MovedCell.TAKEN
        ),
        steps=_inner,
        wrong=lambda tested: tested.with_next,
        right=lambda tested: tested.after(_best(tested)),
        text=_own_state_text,
        correction=lambda case: (
            f"read the value of the next state, {case.names.best()}: {case.names.target()}"
        ),
        any_other=True,
    ),
    Hypothesis(
        CodeFault.LOSES_UPDATE,
        applies=lambda case: case.uses_reward and not case.may_be_own,
        steps=_ended_after_a_change,
        wrong=lambda tested: tested.before,
        right=_with_or_without,
        text=_lost_text,
        correction=lambda case: (
            "also update after the last step of an episode, before you leave the loop: " + case.names.target()
        ),
        place=ProgramCode.call_line,
        any_other=True,  # whatever changed it, such a step has an update
    ),
    Hypothesis(
        CodeFault.BOOTSTRAPS_AFTER_END,
        applies=lambda case: case.bootstraps,
        steps=_ended,
        wrong=lambda tested: tested.with_next,
        right=lambda tested: tested.without,
        text=partial(
            _bootstrap_text,
            what="the episode ended in a terminal state, but the target contained the value of that state",
            has_next=True,
        ),
        correction=lambda case: f"leave out the next value after a terminal step: {case.names.target()}",
    ),
    Hypothesis(
        CodeFault.WRONG_FORMULA,
        applies=lambda case: case.bootstraps,
        steps=_ended,
        wrong=lambda tested: (
            tested.before + (tested.case.predictions.alpha[tested.at] * tested.reward)[:, None]
        ),
        right=lambda tested: np.concatenate((_with_or_without(tested), tested.before), axis=1),
        text=_kept_text,
        correction=lambda case: f"leave out only the next value after a terminal step: {case.names.target()}",
    ),
    Hypothesis(
        CodeFault.NO_BOOTSTRAP_AFTER_TRUNCATION,
        applies=lambda case: case.bootstraps and not case.done_is_either,
        steps=_cut_off,
        wrong=lambda tested: tested.without,
        right=lambda tested: tested.with_next,
        text=partial(
            _bootstrap_text,
            what="the time limit stopped the episode, but the target left out the value of the next state",
            has_next=False,
        ),
        correction=_left_out_correction,
    ),
    Hypothesis(
        CodeFault.GAMMA_TWICE,
        applies=lambda case: bool(_root(case)[0]),
        steps=_inner,
        wrong=lambda tested: tested.with_next,
        right=lambda tested: tested.after(tested.values / _root(tested.case)[1]),
        text=_twice_text,
        correction=lambda case: f"discount once: {replace(case.names, gamma=_root(case)[0]).target()}",
        certainty="declared",
    ),
    Hypothesis(
        CodeFault.STEP_SIZE_OUT_OF_RANGE,
        applies=_is_out_of_range,
        steps=_changed,
        wrong=_with_or_without,
        right=_allowed,
        text=_step_size_text,
        correction=lambda case: f"choose 0 < {case.names.alpha} ≤ 1: {case.names.update()}",
    ),
)
"""The bugs in the target of a known update, and in its ends and numbers."""


def _shifted(before: FloatArray) -> Hypothesis:
    def values(tested: _Tested) -> FloatArray:
        # bootstrapping at an end is a separate question
        without = np.where(tested.evidence.ends[tested.at, None], 0.0, tested.values)
        return np.concatenate((tested.values, without), axis=1)

    def steps(case: Case) -> BoolArray:
        differs: BoolArray = case.evidence.reward != before
        return differs & case.evidence.learns & case.predictions.is_plain

    return Hypothesis(
        CodeFault.SHIFTED_REWARD,
        applies=lambda case: case.uses_reward,
        steps=steps,
        wrong=lambda tested: tested.after(values(tested), before[tested.at]),
        right=lambda tested: tested.after(values(tested)),
        text=lambda tested, place: (
            f"At {tested.step(place)} the reward was {written(tested.reward[place])}, but the target "
            f"contained {written(before[tested.at[place]])}, the reward from before this step."
        ),
        correction=lambda case: (
            f"use the {case.names.reward} that {case.names.environment}.step({case.names.action}) returns "
            f"for this {case.names.state} and {case.names.action}: {case.names.target()}"
        ),
        most=_MOST_REWARDS,
    )


def proofs_of(case: Case) -> Iterator[Proof | None]:
    """Test all hypotheses, first the one about the reward."""
    evidence = case.evidence
    within = np.where(evidence.episode_step == 0, 0.0, evidence.reward_before)
    for before in (evidence.reward_before, within):
        shifted = _shifted(before).proof(case)
        if shifted is not None and shifted.is_enough:
            yield shifted
            case = replace(case, reward=before)
            break
    for hypothesis in HYPOTHESES:
        yield hypothesis.proof(case)
