"""What a run comes to: the measures of a sweep, a row each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

NEAR: Final = 0.05
"""So near to the best, as a share of what it is above random, counts as having arrived."""


@dataclass(frozen=True, slots=True)
class SweepMeasure:
    """One figure of a run. It is null where it has no exact value, and in a run that broke down.

    ``larger_is_better`` is None where it is neither. ``may_never_arrive``: what it counts to may not
    have happened when training ended; then it is null, and known to be later than that.
    """

    id: str
    title: str
    formula: str
    unit: str
    larger_is_better: bool | None = None
    may_never_arrive: bool = False


_MEASURES: Final = (
    SweepMeasure(
        "expected_return",
        "expected return",
        "exact expected undiscounted return of the greedy policy of the final estimates, from the start, "
        "within the time limit",
        "return",
        larger_is_better=True,
    ),
    SweepMeasure(
        "value_at_start",
        "value at the start",
        "exact expected discounted return of that policy from the start, without a time limit",
        "discounted return",
        larger_is_better=True,
    ),
    SweepMeasure(
        "max_error",
        "largest error of Q",
        "max over all pairs of |Q(s, a) - Q*(s, a)|",
        "discounted return",
        larger_is_better=False,
    ),
    SweepMeasure(
        "area",
        "return per episode over all of training",
        "sum of the returns of all finished episodes / their number: the area under the learning curve, a "
        "share of its width",
        "return",
        larger_is_better=True,
    ),
    SweepMeasure(
        "arrival",
        "episodes to 5 % from the best",
        "first mark at which best - g <= 0.05 (best - random); g is the exact expected return of the greedy "
        "policy, best that of the best policy that may look at the clock, random that of a policy that takes "
        "any action alike; marks are after episodes 1, 2, 3 and so on, each at most 2^(1/4) times the one "
        "before or the next, and after the last",
        "episodes",
        larger_is_better=False,
        may_never_arrive=True,
    ),
    SweepMeasure(
        "regret",
        "regret",
        "episodes x best - sum of their returns; of a bandit the sum over all pulls of max q* - "
        "q*(pulled arm)",
        "return",
        larger_is_better=False,
    ),
    SweepMeasure("steps", "steps", "steps taken in all", "steps"),
    SweepMeasure("episodes", "episodes", "finished episodes; sweeps of a planner", "episodes"),
    SweepMeasure(
        "return_last_100",
        "return, last 100 episodes",
        "mean undiscounted return of the last 100 finished episodes, or of as many as there are",
        "return",
        larger_is_better=True,
    ),
)

MEASURES: Final = {measure.id: measure for measure in _MEASURES}
"""The measures by their ids, in the order of their columns."""
ARRIVED: Final = "arrived"
"""The figure beside ``arrival``: 1 where it happened, 0 where training ended before, null if no one knows."""
JUDGED_BY: Final = ("area", "expected_return")
"""By the first of these that its runs have a sweep is judged, where nobody says by which."""


def measure_called(name: str) -> SweepMeasure:
    """Return the measure of that id. Raises ValueError, naming all, where there is none."""
    if name not in MEASURES:
        raise ValueError(f"there is no measure {name}; expected one of {', '.join(MEASURES)}")
    return MEASURES[name]
