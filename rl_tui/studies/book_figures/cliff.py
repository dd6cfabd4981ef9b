"""Example 6.6: rewards while SARSA and Q-learning learn to walk along the cliff.

ε = 0.1, γ = 1, 500 episodes (Sutton & Barto, 2nd ed., page 132). The book gives no step size. This uses 0.5,
as in example 6.5.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from rl_tui.studies.book_figures.drawing import BAND, panel_of, summary_of_comparisons
from rl_tui.studies.book_figures.figure import BookComparison, MeasuredCurve, MeasuredFigure, read_off
from rl_tui.studies.book_figures.measuring import Measuring, mean_and_error, of_runs
from rl_tui.studies.pictures.picture import Chart, Picture, close_axis, fixed_axis

EPISODES: Final = 500
NAMES: Final = {"sarsa": "SARSA", "q-learning": "Q-learning"}
REWARDS: Final = "sum of rewards during the episode"
SETTINGS: Final = {"policy": "epsilon-greedy", "epsilon": 0.1, "gamma": 1.0}
"""Settings of all figures of the cliff."""
_STEP_SIZE: Final = 0.5


def measure(measuring: Measuring, runs: int) -> MeasuredFigure:
    """Train both algorithms `runs` times with the same seeds."""
    measuring.expect(len(NAMES) * runs * EPISODES)
    made = {
        algorithm: measuring.train("cliff", runs, EPISODES, algorithm=algorithm, alpha=_STEP_SIZE, **SETTINGS)
        for algorithm in NAMES
    }
    curves = tuple(_curve(NAMES[algorithm], document["curve"]) for algorithm, document in made.items())
    table = _table(made)
    return MeasuredFigure(table, curves, _picture(curves, table, runs))


def _curve(name: str, curve: dict[str, list[Any]]) -> MeasuredCurve:
    return MeasuredCurve(REWARDS, name, curve["episode"], curve["return_mean"], curve["return_stderr"])


def _table(made: dict[str, dict[str, Any]]) -> tuple[BookComparison, ...]:
    last = {algorithm: of_runs(document, "return_last_100") for algorithm, document in made.items()}
    better = mean_and_error(last["sarsa"] - last["q-learning"])
    of_paths = of_runs(made["q-learning"], "expected_return")
    return (
        read_off("rewards, last 100 episodes, SARSA", -25, 5, *mean_and_error(last["sarsa"])),
        read_off("rewards, last 100 episodes, Q-learning", -50, 5, *mean_and_error(last["q-learning"])),
        BookComparison(
            "how much more SARSA earns, seed by seed",
            "it does",
            "text, example 6.6",
            0.0,
            float("inf"),
            *better,
        ),
        BookComparison(
            "return of what Q-learning learned, without exploring",
            "−13: it learns the optimal policy",
            "text, example 6.6",
            -13.0,
            -13.0,
            *mean_and_error(of_paths),
        ),
    )


def _picture(curves: tuple[MeasuredCurve, ...], table: Sequence[BookComparison], runs: int) -> Picture:
    return Picture(
        title="Cliff walking: rewards during learning",
        summary=summary_of_comparisons(
            f"One chart over {EPISODES} episodes, with a curve for SARSA and one for Q-learning.",
            table,
        ),
        panels=(
            Chart(
                "Sum of rewards during the episode",
                close_axis("episodes", [1, EPISODES]),
                fixed_axis("", [-100, -75, -50, -25, 0]),
                panel_of(curves, REWARDS),
            ),
        ),
        notes=(f"Means of {runs:,} runs; below −100 the curves are cut, as in the book.",),
        band=BAND,
    )
