"""Figure 2.2: average performance of ε-greedy action-value methods on the ten-armed testbed.

The means of ten arms and the noise of rewards are drawn from N(0, 1). Estimates are sample averages from 0,
over 1,000 pulls of each bandit (Sutton & Barto, 2nd ed., section 2.3).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from rl_tui.studies.book_figures.drawing import BAND, panel_of, summary_of_comparisons
from rl_tui.studies.book_figures.figure import BookComparison, MeasuredCurve, MeasuredFigure, read_off
from rl_tui.studies.book_figures.measuring import Measuring, mean_and_error, of_runs
from rl_tui.studies.pictures.picture import Chart, Picture, close_axis, fixed_axis, round_axis

PULLS: Final = 1_000
EPSILONS: Final = (0.1, 0.01, 0.0)
LAST: Final = 100
REWARD, OPTIMAL = "average reward", "optimal action, %"
_TEXT: Final = "text, section 2.3"


def measure(measuring: Measuring, runs: int) -> MeasuredFigure:
    """Play `runs` bandits, the same ones for each ε."""
    measuring.expect(len(EPSILONS) * runs * PULLS)
    made = {
        epsilon: measuring.train(
            "bandit",
            runs,
            PULLS,
            algorithm="q-learning",
            policy="epsilon-greedy",
            epsilon=epsilon,
            alpha="sample-average",
            gamma=0.0,
        )
        for epsilon in EPSILONS
    }
    curves = tuple(
        curve for epsilon, document in made.items() for curve in _curves(epsilon, document["curve"])
    )
    table = _table(made)
    return MeasuredFigure(table, curves, _picture(curves, table, runs))


def name_of(epsilon: float) -> str:
    """Return the name of a curve."""
    return f"ε = {epsilon:g}" if epsilon else "ε = 0 (greedy)"


def _curves(epsilon: float, curve: dict[str, list[Any]]) -> tuple[MeasuredCurve, MeasuredCurve]:
    name, pulls = name_of(epsilon), curve["episode"]
    percent = [
        [None if value is None else 100.0 * value for value in curve[each]]
        for each in ("optimal_action_rate", "optimal_action_stderr")
    ]
    return (
        MeasuredCurve(REWARD, name, pulls, curve["return_mean"], curve["return_stderr"]),
        MeasuredCurve(OPTIMAL, name, pulls, [value for value in percent[0] if value is not None], percent[1]),
    )


def _table(made: dict[float, dict[str, Any]]) -> tuple[BookComparison, ...]:
    paid = {
        epsilon: mean_and_error(of_runs(document, "return_last_100")) for epsilon, document in made.items()
    }
    # Winnings plus regret equal the reward of always pulling the best arm, except for noise
    best = mean_and_error((of_runs(made[0.1], "winnings") + of_runs(made[0.1], "regret")) / PULLS)
    last = f"reward, last {LAST} pulls"
    rate = f"optimal action, last {LAST} pulls, %"
    optimal = {epsilon: _last_optimal(document["curve"]) for epsilon, document in made.items()}
    return (
        BookComparison("reward of the best arm", "about 1.54", _TEXT, 1.535, 1.545, *best),
        BookComparison(f"{last}, {name_of(0.0)}", "about 1", _TEXT, 0.95, 1.05, *paid[0.0]),
        read_off(f"{last}, {name_of(0.01)}", 1.3, 0.05, *paid[0.01]),
        read_off(f"{last}, {name_of(0.1)}", 1.4, 0.05, *paid[0.1]),
        BookComparison(f"{rate}, {name_of(0.0)}", "about a third", _TEXT, 30.0, 37.0, *optimal[0.0]),
        read_off(f"{rate}, {name_of(0.01)}", 58, 5, *optimal[0.01]),
        read_off(f"{rate}, {name_of(0.1)}", 80, 3, *optimal[0.1]),
    )


def _last_optimal(curve: dict[str, list[Any]]) -> tuple[float, float | None]:
    """Return the share of the best arm in the last pulls, in percent, and a bound of its standard error."""
    rates = curve["optimal_action_rate"][-LAST:]
    errors = [error for error in curve["optimal_action_stderr"][-LAST:] if error is not None]
    return 100.0 * sum(rates) / len(rates), 100.0 * max(errors) if errors else None


def _picture(curves: tuple[MeasuredCurve, ...], table: Sequence[BookComparison], runs: int) -> Picture:
    rewards = panel_of(curves, REWARD)
    pulls = close_axis("pulls", [1, PULLS])
    values = [value for curve in rewards for value in curve.y if value is not None]
    return Picture(
        title="Ten-armed testbed: ε-greedy with sample averages",
        summary=summary_of_comparisons(
            "Two charts over 1,000 pulls, one curve for each ε: the average reward, and how often the best "
            "arm is pulled.",
            table,
        ),
        panels=(
            Chart("Average reward", pulls, round_axis("", [0.0, 1.5, *values]), rewards),
            Chart(
                "Optimal action, % of the bandits",
                pulls,
                fixed_axis("", [0, 20, 40, 60, 80, 100]),
                panel_of(curves, OPTIMAL),
            ),
        ),
        notes=(f"Means of {runs:,} bandits.",),
        band=BAND,
    )
