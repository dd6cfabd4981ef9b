"""The numbers that a person may turn: their names, ranges and defaults."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, Final, Literal, cast

SAMPLE_AVERAGE: Final = "sample-average"
StepSize = float | Literal["sample-average"]
Ties = Literal["random", "first"]


@dataclass(frozen=True, slots=True)
class Range:
    """An interval of real numbers; ``open_low`` leaves its lower end out."""

    low: float
    high: float = math.inf
    open_low: bool = False

    def __contains__(self, value: float) -> bool:
        return (value > self.low if self.open_low else value >= self.low) and value <= self.high

    def __str__(self) -> str:
        closing = ")" if math.isinf(self.high) else "]"
        opening = "(" if self.open_low or math.isinf(self.low) else "["
        return f"{opening}{_bound(self.low)}, {_bound(self.high)}{closing}"


def _bound(value: float) -> str:
    return ("∞" if value > 0 else "−∞") if math.isinf(value) else f"{value:g}"


@dataclass(frozen=True, slots=True)
class Parameter:
    """One hyper-parameter as people see it.

    ``words`` are what it accepts besides numbers in ``range``; without a range it takes words only.
    """

    name: str
    symbol: str
    help: str
    range: Range | None = None
    words: tuple[str, ...] = ()

    @property
    def expected(self) -> str:
        """What it takes, for messages: ``a number in (0, 1] or sample-average``."""
        numbers = [f"a number in {self.range}"] if self.range else []
        return " or ".join([*numbers, *self.words])

    def accepts(self, value: object) -> bool:
        """Tell whether ``value`` is one of its words or a finite number within its range."""
        if isinstance(value, str):
            return value in self.words
        if isinstance(value, bool) or not isinstance(value, (int, float)) or self.range is None:
            return False
        # the range first: a whole number beyond all floats has no place in isfinite
        return value in self.range and math.isfinite(value)


PARAMETERS: Final[Mapping[str, Parameter]] = {
    parameter.name: parameter
    for parameter in (
        Parameter(
            "alpha",
            "α",
            "step size: how far one update moves the estimate",
            Range(0, 1, open_low=True),
            (SAMPLE_AVERAGE,),
        ),
        Parameter("gamma", "γ", "discount: what a reward is worth one step later", Range(0, 1)),
        Parameter("epsilon", "ε", "exploration: probability of a random action", Range(0, 1)),
        Parameter("epsilon_min", "ε_min", "where the decay of ε ends", Range(0, 1)),
        Parameter("epsilon_decay", "decay", "decay of ε per episode", Range(0)),
        Parameter("initial_q", "Q₀", "what every estimate starts from", Range(-1e12, 1e12)),
        Parameter("ties", "ties", "which of equal best actions is taken", words=("random", "first")),
    )
}


@dataclass(frozen=True, slots=True)
class Hyperparameters:
    """Everything a learner is told besides the world; :data:`PARAMETERS` gives the ranges.

    The exploration probability in episode n (from 0) is
    ε_min + (ε − ε_min)·exp(−decay·n); with decay 0 it is ε.
    """

    alpha: StepSize = 0.1
    gamma: float = 0.99
    epsilon: float = 0.1
    epsilon_min: float = 0.0
    epsilon_decay: float = 0.0
    initial_q: float = 0.0
    ties: Ties = "random"

    def changed(self, name: str, value: object) -> Hyperparameters:
        """Return a copy with one value changed; raises ValueError naming the range if it does not fit."""
        parameter = PARAMETERS[name]
        if not parameter.accepts(value):
            raise ValueError(f"{name} is {value}; expected {parameter.expected}")
        new: Any = value if isinstance(value, str) else float(cast("float", value))
        return replace(self, **{name: new})

    def as_dict(self) -> dict[str, float | str]:
        """Return the values by name, for JSON."""
        return asdict(self)

    def epsilon_at(self, episode: int) -> float:
        """Return the exploration probability in force in episode ``episode``, counted from 0."""
        if self.epsilon_decay == 0.0:
            return self.epsilon
        return self.epsilon_min + (self.epsilon - self.epsilon_min) * math.exp(-self.epsilon_decay * episode)
