"""Hyperparameters: names, ranges, defaults, and which have no effect."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, Final, Literal, cast

from rl_tui.agents.catalogue import POLICY_BY_ID, algorithm_row

SAMPLE_AVERAGE: Final = "sample-average"
StepSize = float | Literal["sample-average"]
Ties = Literal["random", "first"]
SCHEDULES: Final = ("constant", "linear", "exponential")
BASELINES: Final = ("mean", "none")
TRACES: Final = ("replacing", "accumulating")
MOST_STEPS: Final = 1_000


@dataclass(frozen=True, slots=True)
class Range:
    """An interval. `open_low` excludes the lower end."""

    low: float
    high: float = math.inf
    open_low: bool = False

    def __contains__(self, value: float) -> bool:
        return (value > self.low if self.open_low else value >= self.low) and value <= self.high

    @property
    def in_words(self) -> str:
        """Text such as ``above 0 and at most 1`` or ``of 0 or more``."""
        low, high = (_for_people(end) for end in (self.low, self.high))
        if math.isinf(self.high):
            return f"above {low}" if self.open_low else f"of {low} or more"
        return f"above {low} and at most {high}" if self.open_low else f"from {low} to {high}"

    def __str__(self) -> str:
        closing = ")" if math.isinf(self.high) else "]"
        opening = "(" if self.open_low or math.isinf(self.low) else "["
        return f"{opening}{_bound(self.low)}, {_bound(self.high)}{closing}"


def _bound(value: float) -> str:
    return ("∞" if value > 0 else "−∞") if math.isinf(value) else f"{value:g}"


def _for_people(value: float) -> str:
    if abs(value) < 1e9 and float(value).is_integer():
        return f"{value:,.0f}"
    return f"{value:g}".replace("e+", "e")


@dataclass(frozen=True, slots=True)
class Slide:
    """The part of a range that a slider covers."""

    low: float = 0.0
    high: float = 1.0
    logarithmic: bool = False


@dataclass(frozen=True, slots=True)
class Parameter:
    """One hyperparameter as shown to users.

    Args:
        range: Allowed numbers, or None.
        whole: True if only integers are allowed.
        schedule: True if it only describes how another one changes per episode.
    """

    name: str
    symbol: str
    help: str
    range: Range | None = None
    words: tuple[str, ...] = ()
    whole: bool = False
    slide: Slide | None = None
    schedule: bool = False

    @property
    def short_name(self) -> str:
        """Help up to the colon, such as ``step size``."""
        return self.help.partition(":")[0]

    @property
    def expected(self) -> str:
        """Allowed values: ``a number in (0, 1] or sample-average``."""
        kind = "a whole number" if self.whole else "a number"
        numbers = [f"{kind} in {self.range}"] if self.range else []
        return " or ".join([*numbers, *self.words])

    @property
    def expected_in_words(self) -> str:
        """Allowed values: ``a number above 0 and at most 1, or sample-average``."""
        kind = "a whole number" if self.whole else "a number"
        words = " or ".join(self.words)
        if self.range is None:
            return words
        comma = "," if words and " and " in self.range.in_words else ""
        return f"{kind} {self.range.in_words}" + (f"{comma} or {words}" if words else "")

    @property
    def field(self) -> str:
        """Its name, with ``lambda_`` for Python's keyword."""
        return "lambda_" if self.name == "lambda" else self.name

    def accepts(self, value: object) -> bool:
        """Return True for an allowed word or number."""
        if isinstance(value, str):
            return value in self.words
        if isinstance(value, bool) or not isinstance(value, (int, float)) or self.range is None:
            return False
        # range first, since isfinite fails for huge integers
        return value in self.range and math.isfinite(value) and (not self.whole or value == int(value))


PARAMETERS: Final[Mapping[str, Parameter]] = {
    parameter.name: parameter
    for parameter in (
        Parameter(
            "alpha",
            "α",
            "step size: how far one update moves the estimate",
            Range(0, 1, open_low=True),
            (SAMPLE_AVERAGE,),
            slide=Slide(),
        ),
        Parameter(
            "step_size_schedule",
            "α schedule",
            "how α changes from episode to episode",
            words=(*SCHEDULES, SAMPLE_AVERAGE),
            schedule=True,
        ),
        Parameter("alpha_min", "α_min", "lowest α that the decay reaches", Range(0, 1), schedule=True),
        Parameter("alpha_decay", "α decay", "decay of α per episode", Range(0), schedule=True),
        Parameter(
            "gamma", "γ", "discount: what a reward is worth one step later", Range(0, 1), slide=Slide()
        ),
        Parameter("policy", "policy", "how actions are chosen", words=tuple(POLICY_BY_ID)),
        Parameter("epsilon", "ε", "exploration: probability of a random action", Range(0, 1), slide=Slide()),
        Parameter(
            "epsilon_schedule",
            "ε schedule",
            "how ε changes from episode to episode",
            words=SCHEDULES,
            schedule=True,
        ),
        Parameter("epsilon_min", "ε_min", "lowest ε that the decay reaches", Range(0, 1), schedule=True),
        Parameter("epsilon_decay", "ε decay", "decay of ε per episode", Range(0), schedule=True),
        Parameter(
            "temperature",
            "τ",
            "softmax: high values choose almost at random",
            Range(0, 1e6, open_low=True),
            slide=Slide(0.01, 100.0, logarithmic=True),
        ),
        Parameter(
            "confidence",
            "c",
            "UCB: how strongly it prefers rarely tried actions",
            Range(0, 1e6),
            slide=Slide(0.0, 5.0),
        ),
        Parameter("baseline", "baseline", "gradient bandit: what rewards are compared with", words=BASELINES),
        Parameter(
            "lambda", "λ", "trace decay: how much earlier pairs learn from a step", Range(0, 1), slide=Slide()
        ),
        Parameter("traces", "traces", "a second visit sets the trace to 1, or adds 1", words=TRACES),
        Parameter("n", "n", "number of steps that an update looks ahead", Range(1, MOST_STEPS), whole=True),
        Parameter(
            "planning_steps",
            "planning",
            "updates from the model after every step",
            Range(0, 10_000),
            whole=True,
        ),
        Parameter("threshold", "θ", "prioritized sweeping: smaller changes are not passed on", Range(0, 1e6)),
        Parameter(
            "accuracy",
            "accuracy",
            "planners stop when a sweep changes no value by more than this",
            Range(0, 1e6),
        ),
        Parameter("initial_q", "Q₀", "initial estimate of every action", Range(-1e12, 1e12)),
        Parameter(
            "ties",
            "ties",
            "choice among equal best actions: random, or the first in the world's order",
            words=("random", "first"),
        ),
    )
}


@dataclass(frozen=True, slots=True)
class Hyperparameters:
    """The hyperparameters of a learner, with ranges in :data:`PARAMETERS`.

    In episode n (from 0) an exponential schedule turns ε into ε_min + (ε − ε_min)·exp(−decay·n). A linear one
    gives ε − decay·n, at least ε_min. The same holds for α, unless the step size is the sample average 1/N(s,
    a).
    """

    alpha: StepSize = 0.1
    step_size_schedule: str = "exponential"
    alpha_min: float = 0.0
    alpha_decay: float = 0.0
    gamma: float = 0.99
    policy: str = "epsilon-greedy"
    epsilon: float = 0.1
    epsilon_schedule: str = "exponential"
    epsilon_min: float = 0.0
    epsilon_decay: float = 0.0
    temperature: float = 0.1
    confidence: float = 2.0
    baseline: str = "mean"
    lambda_: float = 0.9
    traces: str = "replacing"
    n: int = 4
    planning_steps: int = 10
    threshold: float = 1e-4
    accuracy: float = 1e-9
    initial_q: float = 0.0
    ties: Ties = "random"

    def changed(self, name: str, value: object) -> Hyperparameters:
        """Return a copy with one value changed, or raise ValueError."""
        if name not in PARAMETERS:
            raise ValueError(f"there is no parameter {name}; expected one of {', '.join(PARAMETERS)}")
        parameter = PARAMETERS[name]
        if not parameter.accepts(value):
            raise ValueError(f"{name} is {value}; expected {parameter.expected}")
        new: Any = value if isinstance(value, str) else float(cast("float", value))
        changes: dict[str, Any] = {parameter.field: int(new) if parameter.whole else new}
        return replace(self, **changes)

    def value(self, name: str) -> float | str:
        """Return a value by parameter name."""
        found: float | str = getattr(self, PARAMETERS[name].field)
        return found

    def as_dict(self) -> dict[str, float | str]:
        """Return the values by name, for JSON."""
        return {name.rstrip("_"): value for name, value in asdict(self).items()}

    @property
    def sample_average(self) -> bool:
        """True for 1/N(s, a), set by α or its schedule."""
        return SAMPLE_AVERAGE in (self.alpha, self.step_size_schedule)

    def without_average(self) -> Hyperparameters:
        """Return a copy in which defaults replace the sample average."""
        usual = Hyperparameters()
        fields = [name for name in ("alpha", "step_size_schedule") if getattr(self, name) == SAMPLE_AVERAGE]
        return replace(self, **{name: getattr(usual, name) for name in fields})

    def alpha_at(self, episode: int) -> float | None:
        """Return α, or None for the sample average. Episodes count from 0."""
        if self.sample_average or isinstance(self.alpha, str):
            return None
        return _scheduled(self.step_size_schedule, self.alpha, self.alpha_min, self.alpha_decay, episode)

    def epsilon_at(self, episode: int) -> float:
        """Return ε. Episodes count from 0."""
        return _scheduled(self.epsilon_schedule, self.epsilon, self.epsilon_min, self.epsilon_decay, episode)


def _scheduled(schedule: str, start: float, least: float, decay: float, episode: int) -> float:
    if schedule == "constant" or decay == 0.0:
        return start
    if schedule == "linear":
        fall = decay * episode
        return max(least, start - fall) if start >= least else min(least, start + fall)
    return least + (start - least) * math.exp(-decay * episode)


# Hyperparameters without effect


_LOOKS_AHEAD: Final = {
    "gamma": "every pull ends its episode, so there is no later reward to discount",
    "lambda": "every pull ends its episode, so there is no earlier step to update",
    "traces": "every pull ends its episode, so there is no earlier step to update",
    "n": "every pull ends its episode, so there is only one reward",
}


def why_idle(name: str, algorithm: str, values: Hyperparameters, *, is_bandit: bool) -> str:
    """Return why a parameter of `algorithm` has no effect, or ""."""
    if is_bandit and not algorithm_row(algorithm).planner and name in _LOOKS_AHEAD:
        return _LOOKS_AHEAD[name]
    match name:
        case "traces" if values.lambda_ == 0.0:
            return "λ is 0, so there are no traces"
        case "step_size_schedule" if values.alpha == SAMPLE_AVERAGE:
            return "α is the sample average"
        case "alpha_min" | "alpha_decay" if values.sample_average:
            return "α is the sample average"
        case "step_size_schedule" | "alpha_min" if values.alpha_decay == 0.0 and not values.sample_average:
            return "the decay of α is 0, so α is constant"
        case "epsilon_schedule" | "epsilon_min" if values.epsilon_decay == 0.0:
            return "the decay of ε is 0, so ε is constant"
        case "alpha_min" | "alpha_decay" if values.step_size_schedule == "constant":
            return "the schedule of α is constant"
        case "epsilon_min" | "epsilon_decay" if values.epsilon_schedule == "constant":
            return "the schedule of ε is constant"
        case _:
            return ""
