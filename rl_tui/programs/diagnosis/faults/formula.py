"""Wrong signs and misplaced terms: all steps follow a linear formula of no correct update."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from rl_tui.common.own_ids import OWN_IDS
from rl_tui.programs.diagnosis.faults.cells import Proof, step_text, written
from rl_tui.programs.diagnosis.sample import EXACT, Sample, sample_of
from rl_tui.programs.diagnosis.trial import FEWEST, ROUGH, plainest, refined, rounded
from rl_tui.programs.evidence.code_names import DISCOUNT, CodeNames
from rl_tui.programs.evidence.evidence import Evidence
from rl_tui.programs.evidence.verdict import CodeFault, MovedCell, Rule, UpdateFound, UpdateTarget
from rl_tui.programs.watched.program_log import ProgramEnvironment
from rl_tui.worlds.mdp.space import BoolArray, FloatArray

_RESIDUAL: Final = 1e-6
"""Largest residual of a step, relative to the terms of the formula."""
_NEAR: Final = 1e-6
_FEWEST_EQUATIONS: Final = 20
"""Fewest distinct steps, since four of them determine a formula."""
_MOST_EQUATIONS: Final = 2_000
_WEIGHTY: Final = 100.0
_CLEARLY_ABOVE: Final = 1.001
"""A discount above this is not a rounded 1."""
_READ: Final = (
    UpdateTarget.BEST,
    UpdateTarget.NEXT_ACTION,
    UpdateTarget.SAME_ACTION,
    UpdateTarget.OWN_STATE,
)
_TEXTS: Final = {UpdateTarget.BEST: "max Q(s′)", UpdateTarget.NEXT_ACTION: "Q(s′, a′)"}
"""The values that a correct update may read."""
_STEP_SIZE: Final = re.compile(r"^(alpha|α|lr|step_?size|learning_?rate)$", re.IGNORECASE)
_ONE_PLAYER: Final = ("FrozenLake", "CliffWalking", "Taxi", "Blackjack", OWN_IDS)
"""Ids of environments in which the next state is never an opponent's."""


@dataclass(frozen=True)
class _Formula:
    """change = reward · r + value · V + old · Q(s, a) + constant, where V is the next value of `target`.

    Equal rewards are part of the constant.
    """

    sample: Sample
    steps: BoolArray
    target: UpdateTarget
    reward: float | None
    value: float
    old: float
    constant: float

    @property
    def numbers(self) -> dict[str, float]:
        return {name.rpartition(".")[2]: x for name, x in self.sample.evidence.numbers.items()}

    @property
    def sizes(self) -> FloatArray:
        sample = self.sample
        size: FloatArray = np.abs((self.reward or 0.0) * sample.reward) + np.abs(self.old * sample.old)
        return size + np.abs(self.value * sample.value(self.target)) + abs(self.constant)

    @property
    def residual(self) -> FloatArray:
        sample = self.sample
        sum_: FloatArray = (self.reward or 0.0) * sample.reward + self.old * sample.old + self.constant
        return np.abs(sum_ + self.value * sample.value(self.target) - sample.change)

    def __str__(self) -> str:
        terms = (
            (self.reward or 0.0, "r"),
            (self.constant, ""),
            (self.value, _TEXTS[self.target]),
            (self.old, "Q(s, a)"),
        )
        parts = [("−" if x < 0 else "+", _term(abs(x), what)) for x, what in terms if x]
        (sign, first), *others = parts
        start = f"−{first}" if sign == "−" else first
        return " ".join((start, *(f"{sign} {part}" for sign, part in others)))


def _term(factor: float, what: str) -> str:
    return what if what and factor == 1.0 else f"{written(factor)} {what}".rstrip()


@dataclass(frozen=True)
class _Mistake:
    text: str
    shown_by: FloatArray
    certainty: Literal["proven", "declared"] = "proven"


@np.errstate(all="ignore")  # numbers may be 0
def proof_of_formula(
    evidence: Evidence, update: UpdateFound, environments: Sequence[ProgramEnvironment], names: CodeNames
) -> Proof | None:
    """Prove an exact linear formula with a wrong factor of an estimate. An own reward may have any factor."""
    is_right = update.rule is not Rule.UNKNOWN and update.reward == "environment"
    if evidence.is_pair or evidence.precision > EXACT or (is_right and (update.gamma or 0.0) <= 1.0):
        return None
    sample = sample_of(evidence, MovedCell.TAKEN)
    found = [each for each in (_formula(sample, target) for target in _READ) if each]
    mistakes = [_mistake(each, environments) for each in found]
    if not found or None in mistakes or found[0].target not in _TEXTS:
        return None
    formula, mistake = found[0], mistakes[0]
    assert mistake is not None
    weighty = np.abs(mistake.shown_by) > _WEIGHTY * sample.slack
    speaking = sample.at[formula.steps & weighty]
    if len(speaking) < FEWEST:
        return None
    place = int(np.argmax(formula.steps & weighty))
    cell = divmod(int(sample.cell[place]), evidence.actions)
    right = replace(names, value=formula.target)
    return Proof(
        CodeFault.WRONG_FORMULA,
        evidence.number[speaking],
        0,
        f"At {step_text(evidence.number[speaking[0]])} Q({cell[0]}, {cell[1]}) changed by "
        f"{written(sample.change[place])}. All {int(formula.steps.sum()):,} examined steps within episodes "
        f"change an estimate by {formula}. It should be α (r + γ {_TEXTS[formula.target]} − Q(s, a)). "
        f"{mistake.text}",
        f"{right.target()}; {right.update()}",
        certainty=mistake.certainty,
    )


def _formula(sample: Sample, target: UpdateTarget) -> _Formula | None:
    steps = ~sample.ended
    moving = steps & (sample.change != 0.0)
    if moving.sum() < _FEWEST_EQUATIONS:
        return None
    value, reward = sample.value(target), sample.reward
    if not np.isfinite(value[steps]).all():
        return None
    varies = bool(np.ptp(reward[steps]) > 0.0)
    columns = [value, sample.old, np.ones(len(sample)), *([reward] if varies else [])]
    equations = np.column_stack((*columns, sample.change))[moving][:_MOST_EQUATIONS]
    if len(np.unique(rounded(equations, 6), axis=0)) < _FEWEST_EQUATIONS:
        return None
    factors = refined(columns, sample.change, sample.slack, steps)
    if factors is None:
        return None
    largest = max(map(abs, factors))
    plain = [0.0 if abs(x) < 1e-9 * largest else plainest(x, sample.evidence, ROUGH) for x in factors]
    of_value, of_old, constant = plain[:3]
    formula = _Formula(sample, steps, target, plain[3] if varies else None, of_value, of_old, constant)
    allowed = _RESIDUAL * formula.sizes + np.finfo(np.float64).tiny  # smaller numbers have fewer digits
    return formula if np.all((formula.residual <= allowed)[steps]) else None


def _mistake(formula: _Formula, environments: Sequence[ProgramEnvironment]) -> _Mistake | None:
    next_value, old = formula.sample.value(formula.target), formula.sample.old
    reward, value, own = formula.reward, formula.value, formula.old
    near = _NEAR * max(abs(value), abs(own))
    read = _TEXTS.get(formula.target, "")
    if abs(value) <= near or (reward is not None and reward <= 0.0):
        return None  # a sum of rewards, a cost instead of a reward, or a step size that is not above 0
    if reward is None and value < 0.0 < own:
        return None  # a step size that is not above 0
    if own >= -near:
        done = "added" if own > near else "not subtracted"
        return _Mistake(f"Q(s, a) is {done}. It has to be subtracted, with the factor α.", old * value)
    if value < 0.0:
        if not any(each.id.startswith(_ONE_PLAYER) or each.transitions for each in environments):
            return None
        return _Mistake(f"{read} is subtracted. It has to be added.", next_value * value)
    if value > -own * _CLEARLY_ABOVE:
        text = f"That is γ {written(-value / own)}, and γ is at most 1."
        return _Mistake(text, next_value * value)
    if own < -_CLEARLY_ABOVE:
        return _replaced(formula)
    return _misplaced(formula)


def _replaced(formula: _Formula) -> _Mistake:
    """Tell Q ← α (target − Q), with = in place of +=, from a step size above 1."""
    text = f"Q(s, a) is subtracted {written(-formula.old)} times, as with = in place of += or with α above 1."
    for name, alpha in _step_sizes(formula.numbers).items():
        if _is(formula.old, -1.0 - alpha):
            text = f"`{name}` is {written(alpha)}, so the old Q(s, a) is lost, as with = in place of +=."
            return _Mistake(text, formula.sample.old, "declared")
    return _Mistake(text, formula.sample.old)


def _step_sizes(numbers: Mapping[str, float]) -> dict[str, float]:
    return {name: x for name, x in numbers.items() if _STEP_SIZE.search(name) and 0.0 < x < 1.0}


def _misplaced(formula: _Formula) -> _Mistake | None:
    """Find Q ← α · target and Q ← α r + γ V, where α does not multiply all three terms, or γ two of them."""
    numbers = formula.numbers
    discounts = {name: x for name, x in numbers.items() if DISCOUNT.search(name)}
    for name, alpha in _step_sizes(numbers).items():
        if formula.reward is not None and not _is(formula.reward, alpha):
            continue
        for discount, gamma in discounts.items():
            values = f"`{name}` is {written(alpha)} and `{discount}` is {written(gamma)}"
            is_discounted = _is(formula.value, alpha * gamma) and _is(formula.old, -formula.value)
            if formula.reward is not None and 0.0 < gamma < 1.0 and is_discounted:
                text = f"{values}, so γ multiplies Q(s, a) too."
                return _Mistake(text, formula.sample.old * alpha * (1.0 - gamma), "declared")
            if not _is(formula.old, -1.0):
                continue
            if _is(formula.value, alpha * gamma) and not any(_is(x, formula.value) for x in numbers.values()):
                text = f"{values}, so (1 − α) Q(s, a) is missing."
                return _Mistake(text, formula.sample.old, "declared")
            if formula.reward is not None and _is(formula.value, gamma):
                text = f"{values}, so α multiplies r only."
                return _Mistake(text, formula.sample.old, "declared")
    return None


def _is(number: float, wanted: float) -> bool:
    return math.isclose(number, wanted, rel_tol=_NEAR)
